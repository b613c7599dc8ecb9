//! One element of the KKT system: gradient and Hessian of the Lagrangian, with its states condensed.
//!
//! What is left of an element are its shapes and the heading at its start. Its unknowns lie in the order nodes 1 … d, the
//! point it shares with the element before, θ there: the first 2d are eliminated, the last three are handed on.

use nalgebra::{Matrix2, Vector2, Vector3};
use swimmer_model::Model;

use super::mesh::Element;
use super::path::Path;
use super::walls::WallTerm;

/// Rows of right-hand sides below the matrix: the gradients of the barrier, of `x_f` and of `E_f`.
pub(crate) const SIDES: usize = 3;

/// The block of one element, and after elimination its factor.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    /// Eliminated unknowns 2d.
    pub(crate) inner: usize,
    /// All unknowns, 2d + 3.
    pub(crate) size: usize,
    /// (size + SIDES) rows of `size`: the Hessian's lower triangle, then the right-hand sides.
    pub(crate) matrix: Vec<f64>,
    pub(crate) factor: Vec<f64>,
    /// θ at the element's end per unknown.
    pub(crate) end_heading: Vec<f64>,
    scratch: Scratch,
}

#[derive(Debug, Clone)]
struct Scratch {
    /// θ̇ at each node per unknown.
    turning: Vec<f64>,
    /// θ at one node per unknown.
    heading: Vec<f64>,
    /// Mixed derivatives of each node's share of the Lagrangian by θ there and by each unknown.
    with_heading: Vec<f64>,
    /// ∂²/∂θ² of each node's share, and of `x_f`, ∂/∂θ.
    by_heading: Vec<[f64; 2]>,
}

/// Derivatives of ln E − 2 ln x by x and E.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Prices {
    pub(crate) x: f64,
    pub(crate) energy: f64,
}

impl Block {
    pub(crate) fn new(degree: usize) -> Self {
        let (inner, size) = (2 * degree, 2 * degree + 3);
        Self {
            inner,
            size,
            matrix: vec![0.0; (size + SIDES) * size],
            factor: vec![0.0; (size + SIDES) * size],
            end_heading: vec![0.0; size],
            scratch: Scratch {
                turning: vec![0.0; degree * size],
                heading: vec![0.0; size],
                with_heading: vec![0.0; degree * size],
                by_heading: vec![[0.0; 2]; degree],
            },
        }
    }

    /// Where the angles of point m lie among the unknowns.
    pub(crate) fn place(&self, point: usize) -> usize {
        if point == 0 {
            self.inner
        } else {
            2 * (point - 1)
        }
    }

    /// Fills the block. `later` is what θ does to `x_f` in all elements after this one; it is returned with this one's added. The
    /// costate of θ for `x_f` alone is left at each node of `lambda_theta`.
    pub(crate) fn assemble(
        &mut self,
        model: &Model<f64>,
        element: &Element,
        path: &Path,
        prices: Prices,
        later: f64,
        lambda_theta: &mut [f64],
    ) -> f64 {
        let (rule, h) = (element.rule, element.length);
        self.matrix.fill(0.0);
        self.scratch.turning.fill(0.0);
        self.scratch.with_heading.fill(0.0);
        let mut total = later;
        for (j, weight) in (1..=rule.degree).zip(rule.weights()) {
            let pull = -h * weight * path.nodes[element.first + j].velocity().y;
            self.scratch.by_heading[j - 1][1] = pull;
            total += pull;
        }
        // A turn at node j turns the nodes after it, by the quadrature's shares, and all later elements.
        for (j, weight) in (1..=rule.degree).zip(rule.weights()) {
            let here: f64 = (1..=rule.degree)
                .map(|m| rule.integral(m)[j - 1] * self.scratch.by_heading[m - 1][1])
                .sum();
            lambda_theta[element.first + j] = later + here / weight;
        }
        for j in 1..=rule.degree {
            self.add_node(model, element, path, j, prices, lambda_theta);
        }
        for j in 1..=rule.degree {
            self.add_heading(element, j);
        }
        total
    }

    /// One node's share of the Lagrangian, its derivatives by (φ, u) chained to the unknowns.
    fn add_node(
        &mut self,
        model: &Model<f64>,
        element: &Element,
        path: &Path,
        j: usize,
        prices: Prices,
        lambda_theta: &[f64],
    ) {
        let node = &path.nodes[element.first + j];
        let (n, u) = (self.size, &node.rate);
        let weight = element.length * element.rule.weights()[j - 1];
        let second = model.second_derivatives(&path.phi[element.first + j]);
        let first = &second.first;
        // x_f = Σ weight (cos θ, −sin θ, 0)·A u, and θ̇ = (0, 0, 1)·A u is worth its costate.
        let of_x = Vector3::new(node.cos, -node.sin, lambda_theta[element.first + j]) * weight;
        let turned = Vector3::new(-node.sin, -node.cos, 0.0) * (weight * prices.x);
        let (carry, spend) = (of_x * prices.x, weight * prices.energy);
        let slopes = first.d_connection.map(|d| d * u);
        let loads = first.d_power.map(|d| d * u);
        let push = first.connection.tr_mul(&of_x);
        let push_turned = first.connection.tr_mul(&turned);
        let effort = node.power * u * (2.0 * weight);
        let mixed = [0, 1].map(|i| first.d_connection[i].tr_mul(&carry) + loads[i] * (2.0 * spend));
        let turning_by_rate = [first.connection.m31, first.connection.m32];
        let at = self.place(j);
        let row = (j - 1) * n;
        for i in 0..2 {
            self.matrix[(n + 1) * n + at + i] += of_x.dot(&slopes[i]);
            self.matrix[(n + 2) * n + at + i] += weight * u.dot(&loads[i]);
            self.scratch.turning[row + at + i] += slopes[i].z;
            self.scratch.with_heading[row + at + i] += turned.dot(&slopes[i]);
        }
        self.scratch.by_heading[j - 1][0] = -prices.x * weight * node.velocity().x;
        for (k, (i, l)) in [(0, 0), (1, 0), (1, 1)].into_iter().enumerate() {
            self.matrix[(at + i) * n + at + l] += carry.dot(&(second.d2_connection[k] * u))
                + spend * u.dot(&(second.d2_power[k] * u));
        }
        for (m, slope) in element.rule.slope(j).iter().enumerate() {
            let other = self.place(m);
            let share = slope / element.length;
            for c in 0..2 {
                self.matrix[(n + 1) * n + other + c] += share * push[c];
                self.matrix[(n + 2) * n + other + c] += share * effort[c];
                self.scratch.turning[row + other + c] += share * turning_by_rate[c];
                self.scratch.with_heading[row + other + c] += share * push_turned[c];
                for (i, mixed) in mixed.iter().enumerate() {
                    // Where the shape meets itself, both orders of the mixed derivative fall on one entry.
                    let (a, b) = (at + i, other + c);
                    let twice = if a == b { 2.0 } else { 1.0 };
                    self.matrix[a.max(b) * n + a.min(b)] += twice * share * mixed[c];
                }
            }
        }
        self.add_effort(element, j, &(node.power * (2.0 * spend)));
    }

    /// uᵀWu by the rates: every pair of points that the rate at node j is made of.
    fn add_effort(&mut self, element: &Element, j: usize, stiffness: &Matrix2<f64>) {
        let n = self.size;
        let slope = element.rule.slope(j);
        let over = 1.0 / (element.length * element.length);
        for (m, &share) in slope.iter().enumerate() {
            let a = self.place(m);
            let stiff = stiffness * (share * over);
            for (l, &other) in slope.iter().enumerate() {
                let b = self.place(l);
                if b > a {
                    continue;
                }
                self.matrix[a * n + b] += other * stiff.m11;
                self.matrix[(a + 1) * n + b] += other * stiff.m21;
                self.matrix[(a + 1) * n + b + 1] += other * stiff.m22;
                if b < a {
                    self.matrix[a * n + b + 1] += other * stiff.m12;
                }
            }
        }
    }

    /// Chains θ at node j to the unknowns: quadrature of the rates, and θ at the element's start. At the last node this is
    /// θ at the end.
    fn add_heading(&mut self, element: &Element, j: usize) {
        let n = self.size;
        let Scratch {
            turning,
            heading,
            with_heading,
            by_heading,
        } = &mut self.scratch;
        heading.fill(0.0);
        heading[n - 1] = 1.0;
        for (share, rates) in element.rule.integral(j).iter().zip(turning.chunks_exact(n)) {
            for (value, rate) in heading.iter_mut().zip(rates) {
                *value += element.length * share * rate;
            }
        }
        let with = &mut with_heading[(j - 1) * n..j * n];
        let half = 0.5 * by_heading[j - 1][0];
        for (value, theta) in with.iter_mut().zip(heading.iter()) {
            *value += half * theta;
        }
        for (a, line) in self.matrix.chunks_exact_mut(n).take(n).enumerate() {
            let (theta, mixed) = (heading[a], with[a]);
            for ((value, other_theta), other_mixed) in
                line[..=a].iter_mut().zip(heading.iter()).zip(with.iter())
            {
                *value += theta * other_mixed + mixed * other_theta;
            }
        }
        if j == element.rule.degree {
            self.end_heading.copy_from_slice(heading);
        }
    }

    /// Adds what the walls of a point give.
    pub(crate) fn add_walls(&mut self, point: usize, term: &WallTerm) {
        let (n, at) = (self.size, self.place(point));
        self.matrix[n * n + at] += term.gradient.x;
        self.matrix[n * n + at + 1] += term.gradient.y;
        self.matrix[at * n + at] += term.hessian.m11;
        self.matrix[(at + 1) * n + at] += term.hessian.m21;
        self.matrix[(at + 1) * n + at + 1] += term.hessian.m22;
    }

    /// A right-hand side times a change of the shapes at this element's points.
    pub(crate) fn against(&self, side: usize, shapes: &[Vector2<f64>]) -> f64 {
        let row = &self.matrix[(self.size + side) * self.size..];
        shapes
            .iter()
            .enumerate()
            .map(|(point, shape)| {
                let at = self.place(point);
                row[at] * shape.x + row[at + 1] * shape.y
            })
            .sum()
    }
}
