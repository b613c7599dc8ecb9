//! Basis functions of closed curves, tabulated at the Gauss nodes of the panels.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{DMatrix, Vector2};

/// Number of Gauss nodes per panel.
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
    /// `true` if the first function is the constant 1.
    has_constant: bool,
    /// Angular frequency of each pair of cosine and sine.
    rates: Vec<f64>,
    panels: usize,
    /// Value of each function, one column per node.
    pub(crate) values: DMatrix<f64>,
    /// Derivative by u times the width of the panel, one column per node.
    pub(crate) slopes: DMatrix<f64>,
}

impl Basis {
    /// Fourier series to this order (the paper's Appendix C, without its symmetries): 1, cos 2πu, sin 2πu, cos 4πu, …
    pub(crate) fn fourier(order: usize, panels: usize) -> Self {
        let rates = (1..=order).map(|k| TAU * k as f64);
        Self::tabulated(true, rates.collect(), panels)
    }

    /// Odd part of a series over a quarter of the cycle, on which u is defined: the terms that the paper's two symmetries keep, with
    /// φ₁ = φ₂ in the cosines and φ₁ = −φ₂ in the sines: cos s, sin s, cos 3s, sin 3s, …, s = 0 … π/2.
    pub(crate) fn quarter(order: usize, panels: usize) -> Self {
        let rates = (0..order).map(|n| FRAC_PI_2 * (2 * n + 1) as f64);
        Self::tabulated(false, rates.collect(), panels)
    }

    fn tabulated(has_constant: bool, rates: Vec<f64>, panels: usize) -> Self {
        let functions = usize::from(has_constant) + 2 * rates.len();
        let panels = panels.max(4);
        let mut basis = Self {
            has_constant,
            rates,
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

    /// Fraction of the cycle at a node.
    pub(crate) fn u(&self, node: usize) -> f64 {
        let inside = NODES.get(node % STAGES).copied().unwrap_or(0.5);
        ((node / STAGES) as f64 + inside) / self.panels as f64
    }

    /// ∮(b′)² du of a function, or that of the lowest frequency for the constant. Steps are damped in proportion.
    pub(crate) fn roughness(&self, function: usize) -> f64 {
        let pair = function.saturating_sub(usize::from(self.has_constant)) / 2;
        let rate = self.rates.get(pair).copied().unwrap_or_default();
        0.5 * rate * rate
    }

    /// Reverses a closed curve with the same start.
    pub(crate) fn reverse(&self, coefficients: &mut DMatrix<f64>) {
        for k in (usize::from(self.has_constant) + 1..self.functions()).step_by(2) {
            let mut sine = coefficients.column_mut(k);
            sine.neg_mut();
        }
    }

    /// Evaluates the curve with these coefficients at a fraction of the cycle.
    pub(crate) fn shape(&self, coefficients: &DMatrix<f64>, u: f64) -> Vector2<f64> {
        let mut here = vec![(0.0, 0.0); self.functions()];
        self.at(u, &mut here);
        here.iter()
            .zip(coefficients.column_iter())
            .map(|((value, _), c)| Vector2::new(c[0], c[1]) * *value)
            .sum()
    }

    /// Value and slope per panel of every function at a node.
    pub(super) fn at_node(&self, node: usize) -> impl Iterator<Item = (f64, f64)> + '_ {
        let own = node * self.functions()..(node + 1) * self.functions();
        let [values, slopes] = [&self.values, &self.slopes].map(|all| &all.as_slice()[own.clone()]);
        values.iter().copied().zip(slopes.iter().copied())
    }

    /// Value and derivative by u of every function at a fraction of the cycle.
    pub(crate) fn at(&self, u: f64, out: &mut [(f64, f64)]) {
        let (constant, waves) = out.split_at_mut(usize::from(self.has_constant));
        constant.fill((1.0, 0.0));
        for (pair, rate) in waves.chunks_exact_mut(2).zip(&self.rates) {
            let (sin, cos) = (rate * u).sin_cos();
            pair.copy_from_slice(&[(cos, -rate * sin), (sin, rate * cos)]);
        }
    }
}
