//! `swimmer robot trim`: the servos' trims, named on the command line or nudged at the bench with keys.
//!
//! At the bench the operator powers the servos (they hold neutral), nudges until the joints are straight, and saves. Each nudge
//! goes to the robot at once; it stores what it has when the pulses are off again. Leaving without saving puts the trims back.

mod nudging;

use std::io::{self, IsTerminal as _};
use std::str::FromStr;
use std::time::Duration;

use crossterm::event::{self, Event};
use host_link::Port as _;
use host_link::robot::SILENCE_REPORTED;
use link_protocol::{ANGLE_UNIT_RAD, Joint, StateName};
use ratatui::DefaultTerminal;

use self::nudging::{Nudging, Wish};
use super::Trim;
use super::access::{Access, RobotConnection};
use super::outputs::Trims;
use super::port::Pace;
use super::rest::wait_for_rest;
use super::watch::no_terminal;
use crate::arguments::angle;
use crate::failure::Outcome;
use crate::interrupt::Interrupt;
use crate::output::Output;

/// Beyond this a servo horn sits on the wrong tooth, or degrees were meant and radians written.
const LARGEST_RAD: f64 = 0.524;

/// A trim on the command line, in radians.
pub(super) fn angle_of_trim(text: &str) -> Result<f64, String> {
    // A trim is held to a narrower range than other bare angles.
    let bare = f64::from_str(text.trim()).ok();
    let bare = bare.filter(|bare| bare.is_finite());
    let angle = bare.map_or_else(|| angle(text), Ok)?;
    if angle.abs() <= LARGEST_RAD {
        return Ok(angle);
    }
    // Only a number without its unit may have been meant in degrees.
    let meant = match bare {
        Some(degrees) if degrees.to_radians().abs() <= LARGEST_RAD => {
            format!("write degrees as {degrees}deg, or ")
        }
        _ => String::new(),
    };
    Err(format!(
        "a trim of {:.1}° is beyond ±30°: {meant}set the servo's horn anew",
        angle.to_degrees()
    ))
}

/// `swimmer robot trim`: sets what was named, then shows both; on a terminal, with nothing named, nudges.
pub(super) fn trim(access: &Access, arguments: &Trim, output: Output) -> Outcome {
    let named = [
        (Joint::Front, arguments.front),
        (Joint::Back, arguments.back),
    ];
    let nothing_named = named.iter().all(|(_, angle)| angle.is_none());
    let at_a_terminal = io::stdin().is_terminal() && io::stdout().is_terminal();
    if nothing_named && at_a_terminal && !output.json {
        return nudge(access, output);
    }
    let mut line = access.connect("swimmer robot trim", Pace::AsFastAsPossible)?;
    for (joint, angle) in named {
        if let Some(angle) = angle {
            line.robot.trim(joint, angle)?;
        }
    }
    let [front, back] = trims(&mut line)?;
    output.print(&Trims::new(front, back));
    line.close()
}

fn trims(line: &mut RobotConnection) -> Outcome<[i16; 2]> {
    Ok([
        line.robot.servo(Joint::Front)?.trim,
        line.robot.servo(Joint::Back)?.trim,
    ])
}

/// Nudges with keys.
fn nudge(access: &Access, output: Output) -> Outcome {
    let interrupt = Interrupt::install_with_a_robot()?;
    let mut line = access.connect("swimmer robot trim", Pace::RealTime)?;
    line.shows_silence();
    let before = trims(&mut line)?;
    let mut nudging = Nudging::new(before.map(degrees));
    let mut terminal = ratatui::try_init().map_err(no_terminal)?;
    let ended = bench(&mut terminal, &mut line, &mut nudging, &interrupt);
    ratatui::restore();
    let saved = matches!(ended, Ok(Wish::Save));
    // Power off first; what is in force then is what the robot stores.
    line.robot.stop()?;
    wait_for_rest(&mut line.robot)?;
    if !saved {
        for (joint, trim) in [Joint::Front, Joint::Back].into_iter().zip(before) {
            line.robot.trim(joint, degrees(trim).to_radians())?;
        }
    }
    line.stored("the trims are")?;
    ended?;
    let [front, back] = trims(&mut line)?;
    output.line(if saved {
        "Saved on the robot."
    } else {
        "Not saved: the trims are as before."
    });
    output.print(&Trims::new(front, back));
    line.close()
}

fn degrees(units: i16) -> f64 {
    (f64::from(units) * f64::from(ANGLE_UNIT_RAD)).to_degrees()
}

/// Until the operator saves or leaves.
fn bench(
    terminal: &mut DefaultTerminal,
    line: &mut RobotConnection,
    nudging: &mut Nudging,
    interrupt: &Interrupt,
) -> Outcome<Wish> {
    let mut heard = line.robot.port().now();
    loop {
        let news = line.beat()?;
        let now = line.robot.port().now();
        if let Some(telemetry) = news {
            heard = now;
            nudging.state = Some(telemetry.state);
        } else if now.saturating_sub(heard) >= SILENCE_REPORTED {
            nudging.state = None;
        }
        if interrupt.requested() {
            return Ok(Wish::Leave);
        }
        while event::poll(Duration::ZERO).map_err(no_terminal)? {
            let Event::Key(key) = event::read().map_err(no_terminal)? else {
                continue;
            };
            match nudging.press(key) {
                Some(wish @ (Wish::Save | Wish::Leave)) => return Ok(wish),
                Some(Wish::Turn(joint)) => {
                    let angle = nudging.angle(joint).to_radians();
                    line.robot.trim(joint, angle)?;
                }
                Some(Wish::Power) => {
                    let off = matches!(
                        nudging.state,
                        None | Some(StateName::Stopped | StateName::EStopped)
                    );
                    if off {
                        line.robot.arm(false)?;
                    } else {
                        line.robot.stop()?;
                    }
                }
                None => {}
            }
        }
        terminal
            .draw(|frame| nudging.draw(frame))
            .map_err(no_terminal)?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_are_suggested_only_where_they_may_have_been_meant() {
        assert_eq!(angle_of_trim("-0.5"), Ok(-0.5));
        assert_eq!(angle_of_trim("30deg"), Ok(30f64.to_radians()));
        for (text, reason) in [
            (
                "90deg",
                "a trim of 90.0° is beyond ±30°: set the servo's horn anew",
            ),
            (
                "1.2rad",
                "a trim of 68.8° is beyond ±30°: set the servo's horn anew",
            ),
            (
                "-5",
                "a trim of -286.5° is beyond ±30°: write degrees as -5deg, or set the servo's horn anew",
            ),
            (
                "45",
                "a trim of 2578.3° is beyond ±30°: set the servo's horn anew",
            ),
        ] {
            assert_eq!(angle_of_trim(text), Err(reason.to_owned()), "{text}");
        }
    }
}
