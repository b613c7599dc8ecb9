//! `swimmer robot setup`: guided set-up of two new servos. Horns off, arm, which servo is which, its sign, centre, dead band and
//! end stops; then everything is stored on the robot and written to a swimmer file.
//!
//! The joints are moved by trims, which the robot ramps like anything else, so that nothing but the last, optional, swing
//! needs a gait. Leaving before the end stops the robot and restores its settings.

mod export;
mod measured;
mod operator;
mod output;
mod readings;
mod resuming;
mod save;
mod swing;
#[cfg(test)]
mod tests;

use std::path::PathBuf;
use std::time::Duration;

use host_link::LinkError;
use link_protocol::{Joint, ServoSettings, StateName};
use swimmer_files::SwimmerFile;

use self::measured::{Measured, end_stops, measured_text};
use self::operator::{Operator, degrees, takes_it};
use self::output::Done;
use self::readings::Readings;
use self::resuming::Posture;
use super::access::{Access, RobotConnection};
use super::motion::MAY_JUMP;
use super::outputs::state;
use super::port::Pace;
use super::rest::wait_for_rest;
use super::servo::name_of;
use crate::arguments::load_swimmer;
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output::{Output, aside};
use crate::quantity;

/// Angle of a joint during its inspection, rad: 25°, within the largest trim.
const SWING: f64 = 0.436_332;
/// From a command to a joint at rest: the way, and a little for the eye.
const TO_TURN: Duration = Duration::from_millis(1_200);
/// Both joints, in the order of their questions.
const JOINTS: [Joint; 2] = [Joint::Front, Joint::Back];

/// Set up new servos at the bench, question by question: which is which, sign, centre, dead band, end stops
///
/// Needs a protractor. The answers come from the standard input, so that a script may give them; q or Ctrl-C leaves, with the
/// robot stopped and everything as it was. If the link stalls or the port goes away, the set-up waits for the robot, and goes on at
/// the same question with the answers so far. At the end the robot has stored its maps, and a swimmer file its `[servo]`.
#[derive(Debug, clap::Args)]
pub(super) struct Setup {
    /// A preset that `swimmer swimmers` lists, or a swimmer file with the links' lengths; left out, the set-up prompts
    /// for it
    #[arg(long, value_name = "SWIMMER")]
    swimmer: Option<String>,
    /// Write the swimmer file with the results; left out, the set-up prompts for it
    #[arg(short, long, value_name = "FILE.toml")]
    output: Option<PathBuf>,
}

/// `swimmer robot setup`.
pub(super) fn run(access: &Access, arguments: &Setup, output: Output) -> Outcome {
    let named = arguments.swimmer.as_deref().map(load_swimmer).transpose()?;
    if let Some(file) = &arguments.output {
        export::may_be_written(file, arguments.swimmer.as_deref())?;
    }
    let interrupt = Interrupt::install_with_a_robot()?;
    let operator = Operator::new(interrupt.clone(), output);
    let mut line = access.connect("swimmer robot setup", Pace::RealTime)?;
    line.stops_on(&interrupt);
    let status = line.robot.status()?;
    if status.state != StateName::Stopped {
        return Err(Failure::Tried(format!(
            "the robot is {}, and was left alone: stop it first (`swimmer robot stop`)",
            state(status.state)
        )));
    }
    if let Some(joint) = status.flags.passive() {
        let joint = name_of(joint);
        return Err(Failure::Tried(format!(
            "the {joint} joint of this robot is passive and gets no pulses, so its servo cannot be set up; if it has one again, run `swimmer robot servo {joint} --driven` first"
        )));
    }
    let before = [
        line.robot.servo(Joint::Front)?,
        line.robot.servo(Joint::Back)?,
    ];
    let mut bench = Bench::new(access, &mut line, &operator, &interrupt, before);
    let done = match bench.everything(arguments, named) {
        Ok(done) => done,
        Err(failure) => {
            bench.leave();
            return Err(failure);
        }
    };
    output.print(&done);
    line.close()
}

/// Robot and operator during a set-up.
struct Bench<'a> {
    access: &'a Access,
    line: &'a mut RobotConnection,
    operator: &'a Operator,
    interrupt: &'a Interrupt,
    /// Servo maps before the set-up; restored if it is left early.
    before: [ServoSettings; 2],
    /// New maps may be on the robot.
    may_be_changed: bool,
    posture: Posture,
}

impl Bench<'_> {
    fn everything(&mut self, arguments: &Setup, named: Option<SwimmerFile>) -> Outcome<Done> {
        self.operator.tell(
            "Setting up both servos. Each answer ends with Enter; q or Ctrl-C leaves: then the robot is stopped and as it was.\n\
             1. Which servo is which",
        );
        self.confirm(
            "Take the horns off both servos, or the links off their horns, so that a turning servo hits nothing. Are they off?",
        )?;
        self.power()?;
        for joint in JOINTS {
            self.which_is(joint)?;
        }
        self.operator.tell("2. Horns");
        self.confirm(
            "Both servos stand at their centres now. Put the horns on so that the links are as straight as the teeth allow (a few degrees off are found below), and screw them on. Are both on?",
        )?;
        self.operator.tell(
            "3. Angles\n\
             Hold a protractor over a joint, seen from above: 0 is straight; where the link's free end lies to the LEFT of the middle link, looking from its back to its front, the angle is positive, to the RIGHT negative. Whole degrees will do.",
        );
        let front = self.measure(Joint::Front)?;
        let back = self.measure(Joint::Back)?;
        self.rest()?;
        self.operator.tell("4. The swimmer");
        let swimmer = self.swimmer(named)?;
        let file = self.save(&swimmer, [&front, &back])?;
        self.operator.tell("5. A look at the result");
        self.verify(&front, &back)?;
        self.written(arguments, file, [front, back])
    }

    /// Turns the pulses on, with both trims at zero.
    fn power(&mut self) -> Outcome {
        self.operator.tell(MAY_JUMP);
        self.posture = Posture::Off;
        let mut is_repeated = false;
        self.resuming(|bench| {
            if std::mem::replace(&mut is_repeated, true) {
                let question = "Both servos go to their centres. Is the way free?";
                bench.operator.confirm(bench.line, false, question)?;
            }
            bench.power_once()
        })?;
        self.posture = Posture::Powered(Vec::new());
        Ok(())
    }

    /// Turns the pulses off.
    fn rest(&mut self) -> Outcome {
        self.posture = Posture::Off;
        self.resuming(|bench| {
            bench.line.robot.stop()?;
            wait_for_rest(&mut bench.line.robot)?;
            Ok(())
        })
    }

    /// Turns a joint to an angle by its present map.
    fn turn(&mut self, joint: Joint, angle: f64) -> Outcome {
        self.resuming(|bench| bench.turn_once(joint, angle))?;
        self.posture.turned(joint, angle);
        Ok(())
    }

    /// Checks that the commanded servo is the one that turns; otherwise has the plugs exchanged.
    fn which_is(&mut self, joint: Joint) -> Outcome {
        let name = name_of(joint);
        loop {
            self.confirm(&format!(
                "The {name} servo turns by 25° and back. Watch both. Ready?"
            ))?;
            self.turn(joint, SWING)?;
            self.turn(joint, 0.0)?;
            let turned =
                self.ask(
                    "Which one turned? [front, back, both, none]",
                    |answer| match answer {
                        "front" | "back" | "both" | "none" => Ok(answer.to_owned()),
                        _ => Err("Answer front, back, both or none.".to_owned()),
                    },
                )?;
            if turned == name {
                return Ok(());
            }
            self.rest()?;
            let remedy = match turned.as_str() {
                "none" => {
                    "no servo turned: has it power of its own, is its ground joined to the board's, and its signal wire at D4 (front) or D5 (back), on a Pico GP16 or GP17?"
                }
                "both" => {
                    "both turned: their signal wires touch; each has a pin of its own, D4 (front) and D5 (back), on a Pico GP16 and GP17"
                }
                _ => {
                    "the plugs are changed over: exchange the signal wires of D4 (front) and D5 (back), on a Pico GP16 and GP17"
                }
            };
            self.confirm(&format!("The pulses are off: {remedy}. Is that done?"))?;
            self.power()?;
        }
    }

    /// Measures one joint: four readings, its dead band and its end stops.
    fn measure(&mut self, joint: Joint) -> Outcome<Measured> {
        let name = name_of(joint);
        let before = ServoSettings {
            trim: 0,
            ..self.before[joint.index()]
        };
        let found = loop {
            let mut read = |number: u8, angle: f64| -> Outcome<f64> {
                self.turn(joint, angle)?;
                let question = format!("{name}, {number} of 4: which angle does the joint show?");
                self.ask(&question, degrees)
            };
            let readings = Readings {
                low: read(1, -SWING)?,
                after_low: read(2, 0.0)?,
                high: read(3, SWING)?,
                after_high: read(4, 0.0)?,
            };
            match readings.evaluate(SWING) {
                Ok(found) => break found,
                Err(problem) => self
                    .operator
                    .tell(&format!("{problem} The four angles are read once more.")),
            }
        };
        let settings = found.settings(&before);
        self.operator.tell(&measured_text(name, &found, &settings));
        let measured = quantity::angle(found.dead_band);
        let dead_band = self.ask(
            &format!("{name}: dead band ±{measured}. Enter takes it; or type another half width, in degrees"),
            |answer| match answer {
                answer if takes_it(answer) => Ok(found.dead_band),
                text => degrees(text).and_then(|angle| {
                    (angle >= 0.0)
                        .then_some(angle)
                        .ok_or_else(|| "A dead band is zero or more.".to_owned())
                }),
            },
        )?;
        let most = f64::from(self.line.robot.info().limits.max_angle);
        let ends = self.ask(
            &format!(
                "{name}: how far may the joint turn before anything touches? Degrees to its left and to its right, as 90 75; Enter: {} to both",
                quantity::angle(most)
            ),
            |answer| end_stops(answer, most),
        )?;
        Ok(Measured {
            settings,
            dead_band,
            ends,
        })
    }

    /// Stops the robot and restores its settings, as far as the link allows.
    fn leave(&mut self) {
        let left = self.put_back();
        let note = match left {
            Ok(()) => "The robot is stopped and as it was.",
            Err(_) => {
                "The robot could not be put back as it was: look at its trims (`swimmer robot trim`)."
            }
        };
        aside(note);
    }

    fn put_back(&mut self) -> Result<(), LinkError> {
        let robot = &mut self.line.robot;
        robot.stop()?;
        wait_for_rest(robot)?;
        for joint in JOINTS {
            let before = self.before[joint.index()];
            if robot.servo(joint)? != before {
                robot.set_servo(joint, before)?;
            }
        }
        Ok(())
    }
}
