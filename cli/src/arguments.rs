//! The values on the command line that several commands share.

use std::path::Path;
use std::str::FromStr;
use std::time::Duration;

use gait_optimizer::Uncertainty;
use operations::{SwimmerSource, check_robots_drag, fit_file};
use swimmer_files::{AnyGait, GaitSpec, SwimmerFile, parse_angle, parse_rate};
use swimmer_model::Model;

use crate::context::perform;
use crate::failure::Outcome;

/// An angle on the command line, in radians.
pub(crate) fn angle(text: &str) -> Result<f64, String> {
    parse_angle(text).map_err(|error| error.to_string())
}

/// An angle above zero on the command line, in radians.
pub(crate) fn positive_angle(text: &str) -> Result<f64, String> {
    above_zero_angle(angle(text)?, "the angle")
}

/// The half width of a dead band on the command line, zero or above, in radians.
pub(crate) fn dead_band(text: &str) -> Result<f64, String> {
    let angle = angle(text)?;
    if angle >= 0.0 {
        Ok(angle)
    } else {
        Err("a dead band is zero or above, as 1deg".to_owned())
    }
}

/// An angle a second, above zero, on the command line, in radians a second.
pub(crate) fn rate(text: &str) -> Result<f64, String> {
    let rate = parse_rate(text).map_err(|error| error.to_string())?;
    above_zero_angle(rate, "the rate")
}

fn above_zero_angle(angle: f64, what: &str) -> Result<f64, String> {
    if angle > 0.0 {
        Ok(angle)
    } else {
        Err(format!("{what} must be above zero"))
    }
}

/// Gain of the servos on the command line: actual over commanded angle.
pub(crate) fn gain(text: &str) -> Result<f64, String> {
    match f64::from_str(text) {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("write a number above zero, as 0.98".to_owned()),
    }
}

/// Stiffness of a torsion spring on the command line, in N m/rad.
pub(crate) fn stiffness(text: &str) -> Result<f64, String> {
    match f64::from_str(text) {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("write a stiffness above zero in N m/rad, as 0.002".to_owned()),
    }
}

/// A length on the command line, zero or above, in metres.
pub(crate) fn length(text: &str) -> Result<f64, String> {
    match f64::from_str(text) {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("write a length in metres, zero or above, as 0.005".to_owned()),
    }
}

/// The longest time that may be given, s: thirty years, which every clock here can count to.
const LONGEST_S: f64 = 1e9;
/// The shortest and the longest period of a robot's cycle, µs: one servo period, and the limit of the wire format.
const PERIODS_US: [u32; 2] = [gait_player::TICK_US, u32::MAX];

/// A time above zero on the command line, in seconds.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    let seconds = above_zero(text)?;
    if seconds <= LONGEST_S {
        Ok(seconds)
    } else {
        Err(format!(
            "that is too long: write a number of seconds up to {LONGEST_S}, as 30 or 2.5"
        ))
    }
}

/// A longer time on the command line, as `90min`, `2h` or seconds; in seconds.
pub(crate) fn time(text: &str) -> Result<f64, String> {
    let units = [("min", 60.0), ("h", 3600.0), ("s", 1.0)];
    let (number, unit) = units
        .iter()
        .find_map(|(name, unit)| Some((text.trim().strip_suffix(name)?, *unit)))
        .unwrap_or((text, 1.0));
    seconds(number.trim())
        .and_then(|number| seconds(&(number * unit).to_string()))
        .map_err(|_| "write a time above zero, as 90min, 2h or 5400 for seconds".to_owned())
}

/// The duration of a cycle that a robot shall play, in seconds.
pub(crate) fn period(text: &str) -> Result<f64, String> {
    let period = above_zero(text)?;
    let [shortest, longest] = PERIODS_US;
    let on_the_wire = Duration::try_from_secs_f64(period)
        .ok()
        .and_then(|period| u32::try_from(period.as_micros()).ok());
    if on_the_wire.is_some_and(|us| (shortest..=longest).contains(&us)) {
        return Ok(period);
    }
    Err(format!(
        "a robot's cycle takes from {} s to {} s; write its seconds, as 30 or 2.5",
        f64::from(shortest) / 1e6,
        longest / 1_000_000
    ))
}

fn above_zero(text: &str) -> Result<f64, String> {
    let number = text.strip_suffix('s').unwrap_or(text).trim_end();
    match f64::from_str(number) {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("write a number of seconds above zero, as 30 or 2.5".to_owned()),
    }
}

/// Gait of `--gait`, still to be loaded.
pub(crate) fn gait(text: &str) -> Result<GaitSpec, String> {
    text.parse()
        .map_err(|error: swimmer_files::GaitSpecError| error.to_string())
}

/// Loads the swimmer that `--swimmer` names, and prints its warnings.
pub(crate) fn load_swimmer(preset_or_path: &str) -> Outcome<SwimmerFile> {
    perform(|context| SwimmerSource::from(preset_or_path).load(context))
}

/// The same for a robot, its twin or a fit, which know the paper's parameters only ([`Swimmer::common_drag`]).
///
/// [`Swimmer::common_drag`]: swimmer_model::Swimmer::common_drag
pub(crate) fn load_robots_swimmer(preset_or_path: &str) -> Outcome<SwimmerFile> {
    let file = load_swimmer(preset_or_path)?;
    check_robots_drag(&file)?;
    Ok(file)
}

/// Loads the gait that `--gait` names.
pub(crate) fn load_gait(spec: &GaitSpec) -> Outcome<AnyGait> {
    Ok(spec.load()?)
}

/// Loads the uncertainty that a fit leaves.
pub(crate) fn load_fit(path: &Path) -> Outcome<Uncertainty> {
    perform(|context| fit_file::load(path, context))
}

/// The model of a swimmer.
pub(crate) fn model(file: &SwimmerFile) -> Outcome<Model<f64>> {
    Ok(operations::model(file)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units() {
        for (text, seconds) in [
            ("90min", 5400.0),
            ("2h", 7200.0),
            ("1.5 h", 5400.0),
            ("30s", 30.0),
            ("45", 45.0),
        ] {
            assert_eq!(time(text), Ok(seconds), "{text}");
        }
        for text in ["", "h", "-1h", "1d", "0", "1e9h"] {
            assert!(time(text).is_err(), "{text}");
        }
    }

    #[test]
    fn times_are_positive() {
        assert_eq!(seconds("30"), Ok(30.0));
        assert_eq!(seconds("2.5s"), Ok(2.5));
        for text in ["0", "-1", "nan", "inf", "s", "1m", "", "1e300", "1e10"] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }

    /// Whatever is accepted can be counted to, and a period fits the wire.
    #[test]
    fn the_longest_times_can_be_counted() {
        let counted = |text| Duration::try_from_secs_f64(seconds(text).unwrap());
        assert_eq!(counted("1e9"), Ok(Duration::from_secs(1_000_000_000)));
        let on_the_wire = |text| {
            let period = Duration::try_from_secs_f64(period(text)?).unwrap();
            u32::try_from(period.as_micros()).map_err(|error| error.to_string())
        };
        assert_eq!(on_the_wire("0.02"), Ok(20_000));
        assert_eq!(on_the_wire("4294.967295"), Ok(u32::MAX));
        for text in ["0", "1e-7", "0.0199", "4294.967296", "5000", "1e300", "nan"] {
            assert!(on_the_wire(text).is_err(), "{text}");
        }
    }
}
