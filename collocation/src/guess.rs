//! Where the iteration starts: a quarter gait at constant power, from any curve.

use nalgebra::Vector2;
use swimmer_model::{Circle, Gait, Model, SymmetricFourier};

use super::CollocationError;
use super::mesh::Mesh;
use super::walls::Wall;

/// A quarter gait to start from: samples of time and joint angles. The times are only an order; the gait is timed anew at
/// constant power.
#[derive(Debug, Clone, PartialEq)]
pub struct QuarterGuess {
    samples: Vec<(f64, Vector2<f64>)>,
}

/// Samples of a quarter that is given as a function.
const SAMPLES: usize = 512;
/// Share of the room inside the walls that a guess is shrunk to.
const INSIDE: f64 = 0.98;
/// How far inside the walls a sample is clipped, in rad, or over L between links.
const CLIPPED: f64 = 0.01;
const OUTSIDE: &str = "it does not fit inside the bounds";

/// How a guess is brought inside the walls.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fit {
    /// All of it smaller.
    Shrunk,
    /// Only what is outside moved in.
    Clipped,
}

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
        let times = samples.iter().map(|&(t, _)| t);
        let mut shapes: Vec<_> = samples.iter().map(|&(_, phi)| phi.into()).collect();
        on_symmetry_lines(&mut shapes);
        if shapes.windows(2).all(|pair| pair[1] == pair[0]) {
            return refuse("it does not move");
        }
        let samples = times.zip(shapes).collect();
        Ok(Self { samples })
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

    /// A circle of this amplitude \[rad\].
    ///
    /// # Errors
    /// As [`Self::from_samples`].
    pub fn circle(amplitude: f64) -> Result<Self, CollocationError> {
        Self::from_gait(&Circle { amplitude })
    }

    /// The paper's symmetric Fourier gait (Appendix C), pairs \[Aₙ, Bₙ\] \[rad\].
    ///
    /// # Errors
    /// As [`Self::from_samples`].
    pub fn fourier(coefficients: &[[f64; 2]]) -> Result<Self, CollocationError> {
        Self::from_gait(&SymmetricFourier { coefficients })
    }

    /// The shapes at the points of a mesh, timed at constant power and brought inside the walls.
    pub(crate) fn on(
        &self,
        model: &Model<f64>,
        mesh: &Mesh,
        walls: &[Wall],
        fit: Fit,
    ) -> Result<Vec<Vector2<f64>>, CollocationError> {
        let scaled = match fit {
            Fit::Shrunk => {
                let size = self.shrunk(walls)?;
                self.samples.iter().map(|(_, phi)| phi * size).collect()
            }
            Fit::Clipped => self.clipped(walls)?,
        };
        let mut times = vec![0.0];
        for pair in scaled.windows(2) {
            let step = pair[1] - pair[0];
            let power = model.power_matrix(&((pair[0] + pair[1]) * 0.5));
            let before = times.last().copied().unwrap_or(0.0);
            times.push(before + step.dot(&(power * step)).max(0.0).sqrt());
        }
        let total = times.last().copied().unwrap_or(0.0);
        if !(total > 0.0 && total.is_finite()) {
            return Err(CollocationError::Guess {
                problem: "it spends no power",
            });
        }
        for time in &mut times {
            *time /= total;
        }
        let shapes: Vec<_> = mesh
            .times
            .iter()
            .map(|&t| interpolated(&times, &scaled, t))
            .collect();
        // Between samples at a corner of the walls a cubic may stray outside.
        if shapes
            .iter()
            .all(|phi| walls.iter().all(|wall| wall.value(phi) > 0.0))
        {
            Ok(shapes)
        } else {
            Err(CollocationError::Guess { problem: OUTSIDE })
        }
    }

    /// Each sample by itself, moved inside the walls.
    fn clipped(&self, walls: &[Wall]) -> Result<Vec<Vector2<f64>>, CollocationError> {
        let mut samples: Vec<_> = self.samples.iter().map(|(_, phi)| *phi).collect();
        for _ in 0..4 {
            for phi in &mut samples {
                for wall in walls {
                    if wall.value(phi) < 0.5 * CLIPPED {
                        wall.draw(phi, CLIPPED);
                    }
                }
            }
            on_symmetry_lines(&mut samples);
        }
        let inside = samples
            .iter()
            .all(|phi| walls.iter().all(|wall| wall.value(phi) > 0.0));
        inside
            .then_some(samples)
            .ok_or(CollocationError::Guess { problem: OUTSIDE })
    }

    /// Whether it needs no change to fit.
    pub(crate) fn lies_inside(&self, walls: &[Wall]) -> bool {
        self.inside(walls, 1.0 / INSIDE)
    }

    fn inside(&self, walls: &[Wall], size: f64) -> bool {
        self.samples
            .iter()
            .all(|(_, phi)| walls.iter().all(|wall| wall.value(&(phi * size)) > 0.0))
    }

    /// The factor that brings all samples inside the walls: 1 where they are.
    fn shrunk(&self, walls: &[Wall]) -> Result<f64, CollocationError> {
        if self.lies_inside(walls) {
            return Ok(1.0);
        }
        let (mut low, mut high) = (0.0, 1.0 / INSIDE);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if self.inside(walls, middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        if low > 0.0 {
            Ok(INSIDE * low)
        } else {
            Err(CollocationError::Guess { problem: OUTSIDE })
        }
    }
}

/// Moves the first shape to φ₁ = φ₂ and the last to φ₁ = −φ₂.
fn on_symmetry_lines(shapes: &mut [Vector2<f64>]) {
    if let Some(first) = shapes.first_mut() {
        first.fill(0.5 * (first.x + first.y));
    }
    if let Some(last) = shapes.last_mut() {
        let half = 0.5 * (last.y - last.x);
        *last = Vector2::new(-half, half);
    }
}

/// Cubic interpolation with the slopes of the parabolas through neighbours.
fn interpolated(times: &[f64], values: &[Vector2<f64>], t: f64) -> Vector2<f64> {
    let last = times.len() - 1;
    let after = times.partition_point(|&time| time <= t).clamp(1, last);
    let before = after - 1;
    let width = times[after] - times[before];
    if width <= 0.0 {
        return values[before];
    }
    let chord = |i: usize| {
        let width = times[i + 1] - times[i];
        if width > 0.0 {
            (values[i + 1] - values[i]) / width
        } else {
            Vector2::zeros()
        }
    };
    let slope = |i: usize| {
        if i == 0 || i == last {
            return chord(i.min(last - 1));
        }
        let (left, right) = (times[i] - times[i - 1], times[i + 1] - times[i]);
        (chord(i - 1) * right + chord(i) * left) / (left + right).max(f64::MIN_POSITIVE)
    };
    let s = (t - times[before]) / width;
    let (a, b) = (values[before], values[after]);
    let (da, db) = (slope(before) * width, slope(after) * width);
    let r = 1.0 - s;
    a * (r * r * (1.0 + 2.0 * s)) + b * (s * s * (1.0 + 2.0 * r)) + da * (r * r * s)
        - db * (s * s * r)
}
