//! One cycle of poses as mean, drift and harmonics. Least squares over all samples: they need not be evenly spaced, and what
//! is missing carries no weight. The same curve is drawn through measured cycles and through predicted ones, so whatever it
//! leaves out, it leaves out on both sides.

use std::f64::consts::TAU;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Vector2};
use swimmer_model::Pose;

use super::integral::weights;

/// Harmonics of a cycle: enough for the shapes of strokes, few enough that noise of 1 mm in 200 samples widens a range of 20 mm
/// by less than 0.5 %.
pub(crate) const HARMONICS: usize = 5;
/// Mean, drift, and cosine and sine of each harmonic.
const TERMS: usize = 2 + 2 * HARMONICS;
/// Samples of a predicted cycle.
const PREDICTED: usize = 256;
/// Points at which a curve's extremes are looked for; between them a parabola is exact to 1e-6 of the amplitude.
const LOOKS: usize = 256;

/// x, y, θ over one cycle, u from 0 to 1.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Curve {
    terms: [[f64; 3]; TERMS],
    /// By how much each term follows where the drift is set: what least squares makes of the others then.
    following: [f64; TERMS],
}

/// The drift among the terms.
const DRIFT: usize = 1;

/// Coefficients of the terms by the drift, from the factors of a Gram matrix.
fn following(factors: &Cholesky<f64, Dyn>) -> [f64; TERMS] {
    let unit = DVector::from_fn(TERMS, |i, _| if i == DRIFT { 1.0 } else { 0.0 });
    let column = factors.solve(&unit);
    std::array::from_fn(|i| column[i] / column[DRIFT])
}

/// The functions that a curve is made of, at u.
fn basis(u: f64) -> [f64; TERMS] {
    let mut out = [1.0; TERMS];
    let (sin, cos) = (TAU * u).sin_cos();
    let (mut c, mut s) = (1.0, 0.0);
    for (index, value) in out.iter_mut().enumerate().skip(1) {
        *value = match index {
            1 => u - 0.5,
            _ if index % 2 == 0 => {
                (c, s) = (c * cos - s * sin, s * cos + c * sin);
                c
            }
            _ => s,
        };
    }
    out
}

fn coordinates(pose: &Pose<f64>) -> [f64; 3] {
    [pose.x, pose.y, pose.theta]
}

impl Curve {
    /// The curve of least squares and the root mean square distance of the samples' positions from it \[m\]; `None` where
    /// the samples do not determine it.
    ///
    /// `spacing` is that of the samples, in u. Weights near both ends make sums over samples the integrals over the cycle that
    /// a prediction's sums are too, wherever in the cycle the first sample falls.
    pub(crate) fn fit(
        samples: impl Iterator<Item = (f64, Pose<f64>)> + Clone,
        spacing: f64,
    ) -> Option<(Self, f64)> {
        let places: Vec<f64> = samples.clone().map(|(u, _)| u).collect();
        let weights = weights(&places, spacing, MEASURED_END);
        let mut gram = DMatrix::<f64>::zeros(TERMS, TERMS);
        let mut right = DMatrix::<f64>::zeros(TERMS, 3);
        // Sums of numbers near zero keep more digits.
        let centre = samples.clone().next()?.1;
        let centre = coordinates(&centre);
        let mut count = 0.0;
        for ((u, pose), weight) in samples.clone().zip(&weights) {
            let row = basis(u);
            let values = coordinates(&pose);
            for (i, a) in row.iter().map(|a| weight * a).enumerate() {
                for (j, b) in row.iter().enumerate().take(i + 1) {
                    gram[(i, j)] += a * b;
                }
                for axis in 0..3 {
                    right[(i, axis)] += a * (values[axis] - centre[axis]);
                }
            }
            count += 1.0;
        }
        if count < 2.0 * TERMS as f64 {
            return None;
        }
        // Cholesky reads the lower triangle only.
        let factors = gram.cholesky()?;
        let curve = Self::from_columns(&factors.solve(&right), centre, following(&factors));
        let square =
            |(u, pose): (f64, Pose<f64>)| (curve.at(u).position() - pose.position()).norm_squared();
        let rms = (samples.map(square).sum::<f64>() / count).sqrt();
        rms.is_finite().then_some((curve, rms))
    }

    fn from_columns(solution: &DMatrix<f64>, centre: [f64; 3], following: [f64; TERMS]) -> Self {
        let mut terms = [[0.0; 3]; TERMS];
        for (i, term) in terms.iter_mut().enumerate() {
            for (axis, value) in term.iter_mut().enumerate() {
                *value = solution[(i, axis)] + if i == 0 { centre[axis] } else { 0.0 };
            }
        }
        Self { terms, following }
    }

    /// The least-squares curve that drifts as the means of two cycles do that lie this number of cycles apart.
    ///
    /// Within a cycle drift and the harmonics' sines look much alike, so that noise trades one for the other and bends the
    /// curve at both ends. From one cycle to the next the drift is known far better.
    pub(crate) fn drifting(&self, from: &Self, to: &Self, cycles: f64) -> Self {
        let mut out = self.clone();
        for axis in 0..3 {
            let drift = (to.terms[0][axis] - from.terms[0][axis]) / cycles;
            let excess = self.terms[DRIFT][axis] - drift;
            for (term, following) in out.terms.iter_mut().zip(self.following) {
                term[axis] -= following * excess;
            }
        }
        out
    }

    /// The pose at u.
    pub(crate) fn at(&self, u: f64) -> Pose<f64> {
        let mut sum = [0.0; 3];
        for (value, term) in basis(u).iter().zip(&self.terms) {
            for (sum, coefficient) in sum.iter_mut().zip(term) {
                *sum += value * coefficient;
            }
        }
        Pose::new(sum[0], sum[1], sum[2])
    }

    /// Mean position and heading: mean term, since drift and harmonics average to nothing over a cycle.
    fn mean(&self) -> Pose<f64> {
        let [x, y, theta] = self.terms[0];
        Pose::new(x, y, theta)
    }

    /// The step from this cycle's first pose to the next one's, seen from the first, estimated from all samples of both:
    /// `g(t + T) = D g(t)` with one D for the whole cycle, so that D follows from the means.
    /// `start` is where in the curve the cycle begins, in u.
    pub(crate) fn step_to(&self, next: &Self, start: f64) -> Pose<f64> {
        let (here, there) = (self.mean(), next.mean());
        let rotation = there.theta - here.theta;
        let turn = Pose::new(0.0, 0.0, rotation);
        let start = self.at(start);
        // The first pose's position under D, less itself.
        let moved = there.position() + turn.transform(&(start.position() - here.position()))
            - start.position();
        in_frame(start.theta, moved, rotation)
    }

    /// The step by this cycle's own drift, for want of a next one.
    pub(crate) fn own_step(&self) -> Pose<f64> {
        let [x, y, theta] = self.terms[1];
        in_frame(self.at(0.0).theta, Vector2::new(x, y), theta)
    }

    /// (ΔY, Δθ): half of max − min of the harmonics, y across the first heading. Of harmonics rather than of samples: noise
    /// widens the range of samples, but not, to speak of, theirs. Without the drift: a cycle has its first extreme at its end
    /// again, and the better of both would be better by what noise and the fluid drift.
    pub(crate) fn amplitudes(&self, start: f64) -> (f64, f64) {
        let (sin, cos) = self.at(start).theta.sin_cos();
        let mut harmonics = self.clone();
        harmonics.terms[DRIFT] = [0.0; 3];
        let looks = (0..=LOOKS).map(|i| harmonics.at(start + i as f64 / LOOKS as f64));
        let (y, theta): (Vec<f64>, Vec<f64>) = looks
            .map(|pose| (cos * pose.y - sin * pose.x, pose.theta))
            .unzip();
        (half_range(&y), half_range(&theta))
    }

    /// θ's harmonics as (cosine, sine).
    pub(crate) fn heading_harmonics(&self) -> Harmonics {
        std::array::from_fn(|h| [self.terms[2 + 2 * h][2], self.terms[3 + 2 * h][2]])
    }
}

/// Cosine and sine of each harmonic of θ.
pub(crate) type Harmonics = [[f64; 2]; HARMONICS];

fn in_frame(heading: f64, moved: Vector2<f64>, rotation: f64) -> Pose<f64> {
    let (sin, cos) = heading.sin_cos();
    Pose::new(
        cos * moved.x + sin * moved.y,
        cos * moved.y - sin * moved.x,
        rotation,
    )
}

/// Samples near an end of a measured cycle whose weights differ from 1: more would weigh noise unevenly.
const MEASURED_END: usize = 3;
/// The same of a predicted cycle, whose samples are fewer and have no noise.
const PREDICTED_END: usize = 4;

/// Half of max − min, each refined by a parabola through its neighbours.
fn half_range(values: &[f64]) -> f64 {
    let extreme = |sign: f64| {
        let at = (0..values.len())
            .max_by(|a, b| (sign * values[*a]).total_cmp(&(sign * values[*b])))
            .unwrap_or(0);
        let value = |i: usize| values.get(i).map(|v| sign * v);
        match (at.checked_sub(1).and_then(value), value(at), value(at + 1)) {
            (Some(before), Some(here), Some(after)) => {
                let (slope, bend) = ((after - before) / 2.0, after - 2.0 * here + before);
                sign * if bend < 0.0 {
                    here - slope * slope / (2.0 * bend)
                } else {
                    here
                }
            }
            (_, here, _) => sign * here.unwrap_or(0.0),
        }
    };
    (extreme(1.0) - extreme(-1.0)) / 2.0
}

/// Draws curves through predicted cycles, which are always sampled at the same u, by one matrix.
#[derive(Debug, Clone)]
pub(crate) struct Projection {
    matrix: DMatrix<f64>,
    following: [f64; TERMS],
}

impl Projection {
    pub(crate) fn new() -> Self {
        let rows = DMatrix::from_fn(PREDICTED, TERMS, |i, j| basis(Self::place(i))[j]);
        let places: Vec<f64> = Self::places().collect();
        let weights = weights(&places, 1.0 / PREDICTED as f64, PREDICTED_END);
        let weighted = DMatrix::from_fn(PREDICTED, TERMS, |i, j| {
            rows[(i, j)] * weights.get(i).copied().unwrap_or(1.0)
        });
        let gram = rows.tr_mul(&weighted);
        // The Gram matrix of harmonics on an even grid is as well-conditioned as they come.
        let factors = gram.cholesky();
        Self {
            following: factors.as_ref().map_or([0.0; TERMS], following),
            matrix: factors.map_or_else(
                || DMatrix::zeros(TERMS, PREDICTED),
                |c| c.solve(&weighted.transpose()),
            ),
        }
    }

    /// u of the samples: the middles of equal stretches.
    pub(crate) fn places() -> impl Iterator<Item = f64> {
        (0..PREDICTED).map(Self::place)
    }

    fn place(i: usize) -> f64 {
        (i as f64 + 0.5) / PREDICTED as f64
    }

    /// The curve through poses at [`Projection::places`].
    pub(crate) fn curve(&self, poses: &[Pose<f64>]) -> Curve {
        let values = |axis: usize| {
            DVector::from_iterator(
                PREDICTED,
                poses
                    .iter()
                    .map(|p| coordinates(p)[axis])
                    .chain(std::iter::repeat(0.0))
                    .take(PREDICTED),
            )
        };
        let columns = DMatrix::from_columns(&[0, 1, 2].map(values));
        Curve::from_columns(&(&self.matrix * columns), [0.0; 3], self.following)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(u: f64) -> Pose<f64> {
        let t = TAU * u;
        Pose::new(
            0.02 * u + 0.01 * (2.0 * t).cos(),
            0.005 * t.sin() + 0.001 * (3.0 * t).cos(),
            0.4 * t.sin() + 0.3,
        )
    }

    #[test]
    fn a_curve_of_its_own_kind_is_found_exactly() {
        let samples = (0..700)
            .map(|i| f64::from(i) / 700.0)
            .filter(|u| (u * 37.0).sin() < 0.9)
            .map(|u| (u, wave(u)));
        let (curve, rms) = Curve::fit(samples, 1.0 / 700.0).unwrap();
        assert!(rms < 1e-14);
        for u in [0.0, 0.3, 0.99] {
            assert!((curve.at(u).position() - wave(u).position()).norm() < 1e-13);
        }
        let first = curve.heading_harmonics()[0];
        assert!(first[0].abs() < 1e-12 && (first[1] - 0.4).abs() < 1e-12);
        assert!((curve.amplitudes(0.0).1 - 0.4).abs() < 1e-7);
    }

    #[test]
    fn a_prediction_and_a_measurement_give_the_same_curve() {
        let poses: Vec<_> = Projection::places().map(wave).collect();
        let drawn = Projection::new().curve(&poses);
        for u in [0.0, 0.41, 1.0] {
            assert!((drawn.at(u).position() - wave(u).position()).norm() < 1e-13);
        }
    }

    #[test]
    fn the_step_is_the_rigid_motion_between_cycles() {
        let motion = Pose::new(0.02, -0.003, 0.05);
        let start = Pose::new(0.4, 0.1, 0.7);
        let curve = |by: Pose<f64>| {
            Projection::new().curve(
                &Projection::places()
                    .map(|u| by * start * wave(u))
                    .collect::<Vec<_>>(),
            )
        };
        let (a, b) = (curve(Pose::identity()), curve(motion));
        let first = a.at(0.0);
        let expected = first.inverse() * motion * first;
        let step = a.step_to(&b, 0.0);
        assert!(
            (step.position() - expected.position()).norm() < 1e-9
                && (step.theta - 0.05).abs() < 1e-12,
            "{step:?} {expected:?}"
        );
    }

    #[test]
    fn an_amplitude_is_not_widened_by_drift() {
        // An extreme at the start and at the end.
        for drift in [-0.02, 0.02] {
            let wave = |u: f64| Pose::new(0.0, (TAU * u).cos() + drift * u, 0.0);
            let poses: Vec<_> = Projection::places().map(wave).collect();
            let delta_y = Projection::new().curve(&poses).amplitudes(0.0).0;
            assert!((delta_y - 1.0).abs() < 1e-12, "{delta_y}");
        }
    }

    #[test]
    fn too_few_samples_draw_no_curve() {
        assert!(Curve::fit((0..20).map(|i| (f64::from(i) / 20.0, wave(0.0))), 0.05).is_none());
        assert!(Curve::fit((0..200).map(|_| (0.5, wave(0.5))), 0.005).is_none());
    }
}
