//! Check of the end stops: turns one joint once, slowly, to both ends.

use std::ops::ControlFlow;
use std::time::Duration;

use gait_player::GaitTable;
use link_protocol::{Joint, StopCause};

use super::{Bench, name_of};
use crate::failure::{Failure, Outcome};
use crate::quantity;

/// Fastest turn on the way, rad/s: slow enough to reach for the switch.
const CALMLY: f64 = 0.7;
/// Knots of the swing: a sine needs few.
const KNOTS: usize = 64;
/// A table of so few bytes over a bad link.
const PATIENCE: Duration = Duration::from_secs(30);

impl Bench<'_> {
    /// Swings `joint` to the left and to the right end \[rad, the right one negative\], and reads the operator's answers.
    pub(super) fn swing(&mut self, joint: Joint, ends: [f64; 2]) -> Outcome {
        let [right, left] = ends;
        let table = GaitTable::from_fn(KNOTS, |u| {
            let along = (std::f64::consts::TAU * u).sin();
            let angle = if along > 0.0 {
                left * along
            } else {
                -right * along
            };
            match joint {
                Joint::Front => [angle, 0.0],
                Joint::Back => [0.0, angle],
            }
        })
        .map_err(|error| Failure::tried(&error))?;
        let seconds = std::f64::consts::TAU * left.max(-right) / CALMLY;
        let name = name_of(joint);
        let question = format!(
            "{name}: to {} and to {} within {seconds:.0} s. Ctrl-C stops it where it touches. Is the way free?",
            quantity::angle(left),
            quantity::angle(right)
        );
        self.resuming(|bench| {
            bench.operator.confirm(bench.line, true, &question)?;
            let interrupt = bench.interrupt;
            let go_on = || {
                if interrupt.requested() {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            };
            let robot = &mut bench.line.robot;
            robot.upload(table.bytes(), PATIENCE, |_| go_on())?;
            if let Err(error) = robot.play(1, Duration::from_secs_f64(seconds), false) {
                // A robot that has stopped without the link refuses to play once the link is back.
                let status = robot.status()?;
                let failure = Failure::from(error);
                return Err(match status.cause {
                    StopCause::LinkLost => Failure::LinkLost(failure.to_string()),
                    _ => failure,
                });
            }
            robot.wait_until_finished(|_| go_on())?;
            Ok(())
        })?;
        // The end of a play is a stop.
        self.rest()?;
        if !self.yes(
            &format!("{name}: did it turn all the way without touching anything?"),
            true,
        )? {
            return Err(Failure::Tried(format!(
                "the {name} joint touches before its ends: give nearer ones (`swimmer robot setup` again, or `swimmer robot servo {name} --pulse-range`)"
            )));
        }
        Ok(())
    }
}
