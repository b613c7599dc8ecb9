//! Holds a gait whose servos keep within any limits against its conditions: those of the costate, and the second-order one.

use swimmer_files::{AnyGait, GaitFile};
use swimmer_model::{Gait as _, Model, Panels, Tolerance, swim};

use super::costate::Costate;
use super::legs::arcs;
use super::{of_the_curve, taken};
use crate::certificate::{Certificate, Condition, again_within};
use crate::region::Region;
use crate::speed::gauge::Facet;
use crate::speed::quadrature::{Rule, cut};

/// Gauss nodes of a part of the cycle, its longest share of the period, and about the most that it turns \[rad\].
const NODES: usize = 10;
const LONGEST: f64 = 0.06;
const TURN: f64 = 0.5;
/// Fewest parts of an arc.
const LEAST: usize = 3;

/// Holds one cycle that takes this period against the conditions. Of the swimmer with L = 1.
pub(crate) fn within_limits(
    (model, region): (&Model<f64>, &Region),
    limits: &[Facet],
    (file, gait): (&GaitFile, &AnyGait),
    (period, distance): (f64, f64),
) -> Certificate {
    let mut checks = of_the_curve(model, region, file, gait);
    let stroke = swim(model, gait, &Tolerance::default());
    let d = stroke.displacement;
    let apart = (d.norm() - distance).abs();
    checks.extend([
        Condition::DisplacementSteppedAgain.within(apart, again_within(distance)),
        Condition::NoRotation.check(stroke.rotation.abs()),
    ]);
    let slowness = period / d.norm();
    let costate = Costate {
        model,
        region,
        limits,
        gait,
        panels: Panels::new(model, gait, &Tolerance::default()).collect(),
        period,
        p: d / d.norm() * slowness,
        slowness,
        rule: Rule::new(NODES),
    };
    let parts = parts(region, file, gait);
    let (of_costate, held) = costate.checks(&parts);
    checks.extend(of_costate);
    let second = held.and_then(|held| costate.least_second_variation(&parts, &held));
    checks.extend(second.map(|least| Condition::NoFasterNeighbour.check(least)));
    Certificate::new(checks)
}

/// The same of a gait from anywhere, within the limits that it takes in full.
pub(crate) fn within_its_own(
    of: (&Model<f64>, &Region),
    (file, gait): (&GaitFile, &AnyGait),
) -> Certificate {
    let nodes = Rule::new(NODES).nodes;
    let places = parts(of.1, file, gait).into_iter();
    let places = places.flat_map(|(from, to)| nodes.iter().map(move |s| from + (to - from) * s));
    let limits = taken::limits(of.0, gait, places);
    let end = Panels::new(of.0, gait, &Tolerance::default()).last();
    let distance = end.map_or(f64::NAN, |panel| {
        let pose = panel.end_pose();
        pose.x.hypot(pose.y)
    });
    within_limits(of, &limits, (file, gait), (1.0, distance))
}

/// The arcs, cut into parts that are short and turn little.
fn parts(region: &Region, file: &GaitFile, gait: &AnyGait) -> Vec<(f64, f64)> {
    let rates = [1.0 / LONGEST, 1.0 / TURN];
    let arcs = arcs(region, file, gait).into_iter();
    arcs.flat_map(|arc| cut((arc.from, arc.to), |u| gait.at(u).rate, (rates, LEAST)))
        .collect()
}
