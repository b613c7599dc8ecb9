//! The functions that a closed curve is a sum of, tabulated at the Gauss nodes of its panels.

use nalgebra::{DMatrix, Vector2};

/// Gauss nodes in a panel.
pub(crate) const STAGES: usize = 3;

/// sqrt(15)
const ROOT: f64 = 3.872_983_346_207_417;
/// Nodes on [0, 1].
pub(crate) const NODES: [f64; STAGES] = [0.5 - ROOT / 10.0, 0.5, 0.5 + ROOT / 10.0];
/// Weights on [0, 1].
pub(crate) const WEIGHTS: [f64; STAGES] = [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0];
/// Integrals from 0 to node q of the polynomial that is 1 at node r, over weight r: row q, column r.
pub(crate) const PARTIAL: [[f64; STAGES]; STAGES] = [
    [0.5, 0.5 - ROOT * 3.0 / 20.0, 0.5 - ROOT * 3.0 / 25.0],
    [0.5 + ROOT * 3.0 / 20.0, 0.5, 0.5 - ROOT * 3.0 / 20.0],
    [0.5 + ROOT * 3.0 / 25.0, 0.5 + ROOT * 3.0 / 20.0, 0.5],
];

/// Basis functions and their slopes at every Gauss node.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Basis {
    kind: Kind,
    panels: usize,
    /// One column a node: the value of each function.
    pub(crate) values: DMatrix<f64>,
    /// The same for the derivative by u times the panel's width.
    pub(crate) slopes: DMatrix<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// 1, cos 2πu, sin 2πu, cos 4πu, …
    Fourier { order: usize },
    /// Uniform cubic B-splines, one a panel.
    #[allow(
        dead_code,
        reason = "the local basis, for finer curves than a series can hold"
    )]
    Spline,
}

impl Basis {
    /// A Fourier series to this order (the paper's Appendix C, without its symmetries).
    pub(crate) fn fourier(order: usize, panels: usize) -> Self {
        Self::tabulated(Kind::Fourier { order }, 2 * order + 1, panels)
    }

    /// A closed cubic spline whose knots are the panels' ends.
    #[allow(
        dead_code,
        reason = "the local basis, for finer curves than a series can hold"
    )]
    pub(crate) fn spline(panels: usize) -> Self {
        Self::tabulated(Kind::Spline, panels, panels)
    }

    fn tabulated(kind: Kind, functions: usize, panels: usize) -> Self {
        let panels = panels.max(4);
        let mut basis = Self {
            kind,
            panels,
            values: DMatrix::zeros(functions, panels * STAGES),
            slopes: DMatrix::zeros(functions, panels * STAGES),
        };
        let width = 1.0 / panels as f64;
        let mut column = vec![(0.0, 0.0); functions];
        for node in 0..panels * STAGES {
            basis.at(basis.u(node), &mut column);
            for (j, &(value, slope)) in column.iter().enumerate() {
                basis.values[(j, node)] = value;
                basis.slopes[(j, node)] = slope * width;
            }
        }
        basis
    }

    pub(crate) fn functions(&self) -> usize {
        self.values.nrows()
    }

    pub(crate) fn panels(&self) -> usize {
        self.panels
    }

    pub(crate) fn nodes(&self) -> usize {
        self.values.ncols()
    }

    /// Where a node is, as a fraction of the cycle.
    pub(crate) fn u(&self, node: usize) -> f64 {
        let inside = NODES.get(node % STAGES).copied().unwrap_or(0.5);
        ((node / STAGES) as f64 + inside) / self.panels as f64
    }

    /// ∮(b′)² du of a function, that of the slowest for a constant: how much it lengthens a curve. Steps are damped in
    /// proportion.
    pub(crate) fn roughness(&self, function: usize) -> f64 {
        match self.kind {
            Kind::Fourier { .. } => {
                let rate = std::f64::consts::TAU * function.div_ceil(2).max(1) as f64;
                0.5 * rate * rate
            }
            Kind::Spline => self.panels as f64 * 2.0 / 3.0,
        }
    }

    /// Turns the curve round: the same points, run backwards from the same start.
    pub(crate) fn reverse(&self, coefficients: &mut DMatrix<f64>) {
        match self.kind {
            Kind::Fourier { order } => {
                for k in 1..=order {
                    let mut sine = coefficients.column_mut(2 * k);
                    sine.neg_mut();
                }
            }
            Kind::Spline => {
                let mirrored = DMatrix::from_fn(2, self.panels, |row, j| {
                    coefficients[(row, (self.panels - j) % self.panels)]
                });
                coefficients.copy_from(&mirrored);
            }
        }
    }

    /// The curve with these coefficients at a fraction of the cycle.
    pub(crate) fn shape(&self, coefficients: &DMatrix<f64>, u: f64) -> Vector2<f64> {
        let mut here = vec![(0.0, 0.0); self.functions()];
        self.at(u, &mut here);
        here.iter()
            .zip(coefficients.column_iter())
            .map(|((value, _), c)| Vector2::new(c[0], c[1]) * *value)
            .sum()
    }

    /// Value and derivative by u of every function at a fraction of the cycle.
    pub(crate) fn at(&self, u: f64, out: &mut [(f64, f64)]) {
        match self.kind {
            Kind::Fourier { order } => {
                if let Some(first) = out.first_mut() {
                    *first = (1.0, 0.0);
                }
                for k in 1..=order {
                    let rate = std::f64::consts::TAU * k as f64;
                    let (sin, cos) = (rate * u).sin_cos();
                    if let Some([even, odd]) = out.get_mut(2 * k - 1..=2 * k) {
                        *even = (cos, -rate * sin);
                        *odd = (sin, rate * cos);
                    }
                }
            }
            Kind::Spline => {
                out.fill((0.0, 0.0));
                let place = (u - u.floor()) * self.panels as f64;
                #[allow(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "0 <= place <= panels"
                )]
                let (panel, t) = ((place as usize).min(self.panels - 1), place.fract());
                let rest = 1.0 - t;
                let pieces = [
                    (rest * rest * rest / 6.0, -rest * rest / 2.0),
                    (
                        (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
                        (3.0 * t * t - 4.0 * t) / 2.0,
                    ),
                    (
                        (-3.0 * t * t * t + 3.0 * t * t + 3.0 * t + 1.0) / 6.0,
                        (-3.0 * t * t + 2.0 * t + 1.0) / 2.0,
                    ),
                    (t * t * t / 6.0, t * t / 2.0),
                ];
                for (shift, (value, slope)) in pieces.into_iter().enumerate() {
                    let function = (panel + self.panels + shift - 1) % self.panels;
                    if let Some(entry) = out.get_mut(function) {
                        *entry = (value, slope * self.panels as f64);
                    }
                }
            }
        }
    }
}
