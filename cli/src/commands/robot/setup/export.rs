//! The swimmer file that a setup leaves: the swimmer, its `[servo]`, and how each servo was set up, in words that set it up
//! again on another board.

use std::fmt::Write as _;
use std::path::Path;

use swimmer_files::{SwimmerFile, write_atomically};

use super::super::servo::Set;
use crate::failure::{Failure, Outcome};

/// Checks that a file may be written there: any that may be written, and the named swimmer file itself, which is replaced.
///
/// # Errors
/// [`Failure::BadInput`].
pub(super) fn may_be_written(file: &Path, named: Option<&str>) -> Outcome {
    let same = |named: &str| {
        let one = |path: &Path| path.canonicalize().ok();
        one(Path::new(named)).is_some_and(|named| Some(named) == one(file))
    };
    if named.is_some_and(same) {
        return Ok(());
    }
    crate::new_file::may_be_written(file)
}

/// Writes it.
///
/// # Errors
/// [`Failure::Tried`] where nothing can be written there.
pub(super) fn write(place: &Path, file: &SwimmerFile, servos: &[Set; 2]) -> Outcome {
    write_atomically(place, text(file, servos).as_bytes()).map_err(|error| Failure::tried(&error))
}

fn text(file: &SwimmerFile, servos: &[Set; 2]) -> String {
    let mut text = file.to_toml();
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "# dead_band is half its width, the larger of both servos, as measured. Each servo has its own map on the robot;\n# on another board these set it up again:"
    );
    for servo in servos {
        let _ = writeln!(text, "#   {}", servo.command());
    }
    text
}

/// A measured angle has no more than four decimals.
pub(super) fn rounded(angle: f64) -> f64 {
    (angle * 1e4).round() / 1e4
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_files::ServoFile;

    #[test]
    fn the_file_is_read_back_and_tells_the_commands() {
        let file = SwimmerFile {
            servo: Some(ServoFile {
                dead_band: rounded(0.139_626_3),
                ..ServoFile::default()
            }),
            ..SwimmerFile::preset("robot").unwrap()
        };
        let set = |joint, sign| Set {
            joint,
            sign,
            centre_us: 1512.0,
            slope_rad_per_us: 0.0274,
            trim_rad: 0.0,
            pulse_range_us: [1400.0, 1600.0],
            reach_rad: [-2.8, 2.8],
            passive: false,
        };
        let text = text(&file, &[set("front", '-'), set("back", '+')]);
        assert!(
            text.contains("#   swimmer robot servo front --sign - --centre 1512"),
            "{text}"
        );
        let read = SwimmerFile::parse(&text, Path::new("ours.toml")).unwrap();
        assert!((read.servo.unwrap().dead_band - 0.1396).abs() < 1e-12);
        assert_eq!(read.swimmer, file.swimmer);
    }

    #[test]
    fn what_is_there_is_not_overwritten_but_for_the_swimmer_itself() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("ours.toml");
        let name = file.to_str().unwrap();
        may_be_written(&file, None).unwrap();
        std::fs::write(&file, "x").unwrap();
        assert!(may_be_written(&file, None).is_err());
        assert!(may_be_written(&file, Some("robot")).is_err());
        may_be_written(&file, Some(name)).unwrap();
    }
}
