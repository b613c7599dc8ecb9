//! Plays of a link log by the robot's own report: their periods and the starts of their cycles, on the robot's clock.
//!
//! Telemetry reports robot time, completed cycles and the fraction of the cycle about 25 times a second, to the tick of 20 ms. A
//! cycle counts as steady if all its telemetry lies on one line from its first to its last tenth: a pause, a swap or a stop bends
//! the line.

use link_protocol::{Direction, Message, Reply, Request, StateName, Telemetry};

use super::LinkFrame;

/// One play, from its first cycle to the ramp back.
#[derive(Debug, Clone, PartialEq)]
pub struct Play {
    /// Duration of one cycle \[s of the robot's clock\].
    pub period_s: f64,
    /// Start of its first cycle \[s of the robot's clock\].
    pub started_s: f64,
    /// Time of the last telemetry that reports it as playing \[s of the robot's clock\].
    pub ended_s: f64,
    /// Starts of the steady cycles \[s of the robot's clock\].
    pub cycle_starts: Vec<f64>,
    /// Starts of the other cycles \[s of the robot's clock\].
    pub unsteady: Vec<f64>,
    /// Commanded joint angles while it played: the fraction of the cycle, and both angles \[rad\].
    pub setpoints: Vec<(f64, [f64; 2])>,
}

/// Largest distance of a steady cycle's telemetry from its line \[s\]: two ticks.
const SLACK_S: f64 = 0.04;
/// Largest distance of a cycle's first and last telemetry from its ends, as a fraction of the cycle.
const END_FRACTION: f64 = 0.1;

/// The plays of a log, in their order. Telemetry before the period is known is passed over.
pub fn plays(frames: &[LinkFrame]) -> Vec<Play> {
    let mut plays: Vec<Vec<Telemetry>> = Vec::new();
    let mut periods: Vec<f64> = Vec::new();
    let (mut period_s, mut playing, mut requested) = (None, false, false);
    for frame in frames {
        let Some(Ok(message)) = frame.received().map(|received| received.message) else {
            continue;
        };
        match (frame.direction, message) {
            (Direction::ToRobot, Message::Request(Request::Play(play))) => {
                period_s = Some(f64::from(play.period_us) / 1e6);
                requested = true;
            }
            (Direction::ToHost, Message::Reply(Reply::Status(status))) if status.period_us > 0 => {
                period_s = Some(f64::from(status.period_us) / 1e6);
            }
            (Direction::ToHost, Message::Telemetry(setpoints)) => {
                let plays_now = matches!(setpoints.state, StateName::Playing | StateName::Paused);
                let Some(period_s) = period_s.filter(|_| plays_now) else {
                    // On the ramp between a pause and its end nothing is over yet.
                    playing &= plays_now;
                    continue;
                };
                if !playing || requested && setpoints.cycle == 0 && setpoints.phase < 1 << 12 {
                    plays.push(Vec::new());
                    periods.push(period_s);
                }
                (playing, requested) = (true, false);
                if let Some(play) = plays.last_mut() {
                    play.push(setpoints);
                }
            }
            _ => {}
        }
    }
    plays
        .iter()
        .zip(periods)
        .filter_map(|(setpoints, period_s)| play(setpoints, period_s))
        .collect()
}

fn play(setpoints: &[Telemetry], period_s: f64) -> Option<Play> {
    let seconds = |telemetry: &Telemetry| telemetry.robot_us as f64 / 1e6;
    let (first, last) = (setpoints.first()?, setpoints.last()?);
    let mut starts = Vec::new();
    let mut unsteady = Vec::new();
    for cycle in setpoints.chunk_by(|a, b| a.cycle == b.cycle) {
        let fraction = |telemetry: &Telemetry| f64::from(telemetry.phase) / 65_536.0;
        let origins = cycle.iter().map(|t| seconds(t) - fraction(t) * period_s);
        let (low, high) = origins
            .clone()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), origin| {
                (low.min(origin), high.max(origin))
            });
        let ends = cycle.first().zip(cycle.last());
        let whole = ends
            .is_some_and(|(a, b)| fraction(a) < END_FRACTION && fraction(b) > 1.0 - END_FRACTION);
        if whole && high - low < SLACK_S {
            starts.push(origins.clone().sum::<f64>() / cycle.len() as f64);
        } else if cycle.len() > 1 {
            unsteady.extend(origins.clone().next());
        }
    }
    let playing = setpoints.iter().filter(|t| t.state == StateName::Playing);
    let progress = f64::from(first.phase) / 65_536.0 + f64::from(first.cycle);
    Some(Play {
        period_s,
        started_s: seconds(first) - progress * period_s,
        ended_s: seconds(last),
        cycle_starts: starts,
        unsteady,
        setpoints: playing
            .map(|t| {
                let angles = t.setpoint.map(|angle| f64::from(angle) / 1e4);
                (f64::from(t.phase) / 65_536.0, angles)
            })
            .collect(),
    })
}
