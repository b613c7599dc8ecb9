//! Panels: intervals of a cycle on which the rates are polynomials, and the adaptive subdivision into them.

use super::Tolerance;
use super::extremes::Range;
use super::legendre::{N, Rule, Series};
use crate::{Gait, Model, Pose, Scalar};
use nalgebra::Vector3;

/// Interval of an integrated cycle with its dense output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panel<T> {
    start: T,
    half_width: T,
    pose: Pose<T>,
    /// dx/du, dy/du, dθ/du in the world's frame.
    rates: [Series<T>; 3],
    power: Series<T>,
    root_power: Series<T>,
}

impl<T: Scalar> Panel<T> {
    /// Integrates an interval with the rule of M nodes.
    fn new<const M: usize, G: Gait<T> + ?Sized>(
        model: &Model<T>,
        gait: &G,
        start: T,
        width: T,
        pose: Pose<T>,
    ) -> Self {
        let half_width = width * T::from_f64(0.5);
        let mut body = [Vector3::zeros(); M];
        let (mut turning, mut power) = ([T::zero(); M], [T::zero(); M]);
        for j in 0..M {
            let point = gait.at(start + half_width * T::from_f64(1.0 + Rule::<M>::NODES[j]));
            let (a, w) = model.connection_and_power(&point.phi);
            let rate = point.rate;
            body[j] = a * rate;
            turning[j] = body[j].z;
            // Not negative by physics; clamped so that rounding near a standstill does not make its root NaN.
            power[j] = (w.m11 * rate.x * rate.x
                + (w.m12 + w.m21) * rate.x * rate.y
                + w.m22 * rate.y * rate.y)
                .max(T::zero());
        }
        let turning = Series::through(&turning);
        let turned: [T; M] = turning.integrals_at_nodes();
        let (mut x, mut y) = ([T::zero(); M], [T::zero(); M]);
        for j in 0..M {
            let (sin, cos) = (pose.theta + half_width * turned[j]).sin_cos();
            x[j] = cos * body[j].x - sin * body[j].y;
            y[j] = sin * body[j].x + cos * body[j].y;
        }
        Self {
            start,
            half_width,
            pose,
            rates: [Series::through(&x), Series::through(&y), turning],
            power: Series::through(&power),
            root_power: Series::through(&power.map(T::sqrt)),
        }
    }

    /// Start of the panel.
    pub fn start(&self) -> T {
        self.start
    }

    /// End of the panel.
    pub fn end(&self) -> T {
        self.start + self.half_width + self.half_width
    }

    /// Pose at the start of the panel.
    pub fn start_pose(&self) -> Pose<T> {
        self.pose
    }

    /// Pose at the end of the panel.
    pub fn end_pose(&self) -> Pose<T> {
        self.moved(self.rates.map(|r| r.whole_integral()))
    }

    /// Pose at u within the panel.
    pub fn pose(&self, u: T) -> Pose<T> {
        let s = self.local(u);
        self.moved(self.rates.map(|r| r.integral(s)))
    }

    /// (dx/du, dy/du, dθ/du) at u within the panel, in the frame of the gait's first point.
    pub fn rate(&self, u: T) -> Vector3<T> {
        let s = self.local(u);
        Vector3::from(self.rates.map(|r| r.value(s)))
    }

    /// ∫P du over the panel, over μ.
    pub fn energy(&self) -> T {
        self.half_width * self.power.whole_integral()
    }

    /// ∫P du from the panel's beginning to u, over μ.
    pub fn energy_until(&self, u: T) -> T {
        self.half_width * self.power.integral(self.local(u))
    }

    /// ∫√P du over the panel.
    pub fn power_length(&self) -> T {
        self.half_width * self.root_power.whole_integral()
    }

    /// ∫√P du from the panel's beginning to u: proportional to time at constant power.
    pub fn power_length_until(&self, u: T) -> T {
        self.half_width * self.root_power.integral(self.local(u))
    }

    /// Extends the ranges of y and θ by those of this panel.
    pub(super) fn extend_ranges(&self, y: &mut Range<T>, theta: &mut Range<T>) {
        y.extend(self.pose.y, self.half_width, &self.rates[1]);
        theta.extend(self.pose.theta, self.half_width, &self.rates[2]);
    }

    fn moved(&self, integrals: [T; 3]) -> Pose<T> {
        let [x, y, theta] = integrals.map(|i| i * self.half_width);
        Pose::new(self.pose.x + x, self.pose.y + y, self.pose.theta + theta)
    }

    /// Maps u to s in [−1, 1].
    fn local(&self, u: T) -> T {
        let one = T::one();
        let s = if self.half_width > T::zero() {
            (u - self.start) / self.half_width - one
        } else {
            -one
        };
        s.max(-one).min(one)
    }

    /// Error estimate of the dense output relative to the tolerance, for a panel with M nodes; at most 1 is accepted.
    ///
    /// The truncation error of a rate is about as large as its last coefficients; that of its integral is M times smaller.
    fn excess<const M: usize>(&self, scale: &Scale<T>) -> T {
        let [x, y, theta] = self.rates.map(|r| r.tail::<M>());
        let motion = (x.max(y) / scale.length).max(theta) / scale.size;
        let energy = self.power.tail::<M>() / scale.power;
        // If a gait almost stands still, √P almost has a kink, and its integral is no more accurate.
        let power_length = self.root_power.tail::<M>() / scale.power.sqrt();
        let integral = (motion.max(energy) / T::from_f64(M as f64)).max(power_length);
        integral * self.half_width / scale.tolerance
    }
}

/// Scales of the error estimate for this swimmer and gait.
#[derive(Clone, Copy, Debug)]
struct Scale<T> {
    /// L.
    length: T,
    /// Size of the gait in the plane of joint angles.
    size: T,
    /// Mean power of the gait with the body held fast.
    power: T,
    tolerance: T,
}

/// Iterator over the panels of one cycle. Every smooth piece of the gait is bisected until each part is resolved to the
/// tolerance.
///
/// The work is bounded: a curve that would need too many panels (noise, for example) is integrated coarsely.
///
/// ```
/// use swimmer_model::{Circle, Model, Panels, Swimmer, Tolerance};
///
/// let model = Model::new(&Swimmer::<f64>::purcell())?;
/// let circle = Circle { amplitude: 1.0 };
/// let ends: Vec<f64> = Panels::new(&model, &circle, &Tolerance::default()).map(|panel| panel.end()).collect();
/// assert_eq!(ends.last(), Some(&1.0));
/// # Ok::<(), swimmer_model::InvalidSwimmer>(())
/// ```
#[derive(Debug)]
pub struct Panels<'a, T, G: ?Sized> {
    model: &'a Model<T>,
    gait: &'a G,
    scale: Scale<T>,
    pose: Pose<T>,
    /// Index of the next piece.
    next_piece: usize,
    /// Start and end of this piece.
    piece: (T, T),
    /// The next panel is part `index` of 2^`level` equal parts of the piece.
    level: u32,
    index: u32,
    /// Remaining number of bisections.
    halvings: u32,
}

/// Number of samples for the estimate of the gait's largest rate.
const RATE_SAMPLES: usize = 32;

/// Number of nodes per panel if the pieces are narrow.
const FEW: usize = 8;

/// Number of pieces from which they count as narrow, as for sampled gaits.
const NARROW_PIECES: usize = 64;

/// Greatest width of a panel, so that no symmetry of a gait can defeat the error estimate.
const WIDEST: f64 = 0.25;

/// Least width of a panel; an undeclared kink is integrated at this width.
const NARROWEST: f64 = 1.0 / 1_048_576.0;

/// Number of bisections per cycle; a smooth gait needs some tens, an undeclared corner twenty.
const HALVINGS: u32 = 5000;

/// Level from which a wider panel is tried after every pair; below it, only if the error estimate promises success.
const DEEP: u32 = 8;

impl<'a, T: Scalar, G: Gait<T> + ?Sized> Panels<'a, T, G> {
    /// Starts at the gait's first point, at the origin with θ = 0.
    pub fn new(model: &'a Model<T>, gait: &'a G, tolerance: &Tolerance) -> Self {
        let sample = |i: usize| {
            gait.at(T::from_f64((i as f64 + 0.5) / RATE_SAMPLES as f64))
                .speed()
        };
        let rate = (0..RATE_SAMPLES).map(sample).fold(T::zero(), T::max);
        let rate = if rate > T::zero() { rate } else { T::one() };
        // Rounding of u changes the shape by the rate times ε.
        let rounding = T::from_f64(2.0) * T::EPSILON * (T::from_f64(4.0) + rate);
        let scale = Scale {
            length: model.swimmer().total_length(),
            size: rate / T::from_f64(core::f64::consts::TAU),
            power: model.power_bound() * rate * rate,
            tolerance: T::from_f64(tolerance.relative).max(rounding),
        };
        let (pose, piece) = (Pose::identity(), (T::zero(), T::zero()));
        Self {
            model,
            gait,
            scale,
            pose,
            next_piece: 0,
            piece,
            level: 0,
            index: 1,
            halvings: HALVINGS,
        }
    }

    /// Enters the next piece of the gait. Returns `None` at the end of the cycle.
    fn enter_next_piece(&mut self) -> Option<()> {
        let pieces = self.gait.pieces().max(1);
        let start = self.piece.1;
        while self.next_piece < pieces {
            self.next_piece += 1;
            let last = self.next_piece == pieces;
            let end = if last {
                T::one()
            } else {
                self.gait.piece_end(self.next_piece - 1).min(T::one())
            };
            if end > start {
                (self.piece, self.level, self.index) = ((start, end), 0, 0);
                while self.part(1) - start > T::from_f64(WIDEST) {
                    self.level += 1;
                }
                return Some(());
            }
        }
        None
    }

    /// Integrates a panel with its excess, with fewer nodes if these suffice.
    fn panel(&self, start: T, width: T) -> (Panel<T>, T) {
        if self.gait.pieces() >= NARROW_PIECES {
            let few = Panel::new::<FEW, G>(self.model, self.gait, start, width, self.pose);
            let excess = few.excess::<FEW>(&self.scale);
            if excess <= T::one() {
                return (few, excess);
            }
        }
        let panel = Panel::new::<N, G>(self.model, self.gait, start, width, self.pose);
        let excess = panel.excess::<N>(&self.scale);
        (panel, excess)
    }

    /// Start of part `index` of the piece.
    fn part(&self, index: u32) -> T {
        let (start, end) = self.piece;
        let parts = 1_u32 << self.level;
        if index == parts {
            end
        } else {
            start + (end - start) * T::from_f64(f64::from(index) / f64::from(parts))
        }
    }
}

impl<T: Scalar, G: Gait<T> + ?Sized> Iterator for Panels<'_, T, G> {
    type Item = Panel<T>;

    fn next(&mut self) -> Option<Panel<T>> {
        if self.index >> self.level > 0 {
            self.enter_next_piece()?;
        }
        let narrowest = T::from_f64(NARROWEST).max(T::from_f64(1024.0) * T::EPSILON);
        loop {
            let start = self.part(self.index);
            let width = self.part(self.index + 1) - start;
            let (panel, excess) = self.panel(start, width);
            if excess > T::one() && width > narrowest && self.halvings > 0 {
                (self.level, self.index) = (self.level + 1, 2 * self.index);
                self.halvings -= 1;
                continue;
            }
            self.pose = panel.end_pose();
            self.index += 1;
            // Twice the width multiplies the last coefficients by about 2¹¹.
            let promising = excess < T::from_f64(1e-3) || self.level > DEEP || self.halvings == 0;
            if promising
                && self.index.is_multiple_of(2)
                && width < T::from_f64(WIDEST / 2.0 * 1.01)
                && self.level > 0
            {
                (self.level, self.index) = (self.level - 1, self.index / 2);
            }
            return Some(panel);
        }
    }
}
