//! Predicted quantities of a gait as functions of ln χ and r_s: Chebyshev interpolation, with exact derivatives of the interpolant.

use calibrate::{PredictionError, predict};
use swimmer_files::{AnyGait, SwimmerFile};

/// Quantities of a trial: X \[m\], ΔY \[m\], Δθ \[rad\].
pub const QUANTITIES: usize = 3;
/// Nodes per parameter.
const NODES: usize = 6;
/// Range of ln χ around that of the swimmer file.
const LN_CHI: f64 = 0.45;
/// Range of r_s around that of the swimmer file: as a share of it, and as a share of the swimmer's length.
const RADIUS: [f64; 2] = [0.4, 0.02];

/// Predicted X, ΔY and Δθ of a gait for swimmers whose χ and r_s are near those of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    centre: [f64; 2],
    half: [f64; 2],
    middle_m: f64,
    /// Coefficients of T_i(ln χ) T_j(r_s).
    coefficients: [[[f64; NODES]; NODES]; QUANTITIES],
}

impl Response {
    /// Computes the response of a gait that is played at a period, with the servos of the file.
    ///
    /// # Errors
    /// As [`predict`].
    ///
    /// ```
    /// use calibrate::predict;
    /// use experiment::adaptive::Response;
    /// use swimmer_files::{AnyGait, SwimmerFile};
    ///
    /// let mut robot = SwimmerFile::preset("robot").unwrap();
    /// let circle = AnyGait::circle(1.2);
    /// let response = Response::of(&robot, &circle, 12.0)?;
    /// robot.swimmer.chi *= 1.13;
    /// robot.swimmer.sphere_radius *= 0.87;
    /// let (values, _) = response.at([robot.swimmer.chi.ln(), robot.swimmer.sphere_radius]);
    /// let exact = predict(&robot, &circle, 12.0)?;
    /// assert!((values[0] / exact.x_m - 1.0).abs() < 1e-4);
    /// assert!((values[2] / exact.delta_theta_rad - 1.0).abs() < 1e-4);
    /// # Ok::<(), calibrate::PredictionError>(())
    /// ```
    pub fn of(file: &SwimmerFile, gait: &AnyGait, period_s: f64) -> Result<Self, PredictionError> {
        let swimmer = &file.swimmer;
        let reach = RADIUS[0] * swimmer.sphere_radius + RADIUS[1] * swimmer.total_length();
        let [low, high] = [
            (swimmer.sphere_radius - reach).max(0.0),
            swimmer.sphere_radius + reach,
        ];
        let centre = [swimmer.chi.ln(), f64::midpoint(low, high)];
        let half = [LN_CHI, 0.5 * (high - low)];
        let mut values = [[[0.0; NODES]; NODES]; QUANTITIES];
        let nodes = nodes();
        for (i, x) in nodes.into_iter().enumerate() {
            for (j, y) in nodes.into_iter().enumerate() {
                let mut other = file.clone();
                other.swimmer.chi = (centre[0] + half[0] * x).exp();
                other.swimmer.sphere_radius = centre[1] + half[1] * y;
                let cycle = predict(&other, gait, period_s)?;
                let quantities = [cycle.x_m, cycle.delta_y_m, cycle.delta_theta_rad];
                for (of, value) in values.iter_mut().zip(quantities) {
                    of[i][j] = value;
                }
            }
        }
        Ok(Self {
            centre,
            half,
            middle_m: swimmer.links.middle,
            coefficients: values.map(|values| coefficients(&values)),
        })
    }

    /// Length of the middle link \[m\].
    pub(super) fn middle_m(&self) -> f64 {
        self.middle_m
    }

    /// Nearest ln χ and r_s \[m\] for which the response holds.
    pub(super) fn clamped(&self, at: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|which| {
            let (centre, half) = (self.centre[which], self.half[which]);
            at[which].clamp(centre - half, centre + half)
        })
    }

    /// Returns `true` if ln χ or r_s is at the border of the range for which the response holds.
    pub(super) fn is_at_border(&self, at: [f64; 2]) -> bool {
        (0..2).any(|which| (at[which] - self.centre[which]).abs() > 0.98 * self.half[which])
    }

    /// Values at ln χ and r_s \[m\], and their derivatives by both.
    pub fn at(&self, at: [f64; 2]) -> ([f64; QUANTITIES], [[f64; 2]; QUANTITIES]) {
        let [x, y] = [0, 1].map(|which: usize| {
            ((at[which] - self.centre[which]) / self.half[which]).clamp(-1.0, 1.0)
        });
        let (along, slope_along) = polynomials(x);
        let (across, slope_across) = polynomials(y);
        let (mut values, mut slopes) = ([0.0; QUANTITIES], [[0.0; 2]; QUANTITIES]);
        for (quantity, rows) in self.coefficients.iter().enumerate() {
            for (i, row) in rows.iter().enumerate() {
                for (j, coefficient) in row.iter().enumerate() {
                    values[quantity] += coefficient * along[i] * across[j];
                    slopes[quantity][0] += coefficient * slope_along[i] * across[j] / self.half[0];
                    slopes[quantity][1] += coefficient * along[i] * slope_across[j] / self.half[1];
                }
            }
        }
        (values, slopes)
    }
}

/// Chebyshev nodes on \[−1, 1\].
fn nodes() -> [f64; NODES] {
    std::array::from_fn(|i| (std::f64::consts::PI * (i as f64 + 0.5) / NODES as f64).cos())
}

/// Chebyshev polynomials and their derivatives.
fn polynomials(x: f64) -> ([f64; NODES], [f64; NODES]) {
    let (mut values, mut slopes) = ([1.0; NODES], [0.0; NODES]);
    values[1] = x;
    slopes[1] = 1.0;
    for i in 2..NODES {
        values[i] = 2.0 * x * values[i - 1] - values[i - 2];
        slopes[i] = 2.0 * values[i - 1] + 2.0 * x * slopes[i - 1] - slopes[i - 2];
    }
    (values, slopes)
}

/// Coefficients of values at the nodes, by the discrete orthogonality of the polynomials.
fn coefficients(values: &[[f64; NODES]; NODES]) -> [[f64; NODES]; NODES] {
    let at_nodes = nodes().map(|node| polynomials(node).0);
    let weight = |index: usize| if index == 0 { 1.0 } else { 2.0 } / NODES as f64;
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let mut sum = 0.0;
            for (row, along) in values.iter().zip(&at_nodes) {
                for (value, across) in row.iter().zip(&at_nodes) {
                    sum += value * along[i] * across[j];
                }
            }
            sum * weight(i) * weight(j)
        })
    })
}
