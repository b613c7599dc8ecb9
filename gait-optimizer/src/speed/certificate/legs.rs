//! A cycle cut into its arcs, with poses and heights along each.

use nalgebra::Vector2;
use swimmer_files::{AnyGait, ArcKind, GaitArc, GaitFile};
use swimmer_model::{Gait as _, Model, Panel, Panels, Tolerance};

use super::super::setting::Goal;
use crate::height_map::legendre::gauss;
use crate::member::Member;
use crate::momentum::{Height, Momentum};
use crate::numerics::worse;
use crate::region::Region;

/// One place on an arc.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    /// Weight of an integral over u.
    pub(crate) weight: f64,
    pub(crate) phi: Vector2<f64>,
    pub(crate) rate: Vector2<f64>,
    pub(crate) theta: f64,
    /// The height for p along d (of members each along its own, weighted and summed), for a unit of the multiplier of rotation, and
    /// for one of the heading; of most rotation the height for it, and nothing.
    pub(crate) height: [f64; 3],
    /// Gradients of the same.
    pub(crate) slope: [Vector2<f64>; 3],
    /// Rotation per unit motion of each joint, and its derivative along that joint.
    pub(crate) turn: [f64; 2],
    pub(crate) turn_slope: [f64; 2],
}

/// One arc.
#[derive(Debug, Clone)]
pub(crate) struct Leg {
    pub(crate) kind: ArcKind,
    /// Share of the period.
    pub(crate) share: f64,
    pub(crate) from: Vector2<f64>,
    pub(crate) to: Vector2<f64>,
    /// θ at the start and after each panel.
    pub(crate) theta: Vec<f64>,
    /// Direction of each joint halfway: −1 or 1.
    pub(crate) ways: [f64; 2],
    /// Panels of nodes, in order.
    pub(crate) panels: Vec<Vec<Node>>,
}

impl Leg {
    /// θ at its start (0) or its end (1).
    pub(crate) fn theta_at(&self, end: usize) -> f64 {
        let at = if end == 0 { 0 } else { PANELS };
        self.theta.get(at).copied().unwrap_or(f64::NAN)
    }
}

/// A cycle.
#[derive(Debug, Clone)]
pub(crate) struct Legs {
    pub(crate) all: Vec<Leg>,
    /// Pose after the cycle.
    pub(crate) end: [f64; 3],
    /// |d|, the weighted sum of the members', or |Δθ| where that is to be the most.
    pub(crate) distance: f64,
    /// Mean of θ over the period.
    pub(crate) mean_theta: f64,
    /// Largest |dφᵢ/du|.
    pub(crate) rates: [f64; 2],
}

/// Nodes of a panel, and panels of an arc.
const NODES: usize = 6;
const PANELS: usize = 16;

impl Legs {
    /// Returns `None` for a cycle without displacement, or with invalid arcs.
    pub(crate) fn new(
        (model, members): (&Model<f64>, &[(Member, f64)]),
        region: &Region,
        goal: Goal,
        file: &GaitFile,
        gait: &AnyGait,
    ) -> Option<Self> {
        let panels: Vec<Panel<f64>> = Panels::new(model, gait, &Tolerance::default()).collect();
        let last = panels.last()?.end_pose();
        let distance = match goal {
            Goal::Distance => last.x.hypot(last.y),
            Goal::Rotation => last.theta.abs(),
        };
        if distance.is_nan() || distance < 1e-12 {
            return None;
        }
        let spans = arcs(region, file, gait);
        let (points, weights) = gauss(NODES);
        let unit = Vector2::new(last.x, last.y) / distance;
        let across = Vector2::new(-unit.y, unit.x);
        let ensemble = members.iter().map(|one| Swum::new(one, file));
        let ensemble: Vec<Swum> = ensemble.collect::<Option<_>>()?;
        let own = distance;
        let distance = if ensemble.is_empty() {
            own
        } else {
            ensemble.iter().map(|one| one.weight * one.distance).sum()
        };
        let mut legs = Vec::with_capacity(spans.len());
        for span in &spans {
            let width = (span.to - span.from) / PANELS as f64;
            let node = |u: f64, weight: f64| {
                let point = gait.at(u);
                let pose = pose_at(&panels, u);
                let second = model.second_derivatives(&point.phi);
                let height = |p: Vector2<f64>, c: f64| Momentum { p, c }.height(&second, &pose);
                let none = || height(Vector2::zeros(), 0.0);
                let parts = match goal {
                    Goal::Distance => [
                        if ensemble.is_empty() {
                            height(unit, 0.0)
                        } else {
                            let heights = ensemble.iter().map(|one| one.height(u, &point.phi));
                            heights.fold(none(), |sum, one| Height {
                                value: sum.value + one.value,
                                gradient: sum.gradient + one.gradient,
                            })
                        },
                        height(Vector2::zeros(), 1.0),
                        // Over |d|, as the first.
                        height(across * (distance / own), -distance * (1.0 - u)),
                    ],
                    Goal::Rotation => [
                        height(Vector2::zeros(), last.theta.signum()),
                        none(),
                        none(),
                    ],
                };
                Node {
                    weight,
                    phi: point.phi,
                    rate: point.rate,
                    theta: pose[2],
                    height: parts.map(|part| part.value),
                    slope: parts.map(|part| part.gradient),
                    turn: [0, 1].map(|i| second.first.connection[(2, i)]),
                    turn_slope: [0, 1].map(|i| second.first.d_connection[i][(2, i)]),
                }
            };
            let nodes: Vec<Vec<Node>> = (0..PANELS)
                .map(|k| {
                    let begun = span.from + width * k as f64;
                    points
                        .iter()
                        .zip(&weights)
                        .map(|(x, w)| node(begun + 0.5 * width * (x + 1.0), 0.5 * width * w))
                        .collect()
                })
                .collect();
            let middle = gait.at(0.5 * (span.from + span.to)).rate;
            legs.push(Leg {
                kind: span.kind,
                share: span.to - span.from,
                from: gait.at(span.from).phi,
                to: gait.at(span.to).phi,
                theta: (0..=PANELS)
                    .map(|k| pose_at(&panels, span.from + width * k as f64)[2])
                    .collect(),
                ways: [middle.x.signum(), middle.y.signum()],
                panels: nodes,
            });
        }
        let all = || legs.iter().flat_map(|leg| leg.panels.iter().flatten());
        let rates = [0, 1].map(|i| all().map(|node| node.rate[i].abs()).fold(0.0, worse));
        let mean_theta = all().map(|node| node.weight * node.theta).sum();
        (!legs.is_empty()).then_some(Self {
            end: [last.x, last.y, last.theta],
            distance,
            mean_theta,
            rates,
            all: legs,
        })
    }

    /// Direction of the displacement, against the mean heading.
    pub(crate) fn heading(&self) -> f64 {
        self.end[1].atan2(self.end[0]) - self.mean_theta
    }

    /// Largest relative deviation of the servo rates from those of their arcs.
    pub(crate) fn off_full_rate(&self) -> f64 {
        let mut worst: f64 = 0.0;
        for leg in &self.all {
            for node in leg.panels.iter().flatten() {
                let shares = [0, 1].map(|i| node.rate[i].abs() / self.rates[i]);
                let off = if leg.kind == ArcKind::Extreme {
                    (1.0 - shares[0]).max(1.0 - shares[1])
                } else {
                    1.0 - shares[0].max(shares[1])
                };
                worst = worst.max(off);
            }
        }
        worst
    }

    /// Joint whose servo runs at full rate on an arc that is not extreme.
    pub(crate) fn pace(&self, leg: &Leg) -> usize {
        let mut sums = [0.0; 2];
        for node in leg.panels.iter().flatten() {
            for (i, sum) in sums.iter_mut().enumerate() {
                *sum += node.weight * node.rate[i].abs() / self.rates[i];
            }
        }
        usize::from(sums[1] > sums[0])
    }
}

/// A member's own way through the cycle.
struct Swum<'a> {
    member: &'a Member,
    weight: f64,
    panels: Vec<Panel<f64>>,
    distance: f64,
    unit: Vector2<f64>,
}

impl<'a> Swum<'a> {
    fn new((member, weight): &'a (Member, f64), file: &GaitFile) -> Option<Self> {
        let turned = GaitFile {
            phi: file.phi.iter().map(|phi| phi * member.gain).collect(),
            ..file.clone()
        };
        let gait = AnyGait::from_file(&turned).ok()?;
        let panels = Panels::new(&member.model, &gait, &Tolerance::default());
        let panels: Vec<Panel<f64>> = panels.collect();
        let end = panels.last()?.end_pose();
        let distance = end.x.hypot(end.y);
        Some(Self {
            unit: Vector2::new(end.x, end.y) / distance,
            weight: *weight,
            member,
            panels,
            distance,
        })
    }

    /// Weighted contribution of the member to the height at a commanded shape.
    fn height(&self, u: f64, phi: &Vector2<f64>) -> Height {
        let Member { model, gain, .. } = self.member;
        let momentum = Momentum {
            p: self.unit,
            c: 0.0,
        };
        let second = model.second_derivatives(&(phi * *gain));
        let height = momentum.height(&second, &pose_at(&self.panels, u));
        Height {
            value: height.value * self.weight * gain.powi(2),
            gradient: height.gradient * (self.weight * gain.powi(3)),
        }
    }
}

pub(super) fn pose_at(panels: &[Panel<f64>], u: f64) -> [f64; 3] {
    let at = panels
        .partition_point(|panel| panel.end() < u)
        .min(panels.len().saturating_sub(1));
    panels.get(at).map_or([f64::NAN; 3], |panel| {
        let pose = panel.pose(u);
        [pose.x, pose.y, pose.theta]
    })
}

/// Arcs of a gait: those of the file, if they cover the whole cycle.
pub(super) fn arcs(region: &Region, file: &GaitFile, gait: &AnyGait) -> Vec<GaitArc> {
    let stated = file.arcs.iter().filter(|arc| arc.to > arc.from);
    let until = stated.clone().try_fold(0.0, |until: f64, arc| {
        ((arc.from - until).abs() < 1e-12).then_some(arc.to)
    });
    if until.is_some_and(|until| (until - 1.0).abs() < 1e-12) {
        stated.copied().collect()
    } else {
        between_corners(region, file, gait)
    }
}

/// Arcs of a gait without listed arcs: from corner to corner.
fn between_corners(region: &Region, file: &GaitFile, gait: &AnyGait) -> Vec<GaitArc> {
    let mut ends = file.corners.clone();
    if ends.first() != Some(&0.0) {
        ends.insert(0, 0.0);
    }
    ends.push(1.0);
    let largest = file
        .u
        .iter()
        .map(|&u| gait.at(u).rate.abs())
        .fold(Vector2::zeros(), |most: Vector2<f64>, rate| most.sup(&rate));
    ends.windows(2)
        .map(|pair| {
            let middle = gait.at(0.5 * (pair[0] + pair[1]));
            let full = (0..2).all(|i| middle.rate[i].abs() > 0.999 * largest[i]);
            let kind = if full {
                ArcKind::Extreme
            } else if region.overstepped(&middle.phi) > -super::RESTS {
                ArcKind::Upper
            } else {
                ArcKind::Singular
            };
            GaitArc {
                kind,
                from: pair[0],
                to: pair[1],
            }
        })
        .collect()
}
