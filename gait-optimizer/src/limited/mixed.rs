//! Where several limits bind, each on its part of the cycle, or the torque alone: from many starts to the fastest certified curve.

use nalgebra::Vector2;
use swimmer_files::{ArcKind, GaitArc, Objective};
use swimmer_model::{Gait, Model, Tolerance, swim};

use super::{Limit, Limited, LimitedError, LimitedProblem, STARTS};
use crate::cycle::Cycle;
use crate::immobile::refuse_immobile;
use crate::optimal_gait::OptimalGait;
use crate::parallel::{Watch, in_parallel};
use crate::region::Region;
use crate::speed::certificate::within_limits;
use crate::speed::gauge::Facet;
use crate::speed::interior::{self, Polygon};
use crate::speed::phases::{Curve, Phase, polished};
use crate::speed::setting::{Asked, Setting};
use crate::speed::{SpeedError, selection, starts};

/// Elements of a cycle of several limits, first and last.
const ELEMENTS: [usize; 2] = [8, 16];
/// Rough polygons that are slower than this share of the best finished gait are left, and at most so many are finished.
const HOPELESS: f64 = 0.95;
const FINISHED: usize = 8;
/// A polygon may be slower than the curve near it by this share.
const NEAR: f64 = 1e-3;
/// Sides of a finished polygon for each of a rough one, tried in this order.
const FINER: [usize; 3] = [4, 3, 2];
/// The same for each side of a finished polygon near which no curve is found.
const FINER_STILL: usize = 2;
/// A limit that is none, in the units of the search.
const NONE: f64 = 1e3;
/// A curve on more elements that differs by more than this share of its speed is another one.
const REFINED: f64 = 1e-6;
/// Samples of an element.
const SAMPLES: usize = 48;

impl LimitedProblem {
    /// Where several limits bind, or the torque alone.
    pub(super) fn mixed(
        &self,
        singles: &[Limited],
        watch: Watch<'_>,
    ) -> Result<Limited, LimitedError> {
        let model = Model::new(&self.swimmer.of_unit_length()).map_err(SpeedError::from)?;
        refuse_immobile(&model, &self.bounds).map_err(SpeedError::from)?;
        let region = Region::new(&self.bounds, &self.swimmer.links);
        let unit = self.unit(&model);
        let setting = self.setting(&model, &region, unit);
        let (best, uncertified) = self.searched(&setting, singles, unit, watch);
        let best = best.ok_or_else(|| self.no_gait(singles, uncertified))?;
        // What is faster than with one limit alone is a polygon's error.
        let speeds = singles.iter().map(|one| one.speed_over_length);
        let most = speeds.fold(f64::INFINITY, f64::min);
        let clearly = |other: &f64| (best.speed_over_length * (1.0 + 1e-6)..=most).contains(other);
        Ok(Limited {
            uncertified: uncertified.filter(clearly),
            ..best
        })
    }

    /// The fastest certified curve that starts lead to, and the speed of the fastest that fails.
    fn searched(
        &self,
        setting: &Setting,
        singles: &[Limited],
        unit: f64,
        watch: Watch<'_>,
    ) -> (Option<Limited>, Option<f64>) {
        let known = |index: usize| {
            let gait = singles.get(index)?.gait.gait().ok()?;
            let corner = |k: u32| gait.at((f64::from(k) + 0.25) / 16.0).phi;
            Some(starts::within(
                setting.region,
                (0..16).map(corner).collect(),
            ))
        };
        let rough = |(): &mut (), index: usize| {
            let start = known(index).unwrap_or_else(|| starts::start(setting.region, 0, index));
            interior::rough_polygon(setting, &start)
        };
        let count = STARTS + singles.len();
        let rough = in_parallel(count, self.threads, watch, || (), rough);
        let groups = selection::groups(rough.into_iter().flatten().collect());
        let chosen: Vec<&Polygon> = groups
            .iter()
            .take_while(|group| group.speed() > HOPELESS * groups[0].speed())
            .flat_map(|group| &group.chosen)
            .take(FINISHED)
            .collect();
        let finer = |(): &mut (), index: usize| {
            let finer = |times: &usize| interior::best_polygon(setting, chosen[index], *times);
            FINER.iter().find_map(finer)
        };
        let polygons = in_parallel(chosen.len(), self.threads, &|_| (), || (), finer);
        // A polygon is about as fast as the curve near it, so the first that is certified is the fastest but for a few.
        let (mut best, mut uncertified) = (None::<Limited>, None::<f64>);
        let mut fails = |speed: f64| {
            uncertified = Some(uncertified.map_or(speed, |most: f64| most.max(speed)));
        };
        for group in selection::groups(polygons.into_iter().flatten().collect()) {
            let known = best.as_ref().map_or(0.0, |best| best.speed_over_length);
            if group.speed() * unit < known * (1.0 - NEAR) {
                break;
            }
            let curves = group.chosen.iter();
            let curves = curves.filter_map(|polygon| near(setting, polygon));
            let mut curves = curves.peekable();
            if curves.peek().is_none() {
                fails(group.speed() * unit * (1.0 - NEAR));
            }
            for found in curves.filter_map(|curve| self.told(setting, curve, unit)) {
                let speed = found.speed_over_length;
                if !found.gait.certificate.pass() {
                    fails(speed);
                } else if speed > known {
                    best = Some(found);
                    break;
                }
            }
        }
        (best, uncertified)
    }

    /// The rate \[rad/s\] of about the faster joint at the straight shape: the unit of the search.
    fn unit(&self, model: &Model<f64>) -> f64 {
        let power = model.power_matrix(&Vector2::zeros());
        let facets = self.facets_over_length(1.0);
        let least = |joint: usize| {
            let takes = |facet: &Facet| facet.value(&power, &Vector2::ith(joint, 1.0));
            facets.iter().map(takes).fold(0.0, f64::max)
        };
        1.0 / least(0).min(least(1))
    }

    /// The limits for the swimmer of length 1 whose time unit is so many times shorter.
    fn facets_over_length(&self, unit: f64) -> Vec<Facet> {
        let volume = self.swimmer.total_length().powi(3);
        let scaled = |(_, facet): (Limit, Facet)| match facet {
            Facet::Power { power } => Facet::Power {
                power: power / (volume * unit * unit),
            },
            Facet::Flat {
                joint,
                rate,
                torque,
            } => Facet::Flat {
                joint,
                rate: rate * unit,
                torque: torque * volume * unit,
            },
        };
        self.facets().into_iter().map(scaled).collect()
    }

    fn setting<'a>(&self, model: &'a Model<f64>, region: &'a Region, unit: f64) -> Setting<'a> {
        // The four facets of the rates come first, if any.
        let known = if self.rates.is_some() { 4 } else { 0 };
        Setting {
            model,
            region,
            rates: self
                .rates
                .map_or([NONE; 2], |rates| rates.map(|rate| rate / unit)),
            beyond: self.facets_over_length(unit).split_off(known),
            asked: Asked::default(),
            members: &[],
        }
    }

    /// A curve as an answer, on more elements; none where it cannot be had on them.
    fn told(&self, setting: &Setting, curve: Curve, unit: f64) -> Option<Limited> {
        let finer = curve.refined(setting, ELEMENTS[1]);
        let off = |finer: &Curve| (curve.speed / finer.speed - 1.0).abs();
        let finer = finer.filter(|finer| off(finer) < REFINED);
        let refinement = finer.as_ref().map(off);
        let curve = finer.unwrap_or(curve);
        let ahead = curve.net.heading().cos() >= 0.0;
        let limits = setting.limits();
        let mut cycle = sampled(setting.region, &limits, &curve);
        if !ahead {
            cycle = cycle.reversed(|phi| *phi);
        }
        let gait = cycle.gait().ok()?;
        let file = cycle.file(self.bounds);
        let told = (curve.period(), curve.net.distance());
        let of = (setting.model, setting.region);
        let certificate = within_limits(of, &limits, (&file, &gait), told);
        let stroke = swim(setting.model, &gait, &Tolerance::default());
        let of = (Objective::Speed, &self.swimmer, &self.bounds);
        let gait = OptimalGait {
            certificate,
            ..OptimalGait::of_cycle(of, false, cycle, &stroke)
        };
        let limited = self.limited(gait, told.1, told.0 / unit).ok()?;
        Some(Limited {
            refinement,
            ..limited
        })
    }
}

/// The curve near a polygon; where it does not tell what binds, one of more sides does.
fn near(setting: &Setting, polygon: &Polygon) -> Option<Curve> {
    let finer = || interior::best_polygon(setting, polygon, FINER_STILL);
    let polished = |polygon: &Polygon| polished(setting, polygon, ELEMENTS[0]);
    polished(polygon).or_else(|| polished(&finer()?))
}

/// A curve as one cycle of samples, each phase with its own, from the corner of the most φ₂ and half as much φ₁ on: of symmetric gaits
/// that is one.
fn sampled(region: &Region, limits: &[Facet], curve: &Curve) -> Cycle {
    let mut cycle = Cycle::default();
    let phases = curve.phases();
    let far = |number: &usize| {
        let phi = curve.at(phases[*number].from);
        phi.y + 0.5 * phi.x
    };
    let first = (0..phases.len()).max_by(|a, b| far(a).total_cmp(&far(b)));
    let first = first.unwrap_or(0);
    let begun = phases[first].from;
    let since = |share: f64| (share - begun).rem_euclid(1.0);
    for number in (0..phases.len()).map(|k| (first + k) % phases.len()) {
        let phase = &phases[number];
        let kind = kind(region, limits, phase);
        cycle.corners.push(since(phase.from));
        let mut from = phase.from;
        for (_, until) in curve.elements().filter(|(of, _)| *of == number) {
            for step in 0..SAMPLES {
                let share = from + (until - from) * step as f64 / SAMPLES as f64;
                cycle.u.push(since(share));
                cycle.phi.push(curve.at(share));
            }
            from = until;
        }
        cycle.arcs.push(GaitArc {
            kind,
            from: since(phase.from),
            to: since(phase.to),
        });
    }
    cycle.u.push(1.0);
    cycle.phi.extend(cycle.phi.first().copied());
    if let Some(last) = cycle.arcs.last_mut() {
        last.to = 1.0;
    }
    cycle
}

/// Two limits leave no choice of the direction, one flat one leaves the costate none.
fn kind(region: &Region, limits: &[Facet], phase: &Phase) -> ArcKind {
    if let Some(bound) = phase.bound.and_then(|bound| region.bound(bound)) {
        return bound.kind();
    }
    match phase.limits.as_slice() {
        [one] if matches!(limits[*one], Facet::Power { .. }) => ArcKind::Regular,
        [_] => ArcKind::Singular,
        _ => ArcKind::Extreme,
    }
}
