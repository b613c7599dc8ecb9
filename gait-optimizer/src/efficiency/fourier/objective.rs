//! X/S of a symmetric Fourier gait with its exact gradient and Hessian in the coefficients.
//!
//! What is made largest is ln |x| − (1 − g) ln S − (g/2) ln(T∫P ds), x and S = ∫√P ds over the quarter T = π/2. The last
//! term is never below ln S (Cauchy–Schwarz) and equals it where the power is constant in s: a weight g > 0 leaves the best
//! curve what it is and takes away the freedom to run it at any speed, which otherwise makes the Hessian singular.
//!
//! Derivatives: `x′ = cos θ v_x − sin θ v_y` with v = AΦ′ and `θ = ∫v_θ`. Its first variation weighs v by the body momentum
//! (cos θ, −sin θ, `y − y_f`), where the last is the adjoint of θ; the second adds the terms of δθ.

use nalgebra::{DMatrix, DVector, Matrix2, Matrix3x2, Matrix4, SMatrix, Vector2, Vector3, Vector4};
use swimmer_model::{Model, SecondDerivatives};

use super::Grid;
use crate::batch::{self, Batch, Second};

/// A gait's worth.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Value {
    /// What is made largest.
    pub(crate) objective: f64,
    /// x of the quarter over L.
    pub(crate) x: f64,
    /// ∫√P of the quarter, P over `c_t`.
    pub(crate) power_length: f64,
}

impl Value {
    /// Lighthill's efficiency at constant power.
    pub(crate) fn efficiency(&self) -> f64 {
        (self.x / self.power_length).powi(2)
    }
}

/// Value with derivatives.
#[derive(Debug, Clone)]
pub(crate) struct Expansion {
    pub(crate) value: Value,
    pub(crate) gradient: DVector<f64>,
    pub(crate) hessian: DMatrix<f64>,
}

/// The objective of one swimmer on one grid.
#[derive(Debug)]
pub(crate) struct Objective<'a> {
    pub(crate) model: &'a Model<f64>,
    pub(crate) grid: &'a Grid,
    /// The weight g of constant speed.
    pub(crate) gauge: f64,
}

/// Φ and Φ′ of the series with coefficients (A₁ … `A_N`, B₁ … `B_N`) at s.
pub(crate) fn series(coefficients: &[f64], s: f64) -> (Vector2<f64>, Vector2<f64>) {
    let (a, b) = coefficients.split_at(coefficients.len() / 2);
    let (mut at, mut rate) = (Vector2::zeros(), Vector2::zeros());
    let (first, twice) = (s.sin_cos(), (2.0 * s).sin_cos());
    let (mut sin, mut cos) = first;
    let mut order = 1.0;
    for (a, b) in a.iter().zip(b) {
        at += Vector2::new(a * cos, b * sin);
        rate += Vector2::new(-order * a * sin, order * b * cos);
        (sin, cos) = (sin * twice.1 + cos * twice.0, cos * twice.1 - sin * twice.0);
        order += 2.0;
    }
    (from_diagonals(&at), from_diagonals(&rate))
}

/// From coordinates along φ₁ = φ₂ and across it.
fn from_diagonals(v: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(v.x - v.y, v.x + v.y) * std::f64::consts::FRAC_1_SQRT_2
}

impl Objective<'_> {
    /// The objective alone, with x and S of the quarter.
    pub(crate) fn value(&self, coefficients: &[f64]) -> Value {
        let root = self.model.side_drag().sqrt();
        let places = self.places(coefficients);
        let mut moments: Vec<(Vector3<f64>, f64)> = Vec::with_capacity(places.len());
        let phi = places.iter().map(|(phi, _)| *phi);
        Batch::of(self.model).each(batch::Values, phi, |node, (a, w)| {
            let rate = places[node].1;
            moments.push((a * rate, rate.dot(&(w * rate)).max(0.0).sqrt()));
        });
        let turning = DVector::from_iterator(moments.len(), moments.iter().map(|(v, _)| v.z));
        let theta = &self.grid.integral * turning;
        let x: f64 = moments
            .iter()
            .zip(theta.iter())
            .map(|((v, _), theta)| theta.cos() * v.x - theta.sin() * v.y)
            .sum();
        let length: f64 = moments.iter().map(|(_, speed)| speed).sum();
        let energy: f64 = moments.iter().map(|(_, speed)| speed * speed).sum();
        let (x, length) = (x * self.grid.weight, length * self.grid.weight / root);
        Value {
            objective: self.objective(x, length, energy * self.grid.weight / (root * root)),
            x,
            power_length: length,
        }
    }

    /// Φ and Φ′ at each node.
    fn places(&self, coefficients: &[f64]) -> Vec<(Vector2<f64>, Vector2<f64>)> {
        let nodes = self.grid.nodes.iter();
        nodes.map(|&s| series(coefficients, s)).collect()
    }

    fn objective(&self, x: f64, length: f64, energy: f64) -> f64 {
        x.abs().ln()
            - (1.0 - self.gauge) * length.ln()
            - 0.5 * self.gauge * (std::f64::consts::FRAC_PI_2 * energy).ln()
    }

    /// Value, gradient and Hessian.
    pub(crate) fn expansion(&self, coefficients: &[f64]) -> Expansion {
        let (count, size) = (self.grid.nodes.len(), coefficients.len());
        let dt = self.grid.weight;
        let over_drag = 1.0 / self.model.side_drag();
        let places = self.places(coefficients);
        let mut locals: Vec<Local> = Vec::with_capacity(count);
        let phi = places.iter().map(|(phi, _)| *phi);
        Batch::of(self.model).each(Second, phi, |node, second| {
            locals.push(Local::new(&second, &places[node].1, over_drag));
        });
        let theta = &self.grid.integral
            * DVector::from_iterator(count, locals.iter().map(|local| local.body.z));
        let turned: Vec<(f64, f64)> = theta.iter().map(|theta| theta.sin_cos()).collect();
        let ahead =
            |(local, (sin, cos)): (&Local, &(f64, f64))| cos * local.body.x - sin * local.body.y;
        let across =
            |(local, (sin, cos)): (&Local, &(f64, f64))| sin * local.body.x + cos * local.body.y;
        let x = dt * locals.iter().zip(&turned).map(ahead).sum::<f64>();
        let length = dt * locals.iter().map(|local| local.power.sqrt()).sum::<f64>();
        let energy = dt * locals.iter().map(|local| local.power).sum::<f64>();
        // Adjoint of θ: y − y_f.
        let lateral = self.grid.integral.tr_mul(&DVector::from_iterator(
            count,
            locals.iter().zip(&turned).map(|pair| -across(pair)),
        ));
        let basis = Basis::new(self.grid, size / 2);
        let mut x_terms = Terms::new(count);
        let mut length_terms = Terms::new(count);
        let mut energy_terms = Terms::new(count);
        let mut turn_rows = DMatrix::zeros(count, size);
        let mut cross_rows = DMatrix::zeros(count, size);
        for (j, local) in locals.iter().enumerate() {
            let (sin, cos) = turned[j];
            let momentum = Vector3::new(cos, -sin, lateral[j]);
            x_terms.set(
                j,
                &local.d_body.transpose(),
                &momentum,
                |m| local.d2_body(m),
                dt,
            );
            let root = local.power.sqrt();
            let gradient = local.d_power;
            let bent = local.d2_power / (2.0 * root)
                - gradient * gradient.transpose() / (4.0 * root * local.power);
            length_terms.set_plain(j, &(gradient / (2.0 * root)), &bent, dt);
            energy_terms.set_plain(j, &gradient, &local.d2_power, dt);
            let turn = local.d_body.row(2).transpose();
            let sideways = -(local.d_body.row(0) * sin + local.d_body.row(1) * cos).transpose();
            basis.row(j, &turn, &mut turn_rows);
            basis.row(j, &sideways, &mut cross_rows);
        }
        // δθ at the nodes for each coefficient, and what it adds to δ²x.
        let d_theta = &self.grid.integral * &turn_rows;
        let mut by_theta = cross_rows * dt;
        for (j, pair) in locals.iter().zip(&turned).enumerate() {
            let bend = -0.5 * dt * ahead(pair);
            let mut row = by_theta.row_mut(j);
            row += d_theta.row(j) * bend;
        }
        let turning = by_theta.tr_mul(&d_theta);
        let (x_gradient, x_hessian) = basis.assemble(&x_terms);
        let x_hessian = x_hessian + &turning + turning.transpose();
        let (l_gradient, l_hessian) = basis.assemble(&length_terms);
        let (e_gradient, e_hessian) = basis.assemble(&energy_terms);
        let gauge = self.gauge;
        let logarithm = |value: f64, gradient: &DVector<f64>, hessian: DMatrix<f64>| {
            let slope = gradient / value;
            let bend = hessian / value - &slope * slope.transpose();
            (slope, bend)
        };
        let (x_slope, x_bend) = logarithm(x, &x_gradient, x_hessian);
        let (l_slope, l_bend) = logarithm(length, &l_gradient, l_hessian);
        let (e_slope, e_bend) = logarithm(energy, &e_gradient, e_hessian);
        Expansion {
            value: Value {
                objective: self.objective(x, length, energy),
                x,
                power_length: length,
            },
            gradient: x_slope - l_slope * (1.0 - gauge) - e_slope * (0.5 * gauge),
            hessian: x_bend - l_bend * (1.0 - gauge) - e_bend * (0.5 * gauge),
        }
    }
}

/// v = AΦ′ and P at a node, with their derivatives in (φ₁, φ₂, φ₁′, φ₂′).
struct Local {
    body: Vector3<f64>,
    d_body: SMatrix<f64, 3, 4>,
    d_connection: [Matrix3x2<f64>; 2],
    bent_body: [Vector3<f64>; 3],
    power: f64,
    d_power: Vector4<f64>,
    d2_power: Matrix4<f64>,
}

impl Local {
    fn new(second: &SecondDerivatives<f64>, rate: &Vector2<f64>, over_drag: f64) -> Self {
        let first = &second.first;
        let a = first.connection;
        let by_angle = first.d_connection.map(|d| d * rate);
        let w = first.power * over_drag;
        let along = w * rate * 2.0;
        let w_rate = first.d_power.map(|d| d * rate * over_drag);
        let bent = second.d2_power.map(|d| rate.dot(&(d * rate)) * over_drag);
        let mut d2_power = Matrix4::zeros();
        d2_power
            .fixed_view_mut::<2, 2>(0, 0)
            .copy_from(&Matrix2::new(bent[0], bent[1], bent[1], bent[2]));
        d2_power.fixed_view_mut::<2, 2>(2, 2).copy_from(&(w * 2.0));
        for (i, mixed) in w_rate.iter().enumerate() {
            for k in 0..2 {
                d2_power[(i, 2 + k)] = 2.0 * mixed[k];
                d2_power[(2 + k, i)] = 2.0 * mixed[k];
            }
        }
        Self {
            body: a * rate,
            d_body: SMatrix::from_columns(&[
                by_angle[0],
                by_angle[1],
                a.column(0).into_owned(),
                a.column(1).into_owned(),
            ]),
            d_connection: first.d_connection,
            bent_body: second.d2_connection.map(|d| d * rate),
            power: rate.dot(&along) * 0.5,
            d_power: Vector4::new(rate.dot(&w_rate[0]), rate.dot(&w_rate[1]), along.x, along.y),
            d2_power,
        }
    }

    /// Second derivatives of momentum · v.
    fn d2_body(&self, momentum: &Vector3<f64>) -> Matrix4<f64> {
        let mut bend = Matrix4::zeros();
        for (n, (i, j)) in [(0, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            bend[(i, j)] = momentum.dot(&self.bent_body[n]);
            bend[(j, i)] = bend[(i, j)];
        }
        for (i, d) in self.d_connection.iter().enumerate() {
            let mixed = d.transpose() * momentum;
            for k in 0..2 {
                bend[(i, 2 + k)] = mixed[k];
                bend[(2 + k, i)] = mixed[k];
            }
        }
        bend
    }
}

/// Gradients and Hessians at the nodes in (û, v̂, û′, v̂′), the coordinates in which A and B are apart.
struct Terms {
    gradient: Vec<Vector4<f64>>,
    hessian: Vec<Matrix4<f64>>,
}

impl Terms {
    fn new(count: usize) -> Self {
        Self {
            gradient: vec![Vector4::zeros(); count],
            hessian: vec![Matrix4::zeros(); count],
        }
    }

    fn set(
        &mut self,
        node: usize,
        slopes: &SMatrix<f64, 4, 3>,
        momentum: &Vector3<f64>,
        bend: impl Fn(&Vector3<f64>) -> Matrix4<f64>,
        weight: f64,
    ) {
        self.set_plain(node, &(slopes * momentum), &bend(momentum), weight);
    }

    fn set_plain(
        &mut self,
        node: usize,
        gradient: &Vector4<f64>,
        hessian: &Matrix4<f64>,
        weight: f64,
    ) {
        let turn = turn();
        if let (Some(g), Some(h)) = (self.gradient.get_mut(node), self.hessian.get_mut(node)) {
            *g = turn.transpose() * gradient * weight;
            *h = turn.transpose() * hessian * turn * weight;
        }
    }
}

/// From (û, v̂, û′, v̂′) to (φ₁, φ₂, φ₁′, φ₂′).
fn turn() -> Matrix4<f64> {
    let r = std::f64::consts::FRAC_1_SQRT_2;
    Matrix4::new(
        r, -r, 0.0, 0.0, //
        r, r, 0.0, 0.0, //
        0.0, 0.0, r, -r, //
        0.0, 0.0, r, r,
    )
}

/// (û, v̂, û′, v̂′) at the nodes for each coefficient: four rows a node.
struct Basis {
    rows: DMatrix<f64>,
}

impl Basis {
    fn new(grid: &Grid, order: usize) -> Self {
        let rows = DMatrix::from_fn(4 * grid.nodes.len(), 2 * order, |row, column| {
            let s = grid.nodes.get(row / 4).copied().unwrap_or(0.0);
            let k = (2 * (column % order) + 1) as f64;
            let (sin, cos) = (k * s).sin_cos();
            match (row % 4, column < order) {
                (0, true) => cos,
                (1, false) => sin,
                (2, true) => -k * sin,
                (3, false) => k * cos,
                _ => 0.0,
            }
        });
        Self { rows }
    }

    /// One row of derivatives in the coefficients from a gradient in (φ₁, φ₂, φ₁′, φ₂′).
    fn row(&self, node: usize, gradient: &Vector4<f64>, into: &mut DMatrix<f64>) {
        let local = turn().transpose() * gradient;
        let here = self.rows.fixed_rows::<4>(4 * node);
        into.row_mut(node)
            .copy_from(&here.tr_mul(&local).transpose());
    }

    fn assemble(&self, terms: &Terms) -> (DVector<f64>, DMatrix<f64>) {
        let size = self.rows.ncols();
        let mut gradient = DVector::zeros(size);
        let mut weighed = DMatrix::zeros(self.rows.nrows(), size);
        for (node, (g, h)) in terms.gradient.iter().zip(&terms.hessian).enumerate() {
            let here = self.rows.fixed_rows::<4>(4 * node);
            gradient += here.tr_mul(g);
            weighed.fixed_rows_mut::<4>(4 * node).copy_from(&(h * here));
        }
        (gradient, self.rows.tr_mul(&weighed))
    }
}
