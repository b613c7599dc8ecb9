//! Tables that the robot is sent for a playlist, and the path that its servos take through all of them.
//!
//! Gaits of a playlist start and end at one shape. There each has a corner, which a table would round, each in its own way; so
//! the joints stand at that shape for eight intervals of the table, and every table has it as its first knot, to the last digit.
//! The robot stores two tables and checks the next while one plays: a table that would end before that check takes in cycles of
//! the following one.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "saturates"
)]

use gait_player::GaitTable;
use gait_player::TICK_US;
use gait_player::playback::{Playback, PlayedLeg, PlayedPoint, setpoints};
use gait_player::table::MAX_KNOTS;
use gait_player::table::TableError;
use nalgebra::Vector2;
use swimmer_model::{Gait, GaitPoint, Links, Model, Pose, Tolerance, swim};

use crate::losses::Servos;
use crate::path::Polyline;

/// Share of a cycle at its start, and again at its end, in which the joints stand.
const STAND: f64 = 4.0 / MAX_KNOTS as f64;
/// Shortest duration of a table that another one follows \[s\]: sending and checking that one takes five at the robot's own
/// speed.
pub const SHORTEST_S: f64 = 6.0;

/// Cycles of one gait: a step of a playlist.
#[derive(Debug, Clone)]
pub struct Repeated<G> {
    /// One cycle; all of a playlist start and end at one shape.
    pub gait: G,
    /// Cycles, at least one.
    pub cycles: u32,
    /// Duration of a cycle \[s\], the standing at its ends included.
    pub period: f64,
}

/// A table of a playlist, played for some cycles.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaylistTable {
    /// The table.
    pub table: GaitTable,
    /// Cycles.
    pub cycles: u32,
    /// Duration of a cycle \[µs\].
    pub period_us: u32,
    /// The step that its first cycle belongs to, from 0.
    pub step: usize,
}

impl PlaylistTable {
    /// Duration of all its cycles \[s\].
    pub fn duration(&self) -> f64 {
        f64::from(self.cycles) * f64::from(self.period_us) / 1e6
    }
}

/// Largest change of an angle over an interval due to rounding to the table's units, by the cubic's weights \[rad\].
const ROUNDING: f64 = 1.3e-4;
/// Overshoot of the rates at a rounded corner, over the robot's tolerance above its rate limit.
const SWING: f64 = 1.0013 / 1.005;

/// The shortest period of a step \[s\] of which the servos can play the gait in `shortest`: with the standing, and with the time
/// that the table's rounding takes of servos of at most `max_rate` \[rad/s\]; in whole ticks, so that every cycle has the same
/// set-points.
///
/// ```
/// // The servos need 2.75 s; 1/64 of the period is spent standing.
/// let period = forecast::playlist::step_period(2.75, 3.5);
/// assert_eq!(period, 2.82);
/// ```
pub fn step_period(shortest: f64, max_rate: f64) -> f64 {
    let tick = f64::from(TICK_US) / 1e6;
    let standing = shortest / (1.0 - 2.0 * STAND);
    let rounded = standing * SWING + ROUNDING * MAX_KNOTS as f64 / max_rate;
    // Divided last: the quotient of whole microseconds prints with no more digits than it has.
    (standing.max(rounded) / tick - 1e-9).ceil() * f64::from(TICK_US) / 1e6
}

/// The tables of a playlist, in order.
///
/// # Errors
/// [`TableError`]: an angle that does not fit.
///
/// ```
/// use forecast::playlist::{Repeated, tables};
/// use swimmer_files::AnyGait;
///
/// let step = |cycles| Repeated { gait: AnyGait::circle(1.0), cycles, period: 4.0 };
/// let sent = tables(&[step(10), step(1), step(3)]).unwrap();
/// // A single cycle would be over too soon: one of the next step is added to it.
/// let cycles: Vec<_> = sent.iter().map(|table| (table.cycles, table.period_us)).collect();
/// assert_eq!(cycles, [(10, 4_000_000), (1, 8_000_000), (2, 4_000_000)]);
/// assert_eq!(sent[0].table.knot(0), sent[1].table.knot(0));
/// ```
pub fn tables<G: Gait<f64>>(steps: &[Repeated<G>]) -> Result<Vec<PlaylistTable>, TableError> {
    let mut tables = Vec::new();
    let shape = steps
        .first()
        .map_or_else(Vector2::zeros, |step| step.gait.at(0.0).phi);
    // Parts that are too short for a table of their own.
    let mut open: Vec<Part<'_, G>> = Vec::new();
    for (number, step) in steps.iter().enumerate() {
        let mut left = step.cycles;
        let missing = SHORTEST_S - duration(&open);
        if !open.is_empty() {
            // Whole cycles that last at least so long, at least one.
            let taken = ((missing / step.period).ceil() as u32).max(1).min(left);
            open.push((step, number, taken));
            left -= taken;
            if duration(&open) >= SHORTEST_S {
                tables.push(table_of(shape, &open, 1)?);
                open.clear();
            }
        }
        let last = number + 1 == steps.len();
        if left > 0 && (last || f64::from(left) * step.period >= SHORTEST_S) {
            tables.push(table_of(shape, &[(step, number, 1)], left)?);
        } else if left > 0 {
            open.push((step, number, left));
        }
    }
    if !open.is_empty() {
        tables.push(table_of(shape, &open, 1)?);
    }
    Ok(tables)
}

/// Cycles of one step in a table: of which, its number, and how many.
type Part<'a, G> = (&'a Repeated<G>, usize, u32);

fn duration<G>(parts: &[Part<'_, G>]) -> f64 {
    let of = |(step, _, cycles): &Part<'_, G>| f64::from(*cycles) * step.period;
    parts.iter().map(of).sum()
}

fn table_of<G: Gait<f64>>(
    shape: Vector2<f64>,
    parts: &[Part<'_, G>],
    cycles: u32,
) -> Result<PlaylistTable, TableError> {
    let whole = duration(parts);
    let mut ends = Vec::new();
    let mut time = 0.0;
    for (step, _, count) in parts {
        for _ in 0..*count {
            let start = time;
            time += step.period;
            ends.push((start / whole, time / whole, &step.gait));
        }
    }
    Ok(PlaylistTable {
        table: crate::table(
            &Strung {
                shape,
                cycles: ends,
            },
            MAX_KNOTS,
        )?,
        cycles,
        period_us: (whole * 1e6).round() as u32,
        step: parts.first().map_or(0, |(_, number, _)| *number),
    })
}

/// Cycles one after the other, each with its share of the time, the joints standing at both ends of the whole.
struct Strung<'a, G> {
    /// Common first and last shape; the gaits may name it with other last digits.
    shape: Vector2<f64>,
    cycles: Vec<(f64, f64, &'a G)>,
}

impl<G: Gait<f64>> Strung<'_, G> {
    /// The share of the moving time that has gone by.
    fn moved(u: f64) -> f64 {
        ((u - STAND) / (1.0 - 2.0 * STAND)).clamp(0.0, 1.0)
    }

    /// The piece of this number between those of standing: its cycle and its number there.
    fn piece(&self, mut i: usize) -> Option<(f64, f64, &G, usize)> {
        for (start, end, gait) in &self.cycles {
            if i < gait.pieces() {
                return Some((*start, *end, gait, i));
            }
            i -= gait.pieces();
        }
        None
    }
}

impl<G: Gait<f64>> Gait<f64> for Strung<'_, G> {
    fn at(&self, u: f64) -> GaitPoint<f64> {
        let moved = Self::moved(u - u.floor());
        let mut cycles = self.cycles.iter();
        let held = cycles.find(|(_, end, _)| 0.0 < moved && moved < *end);
        let Some((start, end, gait)) = held else {
            return GaitPoint {
                phi: self.shape,
                rate: Vector2::zeros(),
            };
        };
        let point = gait.at(((moved - start) / (end - start)).clamp(0.0, 1.0));
        GaitPoint {
            rate: point.rate / ((end - start) * (1.0 - 2.0 * STAND)),
            ..point
        }
    }

    fn pieces(&self) -> usize {
        let moving: usize = self.cycles.iter().map(|(_, _, gait)| gait.pieces()).sum();
        moving + 2
    }

    fn piece_end(&self, i: usize) -> f64 {
        match (i, i.checked_sub(1).and_then(|i| self.piece(i))) {
            (0, _) => STAND,
            (_, Some((start, end, gait, piece))) => {
                let moved = start + (end - start) * gait.piece_end(piece);
                STAND + moved * (1.0 - 2.0 * STAND)
            }
            (_, None) => 1.0,
        }
    }

    fn corner_at_end(&self, i: usize) -> bool {
        match (i, i.checked_sub(1).and_then(|i| self.piece(i))) {
            (0, _) => true,
            (_, Some((_, _, gait, piece))) => {
                piece + 1 == gait.pieces() || gait.corner_at_end(piece)
            }
            (_, None) => false,
        }
    }
}

/// The path that the servos' joints take from straight through all tables to straight again: the robot's own set-points through
/// the servo's own arithmetic.
pub fn played(tables: &[PlaylistTable], servos: &Servos) -> Polyline {
    let mut vertices = vec![Vector2::zeros()];
    vertices.extend(
        timed(tables, servos, [0.0; 2])
            .iter()
            .map(|point| Vector2::from(point.angles)),
    );
    Polyline::new(vertices)
}

/// The same path with its times, from joints at rest at these angles \[rad\] (within their dead band of straight): vertices from
/// the first set-point of the soft start to the next rest.
pub fn timed(tables: &[PlaylistTable], servos: &Servos, rest: [f64; 2]) -> Vec<PlayedPoint> {
    let legs: Vec<PlayedLeg<'_>> = tables
        .iter()
        .map(|table| PlayedLeg {
            table: &table.table,
            cycles: table.cycles,
            period_us: table.period_us,
        })
        .collect();
    let mut commanded = Vec::new();
    setpoints(&legs, &servos.limits(), |setpoint| commanded.push(setpoint));
    let mut points = Vec::new();
    if let Some(first) = legs.first() {
        let playback = Playback {
            table: first.table,
            period_us: first.period_us,
            maps: [servos.map(); 2],
            limits: servos.limits(),
            plant: servos.plant(),
        };
        playback.through(rest, commanded, |point| points.push(point));
    }
    points
}

/// The same path over one cycle in steady state, from the first knot on.
pub fn steady_cycle(table: &GaitTable, period_us: u32, servos: &Servos) -> Vec<PlayedPoint> {
    let playback = Playback {
        table,
        period_us,
        maps: [servos.map(); 2],
        limits: servos.limits(),
        plant: servos.plant(),
    };
    let mut points = Vec::new();
    playback.cycle(1, |point| points.push(point));
    points
}

/// Net pose of a path of the joints, in the frame of the middle link at its start.
pub fn leads_to<G: Gait<f64> + ?Sized>(model: &Model<f64>, way: &G) -> Pose<f64> {
    let stroke = swim(model, way, &Tolerance::default());
    Pose::new(
        stroke.displacement.x,
        stroke.displacement.y,
        stroke.rotation,
    )
}

/// Step and reason of the first table of a playlist that a robot would refuse. Returns `None` if it plays all of them.
pub fn refused(
    tables: &[PlaylistTable],
    servos: &Servos,
    links: &Links<f64>,
) -> Option<(usize, String)> {
    tables.iter().find_map(|sent| {
        let verdict = crate::losses::verdict(&sent.table, links, servos, sent.period_us);
        Some((sent.step, verdict.refused?))
    })
}
