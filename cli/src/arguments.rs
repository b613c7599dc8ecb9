//! The values on the command line that several commands share.

use std::path::Path;
use std::str::FromStr;

use swimmer_files::{AnyGait, GaitSpec, Provenance, SwimmerFile, parse_angle};
use swimmer_model::Model;

use crate::failure::{Failure, Outcome};
use crate::output::aside;

/// An angle on the command line, in radians.
pub(crate) fn angle(text: &str) -> Result<f64, String> {
    parse_angle(text).map_err(|error| error.to_string())
}

/// An angle above zero on the command line, in radians.
pub(crate) fn positive_angle(text: &str) -> Result<f64, String> {
    let angle = angle(text)?;
    if angle > 0.0 {
        Ok(angle)
    } else {
        Err("the angle must be above zero".to_owned())
    }
}

/// A length on the command line, zero or above, in metres.
pub(crate) fn length(text: &str) -> Result<f64, String> {
    match f64::from_str(text) {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("write a length in metres, zero or above, as 0.005".to_owned()),
    }
}

/// A time above zero on the command line, in seconds.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    let number = text.strip_suffix('s').unwrap_or(text).trim_end();
    match f64::from_str(number) {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("write a number of seconds above zero, as 30 or 2.5".to_owned()),
    }
}

/// What `--gait` names, still to be loaded.
pub(crate) fn gait(text: &str) -> Result<GaitSpec, String> {
    text.parse()
        .map_err(|error: swimmer_files::GaitSpecError| error.to_string())
}

/// Loads what `--swimmer` names.
pub(crate) fn load_swimmer(preset_or_path: &str) -> Outcome<SwimmerFile> {
    let swimmer = SwimmerFile::find(preset_or_path)?;
    if SwimmerFile::preset(preset_or_path).is_none() {
        let path = Path::new(preset_or_path);
        let folder = path.parent().unwrap_or_else(|| Path::new(""));
        let made = Provenance::load(path)?;
        for input in made.iter().flat_map(|made| made.changed(folder)) {
            aside(&format!(
                "note: {preset_or_path} was fitted from {input}, which has changed since; calibrate again"
            ));
        }
    }
    Ok(swimmer)
}

/// Loads what `--gait` names.
pub(crate) fn load_gait(spec: &GaitSpec) -> Outcome<AnyGait> {
    Ok(spec.load()?)
}

/// The model of a swimmer.
pub(crate) fn model(file: &SwimmerFile) -> Outcome<Model<f64>> {
    Model::new(&file.swimmer).map_err(|error| {
        Failure::BadInput(format!("the swimmer `{}` cannot swim: {error}", file.name))
    })
}

impl From<swimmer_files::FileError> for Failure {
    /// A file that cannot be read, or says something wrong, is bad input; one that cannot be written is a failed try.
    fn from(error: swimmer_files::FileError) -> Self {
        match error {
            swimmer_files::FileError::Write { .. } => Self::tried(&error),
            _ => Self::bad_input(&error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_positive() {
        assert_eq!(seconds("30"), Ok(30.0));
        assert_eq!(seconds("2.5s"), Ok(2.5));
        for text in ["0", "-1", "nan", "inf", "s", "1m", ""] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }
}
