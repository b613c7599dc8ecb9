//! Robust displacement gaits: Pontryagin's principle for an ensemble of swimmers, on arcs.
//!
//! For weights wₖ of the members the first variation of Σ wₖ Xₖ under a push of the curve is ∮ h̄ ds with the weighted height
//! h̄ = Σ wₖ μₖ·Fₖ, each member with its own pose, momentum and curvature. So free arcs satisfy h̄ = 0, and along an upper
//! bound h̄ ≥ 0 (sign of the KKT multiplier).
//!
//! A free arc is a polynomial through Chebyshev–Lobatto nodes. Each node moves along its own direction, which at the arc's
//! ends lies along what the end must stay on (a diagonal or a bound) and turns evenly between; so there are as many unknowns
//! as conditions h̄ = 0, one a node. Arcs along bounds are straight between their neighbours' ends. The nominal optimum of
//! [`crate::displacement()`] gives the arcs and the start; Newton's method does the rest.

use nalgebra::{DVector, Vector2};
use swimmer_files::{ArcKind, Objective};
use swimmer_model::{Gait, Model, Stroke};

use super::newton::{Design, Family, newton};
use super::nodes::Nodes;
use super::quarter::{ArcCurve, Trajectory};
use super::{RobustError, cycle};
use crate::certificate::{Check, Condition};
use crate::cycle::Cycle;
use crate::member::Member;
use crate::momentum::Height;
use crate::optimal_gait::OptimalGait;

/// Degree of the polynomial of an arc: one of several, or the whole quarter.
const DEGREES: [usize; 2] = [28, 44];
/// Largest height, over L and per square radian, that counts as zero.
pub(super) const FLAT: f64 = 1e-11;

/// Arc of the design.
#[derive(Debug, Clone)]
struct Leg {
    kind: ArcKind,
    /// Nodes of a free arc, and their directions of motion.
    nodes: Vec<(Vector2<f64>, Vector2<f64>)>,
    /// Ends of a straight arc along a bound; neighbouring free arcs may move them.
    ends: [Vector2<f64>; 2],
}

/// Family of gaits with the arcs of a nominal optimum.
#[derive(Debug)]
pub(super) struct Arcs {
    nodes: Nodes,
    legs: Vec<Leg>,
    /// 1 to maximise X, −1 to minimise it.
    sign: f64,
}

impl Arcs {
    /// Creates the family around a gait.
    pub(super) fn around(gait: &OptimalGait, sign: f64) -> Result<Self, RobustError> {
        let [several, single] = DEGREES;
        let nodes = Nodes::new(if gait.arcs.len() > 1 { several } else { single });
        let curve = gait.gait().map_err(|_| RobustError::Structure {
            problem: "the nominal gait's samples cannot be swum",
        })?;
        let mut legs = Vec::with_capacity(gait.arcs.len());
        for (index, (arc, timed)) in gait.arcs.iter().zip(gait.cycle_arcs()).enumerate() {
            let along = |at: Option<usize>, diagonal: Vector2<f64>| {
                let bound = at.and_then(|at| gait.arcs.get(at));
                bound.map_or(diagonal, |bound| {
                    Vector2::from(bound.to) - Vector2::from(bound.from)
                })
            };
            let first = along(index.checked_sub(1), Vector2::new(1.0, 1.0));
            let last = along(Some(index + 1), Vector2::new(-1.0, 1.0));
            let span = (timed.from, timed.to.min(0.25));
            legs.push(Leg {
                kind: arc.kind,
                nodes: match arc.kind {
                    ArcKind::Upper => Vec::new(),
                    ArcKind::Singular => free(&nodes, &curve, span, [first, last]),
                    kind => return Err(RobustError::Arc { kind }),
                },
                ends: [arc.from, arc.to].map(Vector2::from),
            });
        }
        Ok(Self { nodes, legs, sign })
    }

    /// Returns the arcs displaced by `x`, one number per free node.
    pub(super) fn curves(&self, x: &DVector<f64>) -> Vec<ArcCurve> {
        let mut by = x.iter();
        let moved = |leg: &Leg| {
            let nodes = leg.nodes.iter().zip(&mut by);
            nodes
                .map(|((phi, direction), by)| phi + direction * *by)
                .collect()
        };
        let mut arcs: Vec<Vec<Vector2<f64>>> = self.legs.iter().map(moved).collect();
        for (at, leg) in self.legs.iter().enumerate() {
            if arcs[at].is_empty() {
                let before = at.checked_sub(1).and_then(|at| arcs[at].last().copied());
                let after = arcs.get(at + 1).and_then(|arc| arc.first().copied());
                let (from, to) = (before.unwrap_or(leg.ends[0]), after.unwrap_or(leg.ends[1]));
                let straight = self.nodes.place.iter().map(|t| from + (to - from) * *t);
                arcs[at] = straight.collect();
            }
        }
        arcs.into_iter()
            .map(|phi| ArcCurve {
                slope: self.nodes.slopes(&phi),
                phi,
            })
            .collect()
    }

    /// Weighted heights at all nodes, with their gradients.
    fn heights(&self, arcs: &[ArcCurve], members: &[(Member, f64)]) -> Vec<Height> {
        let shapes: Vec<_> = arcs.iter().flat_map(|arc| &arc.phi).collect();
        let nothing = Height {
            value: 0.0,
            gradient: Vector2::zeros(),
        };
        let mut heights = vec![nothing; shapes.len()];
        for (member, weight) in members.iter().filter(|(_, weight)| *weight != 0.0) {
            let swum = Trajectory::new(member, &self.nodes, arcs);
            for (index, (phi, sum)) in shapes.iter().zip(&mut heights).enumerate() {
                let height = swum.height(member, index, phi);
                sum.value += self.sign * weight * height.value;
                sum.gradient += height.gradient * (self.sign * weight);
            }
        }
        heights
    }

    /// Splits node values by leg.
    fn of_legs<'a>(
        &'a self,
        heights: &'a [Height],
    ) -> impl Iterator<Item = (&'a Leg, &'a [Height])> {
        self.legs.iter().zip(heights.chunks(self.nodes.count()))
    }
}

impl Family for Arcs {
    const OBJECTIVE: Objective = Objective::Displacement;

    fn cycle(&self, model: &Model<f64>, x: &DVector<f64>) -> Cycle {
        let kinds = self.legs.iter().map(|leg| leg.kind);
        cycle::of_arcs(model, &self.nodes, kinds, &self.curves(x))
    }

    /// Conditions: h̄ vanishes on free arcs and decreases outwards there (generalised Legendre–Clebsch), and pushes against bounds.
    fn conditions(&self, x: &DVector<f64>, members: &[(Member, f64)]) -> Vec<Check> {
        let arcs = self.curves(x);
        let heights = self.heights(&arcs, members);
        let mut multiplier: Option<f64> = None;
        let (mut largest, mut falls) = (0.0_f64, f64::INFINITY);
        for ((leg, heights), arc) in self.of_legs(&heights).zip(&arcs) {
            for (height, slope) in heights.iter().zip(&arc.slope) {
                if leg.kind == ArcKind::Upper {
                    let least = multiplier.unwrap_or(f64::INFINITY);
                    multiplier = Some(least.min(height.value));
                    continue;
                }
                largest = largest.max(height.value.abs());
                let outward = Vector2::new(slope.y, -slope.x).normalize();
                falls = falls.min(-height.gradient.dot(&outward));
            }
        }
        let mut checks = vec![
            Condition::RobustHeight.check(largest),
            Condition::RobustGrowsInwards.check(falls),
        ];
        checks.extend(multiplier.map(|least| Condition::RobustOnBound.check(least)));
        checks
    }
}

impl Design for Arcs {
    type Point = DVector<f64>;
    const RELATIVE: bool = false;

    fn start(&self) -> DVector<f64> {
        DVector::zeros(self.legs.iter().map(|leg| leg.nodes.len()).sum())
    }

    fn value(&self, x: &DVector<f64>, member: &Member) -> f64 {
        let arcs = self.curves(x);
        self.sign * Trajectory::new(member, &self.nodes, &arcs).displacement
    }

    fn swum(&self, _: &DVector<f64>, stroke: &Stroke<f64>) -> f64 {
        self.sign * stroke.displacement.x
    }

    fn unit(&self) -> f64 {
        self.sign
    }

    fn solve(
        &self,
        start: &DVector<f64>,
        members: &[(Member, f64)],
    ) -> Result<DVector<f64>, RobustError> {
        let residual = |x: &DVector<f64>| {
            let heights = self.heights(&self.curves(x), members);
            let free = self.of_legs(&heights);
            let free = free.filter(|(leg, _)| leg.kind == ArcKind::Singular);
            let free = free.flat_map(|(_, heights)| heights);
            DVector::from_vec(free.map(|height| height.value).collect())
        };
        newton(residual, start.clone(), FLAT, MOST)
    }
}

/// Largest step of a node in one iteration \[rad\].
const MOST: f64 = 0.1;

/// Free arc between two fractions of the period, whose ends move along these directions.
fn free(
    nodes: &Nodes,
    curve: &impl Gait<f64>,
    (from, to): (f64, f64),
    along: [Vector2<f64>; 2],
) -> Vec<(Vector2<f64>, Vector2<f64>)> {
    // Outward is the right-hand side of the motion.
    let outward = |u: f64, along: Vector2<f64>| {
        let rate = curve.at(u).rate;
        let along = along.normalize();
        if along.dot(&Vector2::new(rate.y, -rate.x)) < 0.0 {
            -along
        } else {
            along
        }
    };
    let inside = 1e-6 * (to - from);
    let (begin, end) = (
        outward(from + inside, along[0]),
        outward(to - inside, along[1]),
    );
    let place = |t: &f64| {
        let phi = curve.at(from + (to - from) * t).phi;
        (phi, (begin + (end - begin) * *t).normalize())
    };
    nodes.place.iter().map(place).collect()
}
