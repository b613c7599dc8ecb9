//! The ways of the joints through one cycle, one imperfection after the other.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "periods and pulses are bounded by what was checked; f32 is what the robot itself uses"
)]

use gait_player::playback::Playback;
use gait_player::servo::ServoMap;
use gait_player::servo::plant::PlantParameters;
use gait_player::table::check::{Checker, Facts};
use gait_player::{GaitTable, Limits};
use nalgebra::Vector2;
use swimmer_model::{Gait, Links, Model, Panels, Stroke};

use super::{ForecastError, Played, Verdict, gap, stroke, tolerance};
use crate::path::{Polyline, TableCurve};
use crate::table::{knot, table};

/// A map whose nanoseconds are 3e-8 rad: pulses that round nothing that single precision does not round.
const FINE: ServoMap = ServoMap {
    centre_ns: 2_000_000_000,
    slope_rad_per_us: 2.7e-5,
    reversed: false,
    trim: 0.0,
};

/// Every way but the designed one.
pub(super) struct Ways {
    table: GaitTable,
    interpolated: TableCurve,
    rounded: TableCurve,
    /// Ticked, pulsed, rate-limited, played.
    chains: [Polyline; 4],
}

impl Ways {
    pub(super) fn new<G: Gait<f64> + ?Sized>(
        gait: &G,
        played: &Played,
    ) -> Result<Self, ForecastError> {
        let table = table(gait, played.knots)?;
        let knots = played.knots;
        let designed = (0..knots).map(|index| knot(gait, knots, index as f64 / knots as f64));
        let units = |knot| Vector2::from(table.knot(knot).map(|unit| f64::from(unit) * 1e-4));
        let servos = &played.servos;
        let (map, plant) = (servos.map(), servos.plant());
        let pulsed = PlantParameters {
            pulse_step_ns: plant.pulse_step_ns,
            ..PlantParameters::IDEAL
        };
        let limited = PlantParameters {
            dead_band: 0.0,
            ..plant
        };
        let first = gait.at(0.0).phi;
        let chain = |map, plant| chain(&table, played, first, map, plant);
        let chains = [
            chain(FINE, PlantParameters::IDEAL),
            chain(map, pulsed),
            chain(map, limited),
            chain(map, plant),
        ];
        Ok(Self {
            interpolated: TableCurve::new(designed.collect()),
            rounded: TableCurve::new((0..knots).map(units).collect()),
            chains,
            table,
        })
    }

    /// The way that the servos take.
    pub(super) fn played(&self) -> &Polyline {
        let [.., played] = &self.chains;
        played
    }

    /// All stages swum, the designed gait first.
    pub(super) fn swum<G: Gait<f64> + ?Sized>(
        &self,
        model: &Model<f64>,
        gait: &G,
    ) -> Vec<Stroke<f64>> {
        let mut swum = vec![
            stroke(model, gait),
            stroke(model, &self.interpolated),
            stroke(model, &self.rounded),
        ];
        swum.extend(self.chains.iter().map(|chain| {
            let (delta_y, delta_theta) = ranges(model, chain);
            Stroke {
                delta_y,
                delta_theta,
                ..stroke(model, chain)
            }
        }));
        swum
    }

    /// What the robot's own checks say.
    pub(super) fn verdict(&self, links: &Links<f64>, played: &Played) -> Verdict {
        let limits = played.servos.limits();
        let facts = facts(&self.table, links);
        let Some(facts) = facts else {
            return Verdict {
                refused: Some("the check of the table did not end".to_owned()),
                min_period: f64::NAN,
            };
        };
        let refused = facts
            .allow(&limits)
            .and_then(|()| facts.allow_period(&limits, period_us(played)));
        Verdict {
            refused: refused.err().map(|refusal| refusal.to_string()),
            min_period: f64::from(facts.min_period_us(&limits)) * 1e-6,
        }
    }
}

/// What the robot's own check finds of a table.
pub(crate) fn facts(table: &GaitTable, links: &Links<f64>) -> Option<Facts> {
    let mut checker = Checker::new();
    // One call may do all the work; the loop is bounded all the same.
    (0..4).find_map(|_| checker.advance(table, &gap::single(links), u32::MAX))
}

/// ΔY and Δθ of a chain without its first and last piece, which only change the frame: at the corners of the path, a tick
/// apart at most.
fn ranges(model: &Model<f64>, chain: &Polyline) -> (f64, f64) {
    let ends = 1.0 / chain.pieces() as f64;
    let (mut y, mut theta) = (Range::default(), Range::default());
    for panel in Panels::new(model, chain, &tolerance()) {
        if panel.start() > 0.5 * ends && panel.start() < 1.0 - 0.5 * ends {
            let pose = panel.start_pose();
            y.extend(pose.y);
            theta.extend(pose.theta);
        }
    }
    (y.half_width(), theta.half_width())
}

#[derive(Default)]
struct Range(Option<(f64, f64)>);

impl Range {
    fn extend(&mut self, value: f64) {
        let (low, high) = self.0.unwrap_or((value, value));
        self.0 = Some((low.min(value), high.max(value)));
    }

    fn half_width(&self) -> f64 {
        self.0.map_or(0.0, |(low, high)| 0.5 * (high - low))
    }
}

fn period_us(played: &Played) -> u32 {
    (played.period * 1e6).round() as u32
}

/// One played cycle in steady state, seen from the designed gait's first shape: the joints go from there to where the played
/// cycle begins and back where it ends. The way there and back cancels but for the change of frame, which is what it is for.
fn chain(
    table: &GaitTable,
    played: &Played,
    first: Vector2<f64>,
    map: ServoMap,
    plant: PlantParameters,
) -> Polyline {
    let limits: Limits = played.servos.limits();
    let playback = Playback {
        table,
        period_us: period_us(played),
        maps: [map; 2],
        limits,
        plant,
    };
    let mut vertices = vec![first];
    playback.cycle(1, |point| vertices.push(point.angles.into()));
    vertices.push(first);
    Polyline::new(vertices)
}
