//! Where the iteration starts: a quarter gait at constant power, from any curve.

use gait_optimizer::region::Bound;
use nalgebra::{Matrix2xX, Vector2};
use swimmer_model::{Circle, Gait, Model};

use super::CollocationError;
use super::mesh::Mesh;

/// A quarter gait to start from: joint angles in order of time. The gait is timed anew at constant power.
#[derive(Debug, Clone, PartialEq)]
pub struct QuarterGuess {
    shapes: Matrix2xX<f64>,
}

/// Samples of a quarter that is given as a function.
const SAMPLES: usize = 512;
/// Share of the room inside the bounds that a guess is shrunk to.
const INSIDE: f64 = 0.98;

impl QuarterGuess {
    /// From samples (t, (φ₁, φ₂)) in order of t, the first near φ₁ = φ₂ > 0 and the last near φ₁ = −φ₂, φ₂ > 0; these two
    /// are moved on to these lines.
    ///
    /// # Errors
    /// [`CollocationError::Guess`]: fewer than three samples, times that do not grow, or values that are not finite.
    pub fn from_samples(samples: &[(f64, [f64; 2])]) -> Result<Self, CollocationError> {
        let refuse = |problem| Err(CollocationError::Guess { problem });
        if samples.len() < 3 {
            return refuse("it has fewer than three samples");
        }
        if samples.iter().any(|(t, phi)| {
            !t.is_finite()
                || phi
                    .iter()
                    .any(|angle| !angle.is_finite() || angle.abs() >= 1e3)
        }) {
            return refuse("a sample is not finite, or an angle beyond 1000 rad");
        }
        if samples.windows(2).any(|pair| pair[1].0 <= pair[0].0) {
            return refuse("its times do not grow");
        }
        let shapes: Vec<_> = samples.iter().map(|&(_, phi)| Vector2::from(phi)).collect();
        let mut shapes = Matrix2xX::from_columns(&shapes);
        bind_ends(&mut shapes);
        if shapes.column_iter().all(|phi| phi == shapes.column(0)) {
            return refuse("it does not move");
        }
        Ok(Self { shapes })
    }

    /// The first quarter of a gait that starts on φ₁ = φ₂ > 0 and runs counter-clockwise.
    ///
    /// # Errors
    /// As [`Self::from_samples`].
    pub fn from_gait<G: Gait<f64>>(gait: &G) -> Result<Self, CollocationError> {
        let samples: Vec<_> = (0..=SAMPLES)
            .map(|i| {
                let t = i as f64 / SAMPLES as f64;
                let phi = gait.at(0.25 * t).phi;
                (t, [phi.x, phi.y])
            })
            .collect();
        Self::from_samples(&samples)
    }

    /// From shapes that begin and end on the symmetry lines already.
    pub(crate) fn of(shapes: Matrix2xX<f64>) -> Self {
        Self { shapes }
    }

    /// A circle of this amplitude \[rad\].
    ///
    /// # Errors
    /// As [`Self::from_samples`].
    pub fn circle(amplitude: f64) -> Result<Self, CollocationError> {
        Self::from_gait(&Circle { amplitude })
    }

    /// The shapes at the points of a mesh, timed at constant power and brought inside the bounds.
    pub(crate) fn on(
        &self,
        model: &Model<f64>,
        mesh: &Mesh,
        walls: &[Bound],
    ) -> Result<Matrix2xX<f64>, CollocationError> {
        let shapes = if is_inside(walls, &(&self.shapes / INSIDE)) {
            self.shapes.clone()
        } else {
            self.shrunk(walls)
        };
        let mut times = vec![0.0];
        let mut total = 0.0;
        for i in 1..shapes.ncols() {
            let step = shapes.column(i) - shapes.column(i - 1);
            let power = model.power_matrix(&((shapes.column(i) + shapes.column(i - 1)) * 0.5));
            total += step.dot(&(power * step)).max(0.0).sqrt();
            times.push(total);
        }
        let refuse = |problem| Err(CollocationError::Guess { problem });
        if !(total > 0.0 && total.is_finite()) {
            return refuse("it spends no power");
        }
        let last = times.len() - 1;
        let mut on_mesh = Matrix2xX::zeros(mesh.len());
        for (mut phi, t) in on_mesh.column_iter_mut().zip(&mesh.times) {
            let after = times
                .partition_point(|time| *time <= t * total)
                .clamp(1, last);
            let share = (t * total - times[after - 1])
                / (times[after] - times[after - 1]).max(f64::MIN_POSITIVE);
            phi.copy_from(
                &shapes
                    .column(after - 1)
                    .lerp(&shapes.column(after), share.clamp(0.0, 1.0)),
            );
        }
        if is_inside(walls, &on_mesh) {
            Ok(on_mesh)
        } else {
            refuse("it does not fit inside the bounds")
        }
    }

    /// Brought inside the bounds as a whole.
    fn shrunk(&self, walls: &[Bound]) -> Matrix2xX<f64> {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if is_inside(walls, &(&self.shapes * middle)) {
                low = middle;
            } else {
                high = middle;
            }
        }
        &self.shapes * (INSIDE * low)
    }
}

fn is_inside(walls: &[Bound], shapes: &Matrix2xX<f64>) -> bool {
    shapes.column_iter().all(|phi| {
        walls
            .iter()
            .all(|wall| wall.smooth_level(&phi.into_owned()).value > 0.0)
    })
}

/// Moves the first shape to φ₁ = φ₂ and the last to φ₁ = −φ₂.
pub(crate) fn bind_ends(shapes: &mut Matrix2xX<f64>) {
    let last = shapes.ncols() - 1;
    let (first, end) = (shapes.column(0).mean(), shapes.column(last));
    let half = 0.5 * (end.y - end.x);
    shapes.set_column(0, &Vector2::new(first, first));
    shapes.set_column(last, &Vector2::new(-half, half));
}
