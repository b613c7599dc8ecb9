//! From a rough closed curve to the best polygon near it: a primal–dual interior-point method over corners and times.
//!
//! Minimises ln T − ln |d| with no net rotation, each side's rates and each corner within the bounds. Sides are free to point
//! anywhere, so this needs no guess of the arcs; they follow from the active limits.

mod limits;

use limits::Inequality;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Vector2};

use super::arc::{Jet, Shape};
use super::chain::{self, Layout};
use super::quadrature::Rule;
use super::setting::Setting;
use crate::numerics::damped;

/// A polygon and what pushes against it.
#[derive(Debug, Clone)]
pub(crate) struct Polygon {
    pub(crate) layout: Layout,
    pub(crate) z: DVector<f64>,
    /// Per side: multipliers of φ̇₁ ≤ ω₁, φ̇₁ ≥ −ω₁, then of φ̇₂.
    pub(crate) pushes: Vec<[f64; 4]>,
    pub(crate) speed: f64,
}

impl Polygon {
    pub(crate) fn period(&self) -> f64 {
        self.layout.period(&self.z)
    }
}

/// First barrier parameter, last one of a rough polygon, and last one of the best polygon.
const FIRST_BARRIER: f64 = 1e-2;
const ROUGH_BARRIER: f64 = 1e-4;
const LAST_BARRIER: f64 = 1e-8;
const MOST_STEPS: usize = 150;
/// Least time of a side of the best polygon at first, over the shortest.
const SLACK: f64 = 1.001;
/// No farther than this share of the way to any limit.
const SHARE: f64 = 0.995;
/// Quadrature points on a side.
const POINTS: usize = 6;

/// Approximation of the best polygon near a start whose corners lie strictly within the bounds. Returns `None` if the method
/// stalls or the gait does not swim.
pub(crate) fn rough_polygon(setting: &Setting, start: &[Vector2<f64>]) -> Option<Polygon> {
    let least = 1e-3 * setting.region.scale();
    let time = |_, [from, to]: [Vector2<f64>; 2]| 1.3 * setting.time(&(to - from)) + least;
    let (layout, z) = Layout::of_corners(start, Shape::Straight, time);
    Method::new(setting, layout).solve(z, [FIRST_BARRIER, ROUGH_BARRIER])
}

/// The best polygon with `times` as many sides near a rough one.
pub(crate) fn best_polygon(setting: &Setting, rough: &Polygon, times: usize) -> Option<Polygon> {
    let n = times * rough.layout.arcs();
    let part = 1.0 / times as f64;
    let corner = |k: usize| {
        let [from, to] = rough.layout.ends(&rough.z, k / times);
        from + (to - from) * ((k % times) as f64 * part)
    };
    // A side may overstep a bound that is not convex.
    let corners: Vec<Vector2<f64>> = (0..n)
        .map(|k| drawn_in(setting, corner(k), k % times > 0))
        .collect();
    let (layout, z) = Layout::of_corners(&corners, Shape::Straight, |side, [from, to]| {
        let time = part * rough.z[rough.layout.time_index(side / times)];
        time.max(SLACK * setting.time(&(to - from)))
    });
    Method::new(setting, layout).solve(z, [ROUGH_BARRIER, LAST_BARRIER])
}

/// A corner, drawn towards the straight shape until it lies within the bounds if it is new.
fn drawn_in(setting: &Setting, mut corner: Vector2<f64>, is_new: bool) -> Vector2<f64> {
    /// Distance from a bound, over the scale of the shapes.
    const MARGIN: f64 = 1e-4;
    /// Share of its angles that a step keeps.
    const KEPT: f64 = 0.998;
    let margin = MARGIN * setting.region.scale();
    for _ in 0..200 {
        if !is_new || setting.region.overstepped(&corner) < -margin {
            break;
        }
        corner *= KEPT;
    }
    corner
}

struct Method<'a> {
    setting: &'a Setting<'a>,
    rule: Rule,
    layout: Layout,
}

/// State of the iteration.
struct Iterate {
    z: DVector<f64>,
    /// Multipliers of the equalities.
    y: DVector<f64>,
    /// Multipliers of the inequalities.
    pushes: Vec<f64>,
    barrier: f64,
    /// Added to the second derivatives until they are convex.
    damping: f64,
    /// Price of the equalities in the line search.
    penalty: f64,
    merit: Merit,
}

/// Terms of the merit function of the line search, which adds them with the barrier parameter and the penalty.
struct Merit {
    /// ln T − ln |d|.
    objective: f64,
    /// Sum of the logarithms of the margins.
    logs: f64,
    /// Sum of the magnitudes of the equalities' residuals.
    missed: f64,
}

impl Merit {
    fn value(&self, barrier: f64, penalty: f64) -> f64 {
        self.objective - barrier * self.logs + penalty * self.missed
    }
}

/// All that is worked out at one iterate.
struct Evaluation {
    jets: Vec<Jet>,
    net: chain::Net,
    inequalities: Vec<Inequality>,
    /// Residuals of the equalities, and their slopes.
    values: Vec<f64>,
    slopes: Vec<DVector<f64>>,
    /// Gradient of the Lagrangian without the inequalities.
    gradient: DVector<f64>,
}

/// A step in all unknowns.
struct Direction {
    z: DVector<f64>,
    y: DVector<f64>,
    pushes: Vec<f64>,
    /// Shares of it that stay inside.
    longest: f64,
    dual_longest: f64,
}

impl<'a> Method<'a> {
    fn new(setting: &'a Setting<'a>, layout: Layout) -> Self {
        Self {
            setting,
            rule: Rule::new(POINTS),
            layout,
        }
    }

    fn margins(&self, z: &DVector<f64>) -> impl Iterator<Item = f64> {
        limits::margins(self.setting, &self.layout, z)
    }

    /// Scale of the second derivatives of the objective, a logarithm, over angles.
    fn curvature(&self) -> f64 {
        self.setting.region.scale().powi(-2)
    }

    /// Distance of the first corner from the shape at which gaits join.
    fn anchored(&self, z: &DVector<f64>) -> Option<[f64; 2]> {
        let off = self.layout.corner(z, 0) - self.setting.asked.anchor?;
        Some([off.x, off.y])
    }

    /// Returns `None` if a margin is not positive.
    fn merit(&self, z: &DVector<f64>) -> Option<Merit> {
        let mut logs = 0.0;
        for margin in self.margins(z) {
            if margin.is_nan() || margin <= 0.0 {
                return None;
            }
            logs += margin.ln();
        }
        let (_, net) = self.layout.net(self.setting.model, &self.rule, z);
        let period = self.layout.period(z);
        let off = self.setting.residuals(&net, period);
        let anchored = self.anchored(z).into_iter().flatten();
        Some(Merit {
            objective: period.ln() - self.setting.measure(&net).ln(),
            logs,
            missed: off.into_iter().chain(anchored).map(f64::abs).sum(),
        })
    }

    fn solve(self, z: DVector<f64>, [first, last]: [f64; 2]) -> Option<Polygon> {
        let merit = self.merit(&z)?;
        let pushes = self.margins(&z).map(|margin| first / margin);
        let anchored = if self.setting.asked.anchor.is_some() {
            2
        } else {
            0
        };
        let mut here = Iterate {
            pushes: pushes.collect(),
            y: DVector::zeros(self.setting.equality_count() + anchored),
            z,
            barrier: first,
            damping: 0.0,
            penalty: 1.0,
            merit,
        };
        for _ in 0..MOST_STEPS {
            let evaluate = self.evaluate(&here)?;
            if evaluate.error(&here, self.setting.region.scale()) < 10.0 * here.barrier {
                if here.barrier <= last {
                    return Some(self.finish(&here, evaluate.net));
                }
                here.barrier = (0.2 * here.barrier).min(here.barrier.powf(1.5)).max(last);
            }
            let direction = self.direction(&mut here, &evaluate)?;
            if !self.move_along(&mut here, &direction) {
                if here.barrier < 1e-6 {
                    return Some(self.finish(&here, evaluate.net));
                }
                let curvature = self.curvature();
                here.damping = (10.0 * here.damping).max(1e-2 * curvature);
                if here.damping > 1e6 * curvature {
                    return None;
                }
            }
        }
        // Corners may slide along a straight way or a smooth curve, which costs steps and changes nothing.
        let evaluate = self.evaluate(&here)?;
        (here.barrier < 1e-5).then(|| self.finish(&here, evaluate.net))
    }

    fn evaluate(&self, here: &Iterate) -> Option<Evaluation> {
        let Iterate { z, y, .. } = here;
        let layout = &self.layout;
        let jets = layout.jets(self.setting.model, &self.rule, z);
        let (net, mut values, mut slopes) = self.setting.equalities(layout, &jets, z);
        let measure = self.setting.measure(&net);
        if measure.is_nan() || measure < self.setting.least_measure() {
            return None;
        }
        let weights = self.setting.weights(&net, Some(y.as_slice()));
        let (_, mut gradient) = chain::gradient(layout, &jets, z, weights);
        let late = match self.setting.asked.period {
            Some(period) => y[self.setting.equality_count() - 1] / period,
            None => 0.0,
        };
        for time in layout.times() {
            gradient[time] += 1.0 / layout.period(z) + late;
        }
        for (joint, off) in self.anchored(z).into_iter().flatten().enumerate() {
            gradient[joint] += y[values.len()];
            values.push(off);
            slopes.push(DVector::from_fn(layout.size, |i, _| {
                f64::from(u8::from(i == joint))
            }));
        }
        Some(Evaluation {
            inequalities: limits::inequalities(self.setting, layout, z),
            jets,
            net,
            values,
            slopes,
            gradient,
        })
    }

    /// Second derivatives with the inequalities eliminated, and minus the barrier's gradient.
    fn system(&self, here: &Iterate, evaluate: &Evaluation) -> (DMatrix<f64>, DVector<f64>) {
        let of = (&self.layout, &self.rule, evaluate.jets.as_slice());
        let with = (&evaluate.net, here.y.as_slice());
        let mut matrix = self.setting.hessian(of, &here.z, with);
        let mut right = -&evaluate.gradient;
        for (one, push) in evaluate.inequalities.iter().zip(&here.pushes) {
            let stiffness = push / one.value;
            for &(i, a) in one.slope() {
                right[i] += here.barrier / one.value * a;
                for &(j, b) in one.slope() {
                    matrix[(i, j)] += stiffness * a * b;
                }
            }
            if let Some(curved) = &one.curved {
                for (i, &(row, _)) in one.slope().iter().enumerate() {
                    for (j, &(column, _)) in one.slope().iter().enumerate() {
                        matrix[(row, column)] -= push * curved[(i, j)];
                    }
                }
            }
        }
        // With a large weight on the equalities, the matrix is definite only if the Hessian is convex along them.
        let curvature = self.curvature();
        let largest = matrix.diagonal().amax();
        let scale = 10.0 * largest.clamp(curvature, 1e4 * curvature);
        let least = 1e-12 * self.setting.region.scale().powi(4);
        for (value, slope) in evaluate.values.iter().zip(&evaluate.slopes) {
            let weight = scale / slope.norm_squared().max(least);
            matrix.ger(weight, slope, slope, 1.0);
            right -= slope * (weight * value);
        }
        (matrix, right)
    }

    fn direction(&self, here: &mut Iterate, evaluate: &Evaluation) -> Option<Direction> {
        let (matrix, right) = self.system(here, evaluate);
        let curvature = self.curvature();
        let (step, dy) = loop {
            let mut damped = matrix.clone();
            for i in 0..self.layout.size {
                damped[(i, i)] += here.damping;
            }
            if let Some(factors) = damped.cholesky() {
                here.damping = if here.damping < 1e-7 * curvature {
                    0.0
                } else {
                    here.damping / 4.0
                };
                break newton_step(&factors, &right, &evaluate.values, &evaluate.slopes)?;
            }
            here.damping = (4.0 * here.damping).max(1e-4 * curvature);
            if here.damping > 1e8 * curvature {
                return None;
            }
        };
        let (mut longest, mut dual_longest) = (1.0_f64, 1.0_f64);
        let mut pushes = Vec::with_capacity(here.pushes.len());
        for (one, push) in evaluate.inequalities.iter().zip(&here.pushes) {
            let along: f64 = one.slope().iter().map(|(at, a)| a * step[*at]).sum();
            if along < 0.0 && one.curved.is_none() {
                longest = longest.min(-SHARE * one.value / along);
            }
            let d_push = here.barrier / one.value - push - push / one.value * along;
            if d_push < 0.0 {
                dual_longest = dual_longest.min(-SHARE * push / d_push);
            }
            pushes.push(d_push);
        }
        let farthest = step.rows(0, 2 * self.layout.arcs()).amax();
        longest = longest.min(0.5 * self.setting.region.scale() / farthest.max(1e-12));
        let after = (&dy + &here.y).abs();
        here.penalty = here
            .penalty
            .max(2.0 * after.iter().copied().fold(0.0, f64::max));
        Some(Direction {
            z: step,
            y: dy,
            pushes,
            longest,
            dual_longest,
        })
    }

    /// Goes as far along a direction as the merit does not rise; whether it moved.
    fn move_along(&self, here: &mut Iterate, direction: &Direction) -> bool {
        let merit = here.merit.value(here.barrier, here.penalty);
        for length in damped(direction.longest).take(25) {
            let there = &here.z + &direction.z * length;
            let Some(after) = self.merit(&there) else {
                continue;
            };
            if after.value(here.barrier, here.penalty) <= merit + 1e-10 * merit.abs().max(1.0) {
                here.z = there;
                here.merit = after;
                here.y += &direction.y * length;
                let steps = here.pushes.iter_mut().zip(&direction.pushes);
                for ((push, d), margin) in steps.zip(self.margins(&here.z)) {
                    *push += direction.dual_longest * d;
                    // Keep the product near the barrier.
                    let central = here.barrier / margin;
                    *push = push.clamp(1e-8 * central, 1e8 * central);
                }
                return true;
            }
        }
        false
    }

    fn finish(&self, here: &Iterate, net: chain::Net) -> Polygon {
        let (of_sides, _) = here.pushes.as_chunks::<4>();
        Polygon {
            layout: self.layout.clone(),
            pushes: of_sides[..self.layout.arcs()].to_vec(),
            speed: self.setting.measure(&net) / self.layout.period(&here.z),
            z: here.z.clone(),
        }
    }
}

impl Evaluation {
    /// Residual of the barrier problem's KKT conditions; the slopes are those over angles of the scale of the shapes.
    fn error(&self, here: &Iterate, scale: f64) -> f64 {
        let mut dual = self.gradient.clone();
        let mut error: f64 = 0.0;
        for (one, push) in self.inequalities.iter().zip(&here.pushes) {
            for &(at, slope) in one.slope() {
                dual[at] -= push * slope;
            }
            error = error.max((one.value * push - here.barrier).abs());
        }
        let infeasible = self.values.iter().map(|value| value.abs());
        infeasible.fold(error.max(scale * dual.amax()), f64::max)
    }
}

/// Solves `K dz + Jᵀ dy = r`, `J dz = −c`.
fn newton_step(
    factors: &Cholesky<f64, Dyn>,
    right: &DVector<f64>,
    values: &[f64],
    slopes: &[DVector<f64>],
) -> Option<(DVector<f64>, DVector<f64>)> {
    let mut step = factors.solve(right);
    let ways: Vec<DVector<f64>> = slopes.iter().map(|slope| factors.solve(slope)).collect();
    let count = slopes.len();
    let schur = DMatrix::from_fn(count, count, |i, j| slopes[i].dot(&ways[j]));
    let rest = DVector::from_fn(count, |i, _| slopes[i].dot(&step) + values[i]);
    // An empty matrix cannot be factored.
    let dy = if count == 0 {
        rest
    } else {
        schur.lu().solve(&rest)?
    };
    for (way, dy) in ways.iter().zip(dy.iter()) {
        step -= way * *dy;
    }
    let finite = step.iter().all(|value| value.is_finite());
    finite.then_some((step, dy))
}
