//! Interpolation of the model over a rectangle of (r_s/L, ln χ) by polynomials, which replace the model in profiles, contours and
//! a thousand refits. The error of the polynomials is measured, not assumed.

use std::f64::consts::PI;

use nalgebra::DMatrix;

use crate::least_squares::Model;

/// Degree of the polynomials in each parameter.
const DEGREE: usize = 7;
const NODES: usize = DEGREE + 1;

/// A rectangle in (r_s/L, ln χ).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rectangle {
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
}

impl Rectangle {
    /// About a point, with half widths; r_s never goes below 0, nor χ out of reach.
    pub(super) fn about(centre: [f64; 2], half: [f64; 2]) -> Self {
        Self {
            low: [(centre[0] - half[0]).max(0.0), centre[1] - half[1]],
            high: [centre[0] + half[0], centre[1] + half[1]],
        }
    }

    /// Returns `true` if a point lies inside or on the border.
    pub(super) fn contains(&self, q: [f64; 2]) -> bool {
        [0, 1]
            .iter()
            .all(|i| (self.low[*i]..=self.high[*i]).contains(&q[*i]))
    }

    /// Returns `true` if a point lies well inside; the border r_s = 0 counts as inside.
    pub(super) fn holds(&self, q: [f64; 2]) -> bool {
        [0, 1].iter().all(|i| {
            let margin = 0.1 * (self.high[*i] - self.low[*i]);
            let bottom = self.low[*i] <= 0.0 && *i == 0;
            (bottom || q[*i] > self.low[*i] + margin) && q[*i] < self.high[*i] - margin
        })
    }

    /// In (−1, 1).
    fn place(&self, q: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| (2.0 * q[i] - self.low[i] - self.high[i]) / (self.high[i] - self.low[i]))
    }
}

/// X, ΔY, Δθ of every run as functions of (r_s/L, ln χ), each in units of its scale.
#[derive(Debug, Clone)]
pub(super) struct Surface {
    pub(super) rectangle: Rectangle,
    /// One row for each pair of degrees, one column for each quantity of each run.
    coefficients: DMatrix<f64>,
    /// Largest deviation from the model at the points where it was looked for.
    pub(super) error: f64,
}

impl Surface {
    /// Asks a model of r_s/L and ln χ at 64 points; `None` where it cannot swim at one.
    pub(super) fn new(model: &impl Model, rectangle: Rectangle) -> Option<Self> {
        let ask = |q: [f64; 2]| model.values(&q);
        let columns = ask(rectangle.low)?.len();
        let node = |i: usize| (PI * (i as f64 + 0.5) / NODES as f64).cos();
        let at = |u: [f64; 2]| {
            let Rectangle { low, high } = rectangle;
            [0, 1].map(|i| low[i] + (high[i] - low[i]) * (u[i] + 1.0) / 2.0)
        };
        let mut coefficients = DMatrix::zeros(NODES * NODES, columns);
        for i in 0..NODES {
            for j in 0..NODES {
                let values = ask(at([node(i), node(j)]))?;
                let (a, b) = (chebyshev(node(i)).0, chebyshev(node(j)).0);
                for m in 0..NODES {
                    for n in 0..NODES {
                        let norm = if m == 0 { 1.0 } else { 2.0 } * if n == 0 { 1.0 } else { 2.0 };
                        let share = norm * a[m] * b[n] / (NODES * NODES) as f64;
                        for (column, value) in values.iter().enumerate() {
                            coefficients[(m * NODES + n, column)] += share * value;
                        }
                    }
                }
            }
        }
        let mut surface = Self {
            rectangle,
            coefficients,
            error: 0.0,
        };
        for u in [[0.0, 0.0], [0.83, -0.9], [-0.97, 0.97]] {
            let off = surface.values(&at(u))?.into_iter().zip(ask(at(u))?);
            surface.error = off.fold(surface.error, |worst, (a, b)| worst.max((a - b).abs()));
        }
        Some(surface)
    }

    /// Sums over pairs of degrees with these factors for them.
    fn sum(&self, factor: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let mut out = vec![0.0; self.coefficients.ncols()];
        for m in 0..NODES {
            for n in 0..NODES {
                let factor = factor(m, n);
                for (out, c) in out.iter_mut().zip(&self.coefficients.row(m * NODES + n)) {
                    *out += factor * c;
                }
            }
        }
        out
    }
}

impl Model for Surface {
    fn bounds(&self) -> Vec<(f64, f64)> {
        let Rectangle { low, high } = self.rectangle;
        low.into_iter().zip(high).collect()
    }

    fn values(&self, at: &[f64]) -> Option<Vec<f64>> {
        let [u, v] = self.rectangle.place([at[0], at[1]]);
        let ((a, _), (b, _)) = (chebyshev(u), chebyshev(v));
        Some(self.sum(|m, n| a[m] * b[n]))
    }

    fn jacobian(&self, at: &[f64]) -> Option<DMatrix<f64>> {
        let [u, v] = self.rectangle.place([at[0], at[1]]);
        let ((a, da), (b, db)) = (chebyshev(u), chebyshev(v));
        let inner = [0, 1].map(|i| 2.0 / (self.rectangle.high[i] - self.rectangle.low[i]));
        let columns = [
            self.sum(|m, n| da[m] * b[n] * inner[0]),
            self.sum(|m, n| a[m] * db[n] * inner[1]),
        ];
        Some(DMatrix::from_fn(columns[0].len(), 2, |row, column| {
            columns[column][row]
        }))
    }
}

/// Chebyshev polynomials and their derivatives.
fn chebyshev(u: f64) -> ([f64; NODES], [f64; NODES]) {
    let (mut values, mut slopes) = ([1.0; NODES], [0.0; NODES]);
    values[1] = u;
    slopes[1] = 1.0;
    for n in 2..NODES {
        values[n] = 2.0 * u * values[n - 1] - values[n - 2];
        slopes[n] = 2.0 * values[n - 1] + 2.0 * u * slopes[n - 1] - slopes[n - 2];
    }
    (values, slopes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::parameter::Parameter;
    use crate::fit::run_model::RunModel;
    use crate::prediction::Played;
    use swimmer_files::{AnyGait, SwimmerFile};

    #[test]
    fn the_surface_is_the_model() {
        let start = SwimmerFile::preset("robot").unwrap();
        let played = [0.6, 1.8]
            .map(|amplitude| Played::commanded(&AnyGait::circle(amplitude), None, 10.0).unwrap());
        let robot = start.swimmer;
        let parameters = vec![Parameter::SphereRadius, Parameter::Chi];
        let model = RunModel::new(
            start,
            played.to_vec(),
            [0.01, 0.02, 0.5, 0.01, 0.5],
            parameters,
        );
        let centre = [robot.sphere_radius / robot.total_length(), robot.chi.ln()];
        let rectangle = Rectangle::about(centre, [0.05, 0.2]);
        let surface = Surface::new(&model, rectangle).unwrap();
        assert!(surface.error < 1e-6, "{}", surface.error);
        let q = [centre[0] + 0.02, centre[1] - 0.1];
        let ask = |q: [f64; 2]| model.values(&q).unwrap();
        let (values, jacobian) = (surface.values(&q).unwrap(), surface.jacobian(&q).unwrap());
        for (row, (value, truth)) in values.iter().zip(ask(q)).enumerate() {
            assert!((value - truth).abs() < 1e-6, "{value} {truth}");
            for parameter in 0..2 {
                let mut ahead = q;
                let mut behind = q;
                ahead[parameter] += 1e-4;
                behind[parameter] -= 1e-4;
                let slope = (ask(ahead)[row] - ask(behind)[row]) / 2e-4;
                assert!((jacobian[(row, parameter)] - slope).abs() < 1e-4 * (1.0 + slope.abs()));
            }
        }
    }

    #[test]
    fn rectangles_end_at_no_sphere() {
        let rectangle = Rectangle::about([0.01, 1.0], [0.05, 0.5]);
        assert!(rectangle.low[0].abs() <= 0.0);
        assert!(rectangle.holds([0.0, 1.0]) && !rectangle.holds([0.059, 1.0]));
    }
}
