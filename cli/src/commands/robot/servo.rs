//! `swimmer robot servo`: the map of one servo between joint angle and pulse, the pulses that its end stops allow, and whether a
//! spring is in its place.

use std::fmt;
use std::str::FromStr;

use gait_player::servo::ServoMap;
use host_link::{LinkError, Robot};
use link_protocol::{Joint, PulseRange, Refusal, ServoSettings};
use serde::Serialize;
use swimmer_files::Quantity;

use super::access::Access;
use super::port::{AnyPort, Pace};
use crate::arguments::positive_angle;
use crate::failure::{Failure, Outcome};
use crate::output::Output;
use crate::quantity::{self, Rows};

/// Show or set the map of a servo between joint angle and pulse; stored on the robot
///
/// pulse = centre + sign · (angle + trim) / slope. `swimmer robot setup` finds all of it at the bench. Set only while the
/// robot is stopped.
#[derive(Debug, clap::Args)]
pub(super) struct Servo {
    /// Joint of the servo
    #[arg(value_enum, value_name = "JOINT")]
    joint: JointName,
    /// Sign of the servo: the joint turns to its left as the pulse gets longer (+) or shorter (-)
    #[arg(long, value_enum, value_name = "+|-", allow_hyphen_values = true)]
    sign: Option<Sign>,
    /// Pulse of the straight joint, µs
    #[arg(long, value_name = "US", value_parser = centre_us)]
    centre: Option<f64>,
    /// Slope: the turn of the joint per µs of pulse, as 1.57deg, or bare in radians
    #[arg(long, value_name = "ANGLE", value_parser = positive_angle)]
    slope: Option<f64>,
    /// Shortest and longest pulse that its end stops allow, µs, as 1400,1600: gaits beyond are refused
    #[arg(long, value_name = "SHORTEST,LONGEST", value_parser = range_us)]
    pulse_range: Option<RangeUs>,
    /// A spring holds this joint in place of a servo: the robot sends it no pulses, whatever it plays
    #[arg(long, conflicts_with = "driven")]
    passive: bool,
    /// This joint has a servo again and no spring; the robot must be on its USB cable, or its bench jumper just closed
    #[arg(long)]
    driven: bool,
}

impl Servo {
    /// Passive joint of the robot with these arguments, given the present one.
    fn passive(&self, held: Option<Joint>) -> Option<Joint> {
        let joint = Joint::from(self.joint);
        if self.passive {
            Some(joint)
        } else {
            held.filter(|held| !(self.driven && *held == joint))
        }
    }
}

/// A joint on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum JointName {
    /// φ₁
    Front,
    /// φ₂
    Back,
}

/// Direction in which a servo turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Sign {
    #[value(name = "+")]
    Plus,
    #[value(name = "-")]
    Minus,
}

/// Shortest and longest pulse \[µs\].
#[derive(Debug, Clone, Copy, PartialEq)]
struct RangeUs([f64; 2]);

impl From<JointName> for Joint {
    fn from(name: JointName) -> Self {
        match name {
            JointName::Front => Self::Front,
            JointName::Back => Self::Back,
        }
    }
}

/// Name of a joint.
pub(super) fn name_of(joint: Joint) -> &'static str {
    match joint {
        Joint::Front => "front",
        Joint::Back => "back",
    }
}

/// The pulse of a straight joint on the command line, in microseconds.
pub(crate) fn centre_us(text: &str) -> Result<f64, String> {
    let number = text.trim().trim_end_matches("us").trim_end_matches("µs");
    let us = f64::from_str(number).ok().filter(|us| us.is_finite());
    let us = us.ok_or("write a servo's pulse in µs, as 1500")?;
    Quantity::Pulse.checked(us).map_err(|slip| slip.to_string())
}

/// A pulse on the command line, in microseconds.
pub(crate) fn pulse_us(text: &str) -> Result<f64, String> {
    f64::from_str(text.trim().trim_end_matches("us").trim_end_matches("µs"))
        .ok()
        .filter(|us| (500.0..=2500.0).contains(us))
        .ok_or_else(|| "write a servo's pulse in µs, as 1500".to_owned())
}

fn range_us(text: &str) -> Result<RangeUs, String> {
    let advice = "write the shortest and the longest pulse in µs, as 1400,1600";
    let (shortest, longest) = text.split_once(',').ok_or(advice)?;
    let range = [pulse_us(shortest)?, pulse_us(longest)?];
    (range[0] < range[1])
        .then_some(RangeUs(range))
        .ok_or_else(|| advice.to_owned())
}

/// Whole nanoseconds of a pulse that was checked.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // some ms
pub(crate) fn nanoseconds(us: f64) -> u32 {
    (us * 1e3).round() as u32
}

/// Everything a servo was set up with.
#[derive(Debug, Serialize)]
pub(super) struct Set {
    pub(super) joint: &'static str,
    pub(super) sign: char,
    pub(super) centre_us: f64,
    pub(super) slope_rad_per_us: f64,
    pub(super) trim_rad: f64,
    pub(super) pulse_range_us: [f64; 2],
    /// Joint angles at the ends of that range, the smaller first.
    pub(super) reach_rad: [f64; 2],
    /// A spring is in the place of this servo.
    pub(super) passive: bool,
}

impl Set {
    /// Asks the robot for the settings of its servo.
    ///
    /// # Errors
    /// The link's.
    pub(super) fn read(robot: &mut Robot<AnyPort>, joint: Joint) -> Result<Self, LinkError> {
        let set = Self::new(joint, &robot.servo(joint)?, robot.pulse_range(joint)?);
        Ok(Self {
            passive: robot.status()?.flags.passive() == Some(joint),
            ..set
        })
    }

    fn new(joint: Joint, settings: &ServoSettings, range: PulseRange) -> Self {
        let map = ServoMap::from(*settings);
        let ends = [range.shortest_ns, range.longest_ns];
        let mut reach_rad = ends.map(|pulse_ns| f64::from(map.angle(pulse_ns)));
        reach_rad.sort_by(f64::total_cmp);
        Self {
            joint: name_of(joint),
            sign: if settings.reversed { '-' } else { '+' },
            centre_us: f64::from(settings.centre_ns) / 1e3,
            slope_rad_per_us: decimal(settings.slope_rad_per_us),
            trim_rad: decimal(map.trim),
            pulse_range_us: ends.map(|ns| f64::from(ns) / 1e3),
            reach_rad,
            passive: false,
        }
    }

    /// The command that sets it up so again.
    pub(super) fn command(&self) -> String {
        let [shortest, longest] = self.pulse_range_us;
        format!(
            "swimmer robot servo {} --sign {} --centre {} --slope {} --pulse-range {shortest},{longest}{}",
            self.joint,
            self.sign,
            self.centre_us,
            self.slope_rad_per_us,
            if self.passive { " --passive" } else { "" }
        )
    }
}

/// The decimal number that was meant by one in single precision.
fn decimal(single: f32) -> f64 {
    f64::from_str(&single.to_string()).unwrap_or_else(|_| single.into())
}

impl fmt::Display for Set {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [shortest, longest] = self.pulse_range_us;
        let [right, left] = self.reach_rad.map(quantity::angle);
        let mut rows = Rows::default();
        rows.row("joint", self.joint)
            .row("sign", self.sign.to_string())
            .row("centre", format!("{} µs", self.centre_us))
            .row(
                "slope",
                format!(
                    "{} a µs ({} rad)",
                    quantity::angle(self.slope_rad_per_us),
                    self.slope_rad_per_us
                ),
            )
            .row("trim", quantity::angle(self.trim_rad))
            .row(
                "pulses",
                format!("{shortest} to {longest} µs: {right} to {left}"),
            );
        if self.passive {
            rows.row("passive", "a spring is in its place: no pulses");
        }
        write!(f, "{rows}")
    }
}

/// `swimmer robot servo`: sets what was named, then shows what the robot has.
pub(super) fn run(access: &Access, arguments: &Servo, output: Output) -> Outcome {
    let joint = Joint::from(arguments.joint);
    let mut line = access.connect("swimmer robot servo", Pace::AsFastAsPossible)?;
    let robot = &mut line.robot;
    let before = robot.servo(joint)?;
    #[allow(clippy::cast_possible_truncation)] // the wire's precision
    let wanted = ServoSettings {
        centre_ns: arguments.centre.map_or(before.centre_ns, nanoseconds),
        slope_rad_per_us: arguments
            .slope
            .map_or(before.slope_rad_per_us, |slope| slope as f32),
        reversed: arguments
            .sign
            .map_or(before.reversed, |sign| sign == Sign::Minus),
        trim: before.trim,
    };
    let range = arguments
        .pulse_range
        .map(|RangeUs([shortest, longest])| PulseRange {
            shortest_ns: nanoseconds(shortest),
            longest_ns: nanoseconds(longest),
        });
    if wanted != before {
        set(robot, joint, wanted)?;
    }
    if let Some(range) = range {
        set_range(robot, joint, range)?;
    }
    let held = robot.status()?.flags.passive();
    let passive = arguments.passive(held);
    if passive != held {
        robot.set_passive(passive)?;
    }
    if wanted != before || range.is_some() || passive != held {
        line.stored("the servo's map is")?;
    }
    let set = Set::read(&mut line.robot, joint)?;
    output.print(&set);
    line.close()
}

/// Sets a map.
///
/// # Errors
/// The link's, and the robot's refusal with what it means at the bench.
pub(super) fn set(robot: &mut Robot<AnyPort>, joint: Joint, wanted: ServoSettings) -> Outcome {
    let set = robot.set_servo(joint, wanted);
    set.map_err(|error| refused(error, joint, &wanted))
}

/// Sets the pulses that the end stops allow.
///
/// # Errors
/// As [`set`].
pub(super) fn set_range(robot: &mut Robot<AnyPort>, joint: Joint, range: PulseRange) -> Outcome {
    robot
        .set_pulse_range(joint, range)
        .map_err(|error| match error {
            LinkError::Refused {
                refusal: Refusal::BadValue { .. },
                ..
            } => Failure::Tried(format!(
                "the robot refuses pulses from {} to {} µs for the {} servo: the range must hold its straight joint and lie within the robot's own (`swimmer robot info`)",
                f64::from(range.shortest_ns) / 1e3,
                f64::from(range.longest_ns) / 1e3,
                name_of(joint)
            )),
            error => error.into(),
        })
}

/// The robot names what it refuses by its place; at the bench it has a remedy.
fn refused(error: LinkError, joint: Joint, wanted: &ServoSettings) -> Failure {
    let LinkError::Refused {
        refusal: Refusal::BadValue { field },
        ..
    } = error
    else {
        return error.into();
    };
    let joint = name_of(joint);
    match field {
        0 => Failure::Tried(format!(
            "the robot refuses {} µs as the {joint} servo's centre: it lies more than 20 µs (about 31°) from that as built; set its horn a tooth (about 14°) or more towards straight, and measure again",
            f64::from(wanted.centre_ns) / 1e3
        )),
        1 => Failure::Tried(format!(
            "the robot refuses {} rad a µs as the {joint} servo's slope: it differs by more than a tenth from that as built; is this servo of another kind? Then the firmware must be built for it",
            wanted.slope_rad_per_us
        )),
        _ => error.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pulses_and_ranges_are_read() {
        assert_eq!(pulse_us("1500"), Ok(1500.0));
        assert_eq!(pulse_us("1512.5us"), Ok(1512.5));
        assert_eq!(range_us("1400,1600"), Ok(RangeUs([1400.0, 1600.0])));
        for text in [
            "",
            "1.5",
            "1600,1400",
            "1400",
            "1400,",
            "nan,1600",
            "1400,9000",
        ] {
            assert!(range_us(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_mirrored_servo_reaches_the_same_angles_and_is_set_up_again_by_its_command() {
        let settings = ServoSettings {
            centre_ns: 1_512_000,
            slope_rad_per_us: 0.0274,
            reversed: true,
            trim: 0,
        };
        let range = PulseRange {
            shortest_ns: 1_400_000,
            longest_ns: 1_600_000,
        };
        let set = Set::new(Joint::Front, &settings, range);
        let [right, left] = set.reach_rad;
        // 88 µs above the centre turn it to its right, 112 µs below to its left.
        assert!((right + 88.0 * 0.0274).abs() < 1e-5, "{right}");
        assert!((left - 112.0 * 0.0274).abs() < 1e-5, "{left}");
        assert_eq!(
            set.command(),
            "swimmer robot servo front --sign - --centre 1512 --slope 0.0274 --pulse-range 1400,1600"
        );
    }
}
