//! Robot in the page: the control code of the firmware in a virtual tank.

use std::time::Duration;

use host_link::port::Device as _;
use serde::Deserialize;
use serde_json::json;
use twin::{Twin, TwinConfig, VirtualRobot as _};

use super::{Numbered, Opened, step_of};
use crate::calls::{CallOutput, Lab, Outcome, json, parsed};
use crate::input::SwimmerText;

/// Bytes per second of the line, as for a real robot.
const LINE: f64 = 11_520.0;
/// Largest burst: the capacity of the line in a fifth of a second.
const MOST: usize = 2304;

/// Twin behind a line with the speed of a real one.
struct Robot {
    twin: Twin,
    /// Used capacity of the line since power-on, in bytes.
    used: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Open {
    swimmer: SwimmerText,
    seed: u64,
}

/// Switches on the robot of a swimmer file, with its servos set up.
pub(super) fn open(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Open { swimmer, seed } = parsed(bytes)?;
    let file = swimmer.read()?;
    let twin = Twin::new(TwinConfig::new(&file, seed))
        .map_err(|why| format!("the swimmer `{}` cannot swim: {why}", file.name))?;
    json(&Opened {
        number: lab.kept.keep(Robot { twin, used: 0.0 }),
    })
}

/// Passes bytes and the time since power-on to the robot. Returns the bytes that it sends.
pub(super) fn step(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let (number, now, received) = step_of(bytes)?;
    let robot: &mut Robot = lab.kept.get(number)?;
    robot.twin.advance(now);
    if !received.is_empty() {
        robot.twin.receive(received);
    }
    Ok(CallOutput::Bytes(robot.transmit(now)))
}

impl Robot {
    fn transmit(&mut self, now: Duration) -> Vec<u8> {
        let carried = now.as_secs_f64() * LINE;
        // Capacity that was unused long ago is lost.
        self.used = self.used.max(carried - MOST as f64);
        let mut out = Vec::new();
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between 0 and MOST"
        )]
        let room = (carried - self.used).clamp(0.0, MOST as f64) as usize;
        self.twin.transmit(room, &mut out);
        self.used += out.len() as f64;
        out
    }
}

/// True pose in the tank, as cameras would see it, and the pulses of the servos.
pub(super) fn stands(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Numbered { number } = parsed(bytes)?;
    let robot: &mut Robot = lab.kept.get(number)?;
    let pose = robot.twin.pose();
    json(&json!({
        "now_s": robot.twin.world().now().as_secs_f64(),
        "pose": [pose.x, pose.y, pose.theta],
        "angles": robot.twin.angles(),
        "state": robot.twin.state(),
        "pulses_ns": robot.twin.output().map(|output| output.pulses_ns),
        "cycles": robot.twin.cycle_starts().len(),
    }))
}
