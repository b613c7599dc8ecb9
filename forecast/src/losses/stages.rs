//! The ways of the joints through one cycle, one imperfection after the other.

use gait_player::GaitTable;
use gait_player::playback::{Playback, PlayedPoint};
use gait_player::servo::ServoMap;
use gait_player::servo::plant::PlantParameters;
use gait_player::table::check::Checker;
use nalgebra::Vector2;
use swimmer_files::AnyGait;
use swimmer_model::{Gait, InvalidSamples, Links, Model, Panels, Stroke, swim};

use super::{ForecastError, Motion, Played, Servos, Verdict, gap, tolerance};
use crate::path::Polyline;
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
    pub(super) table: GaitTable,
    /// Interpolated, rounded.
    curves: [AnyGait; 2],
    /// Ticked, pulsed, rate-limited, played.
    pub(super) chains: [Polyline; 4],
}

impl Ways {
    pub(super) fn new<G, C, P>(
        gait: &G,
        played: &Played,
        motion: &Motion<C, P>,
    ) -> Result<Self, ForecastError>
    where
        G: Gait<f64> + ?Sized,
        C: Fn(AnyGait) -> Result<AnyGait, ForecastError>,
        P: Fn(&[PlayedPoint]) -> Result<Vec<Vector2<f64>>, ForecastError>,
    {
        let knots = played.knots;
        let table = table(gait, knots)?;
        let knot = knot(gait, knots);
        let designed = |index| knot(index as f64 / knots as f64);
        let units = |index| Vector2::from(table.knot(index).map(|unit| f64::from(unit) * 1e-4));
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
        let chain = |map, plant| {
            let path = path(&table, played, map, plant);
            (motion.of_path)(&path).map(|shapes| chain(first, shapes))
        };
        let curve = |curve: AnyGait| (motion.of_curve)(curve);
        Ok(Self {
            curves: [
                curve(through((0..knots).map(designed))?)?,
                curve(through((0..knots).map(units))?)?,
            ],
            chains: [
                chain(FINE, PlantParameters::IDEAL)?,
                chain(map, pulsed)?,
                chain(map, limited)?,
                chain(map, plant)?,
            ],
            table,
        })
    }

    /// All stages swum, the designed gait first.
    pub(super) fn swum<G: Gait<f64> + ?Sized>(
        &self,
        model: &Model<f64>,
        gait: &G,
    ) -> Vec<Stroke<f64>> {
        let mut swum = vec![swim(model, gait, &tolerance())];
        let curves = self.curves.iter();
        swum.extend(curves.map(|curve| swim(model, curve, &tolerance())));
        swum.extend(self.chains.iter().map(|chain| {
            let [delta_y, delta_theta] = ranges(model, chain);
            Stroke {
                delta_y,
                delta_theta,
                ..swim(model, chain, &tolerance())
            }
        }));
        swum
    }
}

/// The curve that a table makes of its knots \[rad\], but for its single precision: where knots are even a sampled gait has its slopes.
pub(super) fn through(
    knots: impl Iterator<Item = Vector2<f64>>,
) -> Result<AnyGait, InvalidSamples> {
    let phi: Vec<_> = knots.collect();
    let u: Vec<_> = (0..phi.len())
        .map(|knot| knot as f64 / phi.len() as f64)
        .collect();
    AnyGait::from_samples(&u, &phi, &[])
}

/// Result of the robot's own checks of a table that is played by these servos.
pub(crate) fn verdict(
    table: &GaitTable,
    links: &Links<f64>,
    servos: &Servos,
    period_us: u32,
) -> Verdict {
    let limits = servos.limits();
    let mut checker = Checker::new();
    // One call may do all the work; the loop is bounded all the same.
    let facts = (0..4).find_map(|_| checker.advance(table, &gap::single(links), u32::MAX));
    let Some(facts) = facts else {
        return Verdict {
            refused: Some("the check of the table did not end".to_owned()),
            min_period: f64::NAN,
        };
    };
    let allowed = facts
        .allow(&limits)
        .and_then(|()| facts.allow_period(&limits, period_us));
    Verdict {
        refused: allowed.err().map(|refusal| refusal.to_string()),
        min_period: f64::from(facts.min_period_us(&limits)) / 1e6,
    }
}

/// ΔY and Δθ of a chain without its first and last piece, which only change the frame: at the corners of the path, a tick
/// apart at most.
fn ranges(model: &Model<f64>, chain: &Polyline) -> [f64; 2] {
    let end = 0.5 / chain.pieces() as f64;
    let panels = Panels::new(model, chain, &tolerance());
    let inner = panels.filter(|panel| panel.start() > end && panel.start() < 1.0 - end);
    let places = inner.map(|panel| [panel.start_pose().y, panel.start_pose().theta]);
    let ranges = places.fold([[f64::INFINITY, f64::NEG_INFINITY]; 2], |ranges, place| {
        [0, 1].map(|k| [ranges[k][0].min(place[k]), ranges[k][1].max(place[k])])
    });
    ranges.map(|[low, high]| (0.5 * (high - low)).max(0.0))
}

/// Path of the servos through one played cycle in steady state.
fn path(
    table: &GaitTable,
    played: &Played,
    map: ServoMap,
    plant: PlantParameters,
) -> Vec<PlayedPoint> {
    let playback = Playback {
        table,
        period_us: played.period_us(),
        maps: [map; 2],
        limits: played.servos.limits(),
        plant,
    };
    let mut path = Vec::new();
    playback.cycle(1, |point| path.push(point));
    path
}

/// One played cycle seen from the designed gait's first shape: the joints go from there to where the played cycle begins and back
/// where it ends. The way there and back cancels but for the change of frame, which is what it is for.
fn chain(first: Vector2<f64>, shapes: Vec<Vector2<f64>>) -> Polyline {
    let ends = std::iter::once(first);
    Polyline::new(ends.clone().chain(shapes).chain(ends))
}
