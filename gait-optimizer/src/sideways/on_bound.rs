//! Loops that start on a straight bound where the heading is stationary along it, or in a corner of the bounds.
//!
//! The start is known, p is across its heading; one unknown is left, the multiplier c of the rotation, and one condition,
//! no net rotation: a scan over c with a root search finds every such loop.

use nalgebra::Vector2;
use swimmer_model::Model;

use crate::cycle::Cycle;
use crate::loops::{ClosedOrbit, Launch, ReturnCondition, Section, traced_from};
use crate::momentum::{Momentum, Motion, Track};
use crate::numerics::{halved, root};
use crate::region::{Bound, Edge, Region};

/// Places looked at along an edge.
const PLACES: u32 = 160;
/// Multipliers looked at, from −RANGE to RANGE, over L.
const LOOKS: u32 = 80;
const RANGE: f64 = 0.8;
/// Tolerances of the integration.
const COARSE: f64 = 1e-7;
const FINE: f64 = 1e-13;

/// All loops that close, traced.
pub(super) fn candidates(model: &Model<f64>, region: &Region, samples: usize) -> Vec<Cycle> {
    let mut found = Vec::new();
    for start in starts(model, region) {
        for sign in [1.0, -1.0] {
            let family = Family {
                model,
                region,
                start,
                sign,
            };
            for rotation in family.roots() {
                let orbit = family.shoot(rotation, FINE);
                found.extend(orbit.and_then(|orbit| traced_from(model, &orbit, None, samples)));
            }
        }
    }
    found
}

/// Shapes on the straight bounds where the heading is stationary along them, and their corners.
fn starts(model: &Model<f64>, region: &Region) -> Vec<Section> {
    let mut found = Vec::new();
    let reach = region.horizon;
    for (bound, edge) in region.bounds().enumerate() {
        let Bound::Straight(edge) = edge else {
            continue;
        };
        let along = edge.counter_clockwise();
        let middle = edge.normal * edge.offset;
        let place = |k: u32| reach * (2.0 * f64::from(k) / f64::from(PLACES) - 1.0);
        let inside = |at: &Vector2<f64>| region.overstepped(at) < 1e-12;
        let turning = |at: &Vector2<f64>| {
            let a = model.local_connection(at);
            a[(2, 0)] * along.x + a[(2, 1)] * along.y
        };
        for k in 0..PLACES {
            let [low, high] = [place(k), place(k + 1)].map(|place| middle + along * place);
            if !inside(&low) || !inside(&high) || turning(&low) * turning(&high) > 0.0 {
                continue;
            }
            let same = |share: f64| turning(&low) * turning(&low.lerp(&high, share)) > 0.0;
            let [_, share] = halved([0.0, 1.0], 60, same);
            let at = edge.onto(&low.lerp(&high, share));
            let bound = Some(bound);
            found.push(Section { at, along, bound });
        }
        found.extend(corner(region, bound, &edge).filter(|start| inside(&start.at)));
    }
    found
}

/// The corner where an edge begins, run counter-clockwise.
fn corner(region: &Region, bound: usize, edge: &Edge) -> Option<Section> {
    let along = edge.counter_clockwise();
    region.edges().iter().find_map(|other| {
        // The edge before is square to this one for a box.
        let turns_left = other.counter_clockwise().perp(&along);
        (turns_left > 0.99).then(|| Section {
            at: edge.normal * edge.offset + other.normal * other.offset,
            along,
            bound: Some(bound),
        })
    })
}

struct Family<'a> {
    model: &'a Model<f64>,
    region: &'a Region,
    start: Section,
    /// Left or right of the heading.
    sign: f64,
}

impl Family<'_> {
    fn shoot(&self, rotation: f64, tolerance: f64) -> Option<ClosedOrbit> {
        let bound = self.start.bound?;
        let launch = Launch {
            model: self.model,
            region: self.region,
            momentum: Momentum {
                p: Vector2::new(0.0, self.sign),
                c: rotation,
            },
            start: self.start.at,
            first: Motion::Along(Track::new(self.region, bound, &self.start.at, 1.0)?),
            until: ReturnCondition::Along(bound),
            ahead: self.start.along,
            shortest: 0.5,
            near: f64::INFINITY,
            tolerance,
        };
        launch.orbit()
    }

    fn miss(&self, rotation: f64, tolerance: f64) -> Option<f64> {
        let end = self.shoot(rotation, tolerance)?.end;
        let off = (Vector2::new(end[0], end[1]) - self.start.at).norm();
        (off < 1e-6).then_some(end[4])
    }

    /// Multipliers for which the loop closes without net rotation.
    fn roots(&self) -> Vec<f64> {
        let place = |k: u32| RANGE * (2.0 * f64::from(k) / f64::from(LOOKS) - 1.0);
        let misses: Vec<Option<f64>> = (0..=LOOKS).map(|k| self.miss(place(k), COARSE)).collect();
        let mut roots = Vec::new();
        for (k, pair) in (0..LOOKS).zip(misses.array_windows()) {
            if let [Some(a), Some(b)] = pair
                && a * b <= 0.0
            {
                let ends = [(place(k), *a), (place(k + 1), *b)];
                roots.extend(root(ends, 1e-12, |at| self.miss(at, FINE)));
            }
        }
        roots
    }
}
