//! Integration of one cycle: displacement, rotation, energy and efficiency of a gait, and the path of the swimmer.
//!
//! Because Φ(u) is given, θ is an integral of a known function and x, y are integrals once θ is known. So the cycle is
//! cut into panels, each with a Gauss–Legendre rule whose polynomials are integrated exactly: no differential equation
//! is stepped, panels end at corners, and the polynomials are the dense output. The pose starts at the origin with
//! θ = 0: **x runs along the middle link's heading at the gait's first point.**

mod crossing;
mod extremes;
mod legendre;
mod panel;

pub use crossing::{CrossingShare, crossing_share};
pub use panel::{Panel, Panels};

use crate::{Gait, Model, Pose, Scalar};
use extremes::Range;
use nalgebra::Vector2;

/// Accuracy of the integration of a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Bound on the estimated error of the dense output on each panel: of positions over L, of headings in radians, both
    /// over the gait's size in radians; of energies over those with the body held fast. Values for the whole cycle are usually
    /// orders of magnitude more accurate. A bound below the rounding of the number type is raised to it.
    pub relative: f64,
}

impl Tolerance {
    /// Creates a tolerance.
    pub const fn new(relative: f64) -> Self {
        Self { relative }
    }
}

impl Default for Tolerance {
    /// 1e-12, close to the rounding of `f64`; for `f32` its own rounding applies.
    fn default() -> Self {
        Self::new(1e-12)
    }
}

/// Result of one cycle of a gait.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke<T> {
    /// Net displacement (X, Y) \[m\] over one cycle; X along the middle link's heading at the gait's first point.
    pub displacement: Vector2<T>,
    /// Net rotation \[rad\] over one cycle.
    pub rotation: T,
    /// ΔY \[m\]: half of max − min of y over the cycle.
    pub delta_y: T,
    /// Δθ \[rad\]: half of max − min of θ over the cycle.
    pub delta_theta: T,
    /// ∫₀¹ P du over μ \[m³\], P = Φ′ᵀWΦ′: energy of a cycle of period 1 as parametrised.
    pub energy: T,
    /// ∫₀¹ √P du over √μ. Its square is the energy of a cycle of period 1 at constant power, the least for this curve.
    pub power_length: T,
    /// Length L of the swimmer \[m\].
    pub total_length: T,
    /// c_t/μ of its side links.
    pub side_drag: T,
}

impl<T: Scalar> Stroke<T> {
    /// Lighthill's efficiency ξ = c_t L V̄² / P̄ as parametrised (paper, definition of ξ), with V̄ = |net displacement|
    /// per period. Zero for a gait without energy.
    pub fn efficiency(&self) -> T {
        self.lighthill(self.energy)
    }

    /// ξ of the same curve at constant power, the greatest of all time parametrisations.
    pub fn efficiency_constant_power(&self) -> T {
        self.lighthill(self.power_length * self.power_length)
    }

    /// (X, Y) / L.
    pub fn displacement_over_length(&self) -> Vector2<T> {
        self.displacement / self.total_length
    }

    fn lighthill(&self, energy: T) -> T {
        if energy > T::zero() {
            self.side_drag * self.total_length * self.displacement.dot(&self.displacement) / energy
        } else {
            T::zero()
        }
    }
}

/// Integrates one cycle.
pub fn swim<T: Scalar, G: Gait<T> + ?Sized>(
    model: &Model<T>,
    gait: &G,
    tolerance: &Tolerance,
) -> Stroke<T> {
    let (mut y, mut theta) = (Range::of(T::zero()), Range::of(T::zero()));
    let (mut energy, mut power_length) = (T::zero(), T::zero());
    let mut pose = Pose::identity();
    for panel in Panels::new(model, gait, tolerance) {
        panel.extend_ranges(&mut y, &mut theta);
        energy += panel.energy();
        power_length += panel.power_length();
        pose = panel.end_pose();
    }
    Stroke {
        displacement: pose.position(),
        rotation: pose.theta,
        delta_y: y.half_width(),
        delta_theta: theta.half_width(),
        energy,
        power_length,
        total_length: model.swimmer().total_length(),
        side_drag: model.side_drag(),
    }
}

/// State of the swimmer at one time of a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectoryPoint<T> {
    /// Fraction of the cycle, 0 to 1.
    pub u: T,
    /// Joint angles \[rad\].
    pub phi: Vector2<T>,
    /// Pose of the middle link.
    pub pose: Pose<T>,
    /// ∫₀ᵘ P du over μ.
    pub energy: T,
}

/// Integrates one cycle and passes `intervals + 1` states, evenly spaced in u with both ends, to `visit`.
///
/// ```
/// use swimmer_model::{Circle, Model, Swimmer, Tolerance, swim, trajectory};
///
/// let model = Model::new(&Swimmer::<f64>::robot())?;
/// let circle = Circle { amplitude: 1.2 };
/// let mut x = Vec::new();
/// trajectory(&model, &circle, &Tolerance::default(), 100, |point| x.push(point.pose.x));
/// let swum = swim(&model, &circle, &Tolerance::default());
/// assert!((x[100] - swum.displacement.x).abs() < 1e-12);
/// # Ok::<(), swimmer_model::InvalidSwimmer>(())
/// ```
pub fn trajectory<T: Scalar, G: Gait<T> + ?Sized>(
    model: &Model<T>,
    gait: &G,
    tolerance: &Tolerance,
    intervals: usize,
    mut visit: impl FnMut(TrajectoryPoint<T>),
) {
    let place = |i: usize| T::from_f64(i as f64 / intervals.max(1) as f64);
    let (mut next, mut spent) = (0, T::zero());
    for panel in Panels::new(model, gait, tolerance) {
        while next <= intervals && place(next) <= panel.end() {
            let u = place(next);
            visit(TrajectoryPoint {
                u,
                phi: gait.at(u).phi,
                pose: panel.pose(u),
                energy: spent + panel.energy_until(u),
            });
            next += 1;
        }
        spent += panel.energy();
    }
}
