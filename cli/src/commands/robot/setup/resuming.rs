//! Loss of the link during a set-up: the robot is waited for and brought back to its posture, then the step that was interrupted is
//! repeated. Answers that were given are kept.

use std::thread::sleep;

use link_protocol::{Joint, ServoSettings};

use super::super::access::{Access, BEAT, RobotConnection};
use super::super::rest::wait_for_rest;
use super::operator::{LEFT, Operator};
use super::{Bench, JOINTS, TO_TURN, name_of};
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;

/// State of the robot that the set-up has brought about.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Posture {
    /// The pulses are off.
    Off,
    /// The pulses are on; turns since then, the last one last.
    Powered(Vec<(Joint, f64)>),
    /// The link was lost with the pulses on, after these turns. The robot has stopped.
    Lost(Vec<(Joint, f64)>),
}

impl Posture {
    /// A joint has turned to an angle.
    pub(super) fn turned(&mut self, joint: Joint, angle: f64) {
        if let Self::Powered(turns) = self {
            turns.push((joint, angle));
        }
    }

    /// Turns that bring a joint with a dead band back to where it stood: to the last command from the side from which it came.
    fn last_turns(turns: &[(Joint, f64)]) -> Vec<(Joint, f64)> {
        let Some((moved, _)) = turns.last() else {
            return Vec::new();
        };
        let of_joint = turns.iter().filter(|(joint, _)| joint == moved);
        let mut last: Vec<_> = of_joint.rev().take(2).copied().collect();
        last.reverse();
        last
    }
}

impl<'a> Bench<'a> {
    /// Robot and operator at the start, with the pulses off.
    pub(super) fn new(
        access: &'a Access,
        line: &'a mut RobotConnection,
        operator: &'a Operator,
        interrupt: &'a Interrupt,
        before: [ServoSettings; 2],
    ) -> Self {
        Self {
            access,
            line,
            operator,
            interrupt,
            before,
            may_be_changed: false,
            posture: Posture::Off,
        }
    }
}

impl Bench<'_> {
    /// Asks a question, again if the link is lost meanwhile.
    pub(super) fn ask<T>(
        &mut self,
        question: &str,
        read: impl Fn(&str) -> Result<T, String>,
    ) -> Outcome<T> {
        self.resuming(|bench| {
            let armed = bench.posture != Posture::Off;
            bench.operator.ask(bench.line, armed, question, &read)
        })
    }

    /// Goes on only after Enter or y.
    pub(super) fn confirm(&mut self, question: &str) -> Outcome {
        self.resuming(|bench| {
            let armed = bench.posture != Posture::Off;
            bench.operator.confirm(bench.line, armed, question)
        })
    }

    /// Asks a question with two answers; an empty answer is `standard`.
    pub(super) fn yes(&mut self, question: &str, standard: bool) -> Outcome<bool> {
        self.resuming(|bench| {
            let armed = bench.posture != Posture::Off;
            bench.operator.yes(bench.line, armed, question, standard)
        })
    }

    /// Repeats a step until no loss of the link interrupts it.
    pub(super) fn resuming<T>(
        &mut self,
        mut step: impl FnMut(&mut Self) -> Outcome<T>,
    ) -> Outcome<T> {
        loop {
            let result = self.take_posture().and_then(|()| step(self));
            match result {
                Err(Failure::LinkLost(why)) => self.regain(&why)?,
                result => return result,
            }
        }
    }

    /// Turns the pulses on.
    pub(super) fn power_once(&mut self) -> Outcome {
        for joint in JOINTS {
            self.line.robot.trim(joint, 0.0)?;
        }
        self.line.robot.arm(false)?;
        self.operator.wait(self.line, true, TO_TURN)
    }

    /// Turns a joint to an angle.
    pub(super) fn turn_once(&mut self, joint: Joint, angle: f64) -> Outcome {
        self.line.robot.trim(joint, angle)?;
        self.operator.wait(self.line, true, TO_TURN)
    }

    /// Brings the robot back to where it stood before the link was lost, once the operator agrees.
    fn take_posture(&mut self) -> Outcome {
        let Posture::Lost(turns) = &self.posture else {
            return Ok(());
        };
        let turns = turns.clone();
        let last = Posture::last_turns(&turns);
        let motion = match last.last() {
            None => "Both servos go to their centres".to_owned(),
            Some((joint, _)) => format!(
                "Both servos go to their centres, and the {} one turns back to where it was",
                name_of(*joint)
            ),
        };
        let question = format!("{motion}. Is the way free?");
        self.operator.confirm(self.line, false, &question)?;
        self.power_once()?;
        for (joint, angle) in last {
            self.turn_once(joint, angle)?;
        }
        self.posture = Posture::Powered(turns);
        Ok(())
    }

    /// Waits until the robot replies again, and stops it.
    ///
    /// # Errors
    /// [`Failure::Tried`] if the operator leaves, or if another robot replies.
    fn regain(&mut self, why: &str) -> Outcome {
        if let Posture::Powered(turns) = &self.posture {
            self.posture = Posture::Lost(turns.clone());
        }
        self.operator.tell(&format!(
            "The link was lost ({why}). Without it the robot stops by itself. The set-up waits for the robot and keeps the answers so far; q or Ctrl-C leaves."
        ));
        loop {
            if self.operator.leaves() {
                return Err(Failure::Tried(LEFT.to_owned()));
            }
            match self.stop_again() {
                Ok(()) => break,
                Err(failure @ (Failure::BadInput(_) | Failure::AlreadyPrinted(_))) => {
                    return Err(failure);
                }
                Err(_) => sleep(BEAT),
            }
        }
        self.check_maps()?;
        self.operator
            .tell("The robot replies again, and is stopped. The set-up goes on where it was.");
        Ok(())
    }

    fn stop_again(&mut self) -> Outcome {
        self.line.regain(self.access)?;
        self.line.robot.stop()?;
        wait_for_rest(&mut self.line.robot)?;
        Ok(())
    }

    /// Checks that the robot is the one from before: until new maps are sent it has the old ones.
    fn check_maps(&mut self) -> Outcome {
        if self.may_be_changed {
            return Ok(());
        }
        for joint in JOINTS {
            let trimless = |settings: ServoSettings| ServoSettings {
                trim: 0,
                ..settings
            };
            let Ok(present) = self.line.robot.servo(joint) else {
                // The next step finds the link lost again.
                return Ok(());
            };
            if trimless(present) != trimless(self.before[joint.index()]) {
                return Err(Failure::Tried(format!(
                    "the robot that replies has another map of its {} servo than before: is it another robot? Run `swimmer robot setup` again",
                    name_of(joint)
                )));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_comes_back_from_the_side_from_which_it_came() {
        let turns = [
            (Joint::Front, -0.4),
            (Joint::Front, 0.0),
            (Joint::Back, -0.4),
            (Joint::Back, 0.0),
        ];
        assert_eq!(Posture::last_turns(&turns), turns[2..]);
        assert_eq!(Posture::last_turns(&turns[..3]), turns[2..3]);
        assert_eq!(Posture::last_turns(&[]), []);
    }
}
