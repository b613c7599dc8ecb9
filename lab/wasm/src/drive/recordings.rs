//! Recordings: the plays of a link log with the joints and the robot's own pose, for a replay on the page.

use std::path::Path;

use link_protocol::{Direction, Message, StateName, Telemetry};
use serde::Serialize;
use swimmer_files::{LinkFrame, parse_link_log};

use crate::calls::{Lab, Outcome, json};

/// One play of a log.
#[derive(Serialize)]
struct Recording {
    /// Start of the soft start \[s since 1970, on the host's clock\].
    began_s: f64,
    /// Completed cycles.
    cycles: u32,
    /// `true` if the log holds the telemetry of rest after the play.
    ended: bool,
    /// Pose at the end of the last cycle, by the robot's own model; the ramp to rest moves the swimmer on.
    end: [f32; 3],
    /// From the first cycle on, where that model begins, to rest.
    samples: Vec<Sample>,
}

/// Telemetry at one time.
#[derive(Serialize)]
struct Sample {
    /// Time since the first sample \[s of the robot's clock\].
    t_s: f64,
    /// Commanded joint angles.
    phi_rad: [f64; 2],
    /// Pose by the robot's own model \[m, m, rad\].
    pose: [f32; 3],
}

/// Reads the plays of a link log, in their order. The argument is the MCAP file.
pub(super) fn read(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let log = parse_link_log(bytes, Path::new("the recording")).map_err(|why| why.to_string())?;
    json(&recordings(&log.frames))
}

fn recordings(frames: &[LinkFrame]) -> Vec<Recording> {
    let telemetry = frames.iter().filter_map(|frame| {
        let received = frame.received()?.message;
        match (frame.direction, received) {
            (Direction::ToHost, Ok(Message::Telemetry(telemetry))) => {
                Some((frame.host_time_ns, telemetry))
            }
            _ => None,
        }
    });
    let mut plays: Vec<Recording> = Vec::new();
    let mut first_us = 0;
    let mut is_open = false;
    for (host_time_ns, telemetry) in telemetry {
        let moves = matches!(
            telemetry.state,
            StateName::Starting | StateName::Playing | StateName::Paused | StateName::Stopping
        );
        if !moves {
            if let Some(play) = plays.last_mut().filter(|_| is_open) {
                play.ended = true;
            }
            is_open = false;
            continue;
        }
        if !is_open {
            plays.push(Recording {
                began_s: host_time_ns as f64 / 1e9,
                cycles: 0,
                ended: false,
                end: [0.0; 3],
                samples: Vec::new(),
            });
        }
        is_open = true;
        let Some(play) = plays.last_mut() else {
            continue;
        };
        if play.samples.is_empty() {
            // During the soft start the pose still counts from the play before.
            if telemetry.state == StateName::Starting {
                continue;
            }
            first_us = telemetry.robot_us;
        }
        let sample = sample(&telemetry, first_us);
        if telemetry.state != StateName::Stopping {
            play.end = sample.pose;
        }
        play.cycles = play.cycles.max(telemetry.cycle);
        play.samples.push(sample);
    }
    plays.retain(|play| !play.samples.is_empty());
    plays
}

fn sample(telemetry: &Telemetry, first_us: u64) -> Sample {
    let pose = telemetry.pose;
    Sample {
        t_s: telemetry.robot_us.saturating_sub(first_us) as f64 / 1e6,
        // Divided, an angle has no more digits than the wire gives it.
        phi_rad: telemetry.setpoint.map(|units| f64::from(units) / 1e4),
        pose: [pose.x, pose.y, pose.theta],
    }
}
