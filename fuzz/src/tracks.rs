//! Tracking files with arbitrary contents: tracks or an error with a reason, never a panic, never NaN.

use std::path::Path;

use calibrate::{TrackFile, TrackOptions, TrackSurvey};

/// Reads a file that begins with one of `openings`; other bytes get the first of them as a prefix. The first lines select the
/// reader, so these force the format; without openings the bytes are the whole file.
///
/// # Panics
/// If the result is inconsistent.
pub fn read(bytes: &[u8], openings: &[&str]) {
    let begun = |opening: &&str| bytes.starts_with(opening.as_bytes());
    let opening = match openings.first() {
        Some(first) if !openings.iter().any(begun) => *first,
        _ => "",
    };
    let file = [opening.as_bytes(), bytes].concat();
    // Some formats say neither unit nor rate: with a user who does, their rows are read too.
    let told = TrackOptions {
        metres_per_unit: Some(0.001),
        rate_hz: Some(50.0),
        ..TrackOptions::default()
    };
    for options in [TrackOptions::default(), told] {
        let survey = calibrate::survey_tracks(&*file, Path::new("f"), &options);
        match calibrate::read_tracks_with(&*file, Path::new("f"), &options) {
            Ok(file) => {
                sane(&file);
                surveyed(&file, &survey.expect("what is read can be surveyed"));
            }
            Err(error) => {
                assert!(!error.to_string().is_empty());
                assert!(survey.is_err(), "surveyed, but not read: {error}");
            }
        }
    }
}

/// A survey says what reading finds.
fn surveyed(file: &TrackFile, survey: &TrackSurvey) {
    assert_eq!(survey.format, file.format);
    assert_eq!((survey.unit, survey.frames), (file.unit, file.frames()));
    assert_eq!(survey.rate_hz.to_bits(), file.rate_hz.to_bits());
    assert_eq!(survey.points.len(), file.points.len());
    for (told, point) in survey.points.iter().zip(&file.points) {
        let presence = (point.present(), point.gaps(), point.longest_gap());
        assert_eq!((told.present, told.gaps, told.longest_gap), presence);
        assert_eq!((&told.name, told.kind), (&point.name, point.kind));
    }
}

/// Whole numbers of frames, finite numbers.
fn sane(file: &TrackFile) {
    assert!(
        file.times.iter().all(|time| time.is_finite()),
        "a time that is no number"
    );
    assert_eq!(file.times.len(), file.frame_numbers.len());
    for point in &file.points {
        let positions = (0..file.frames()).filter_map(|row| point.position(row));
        for position in positions {
            assert!(
                position.iter().all(|value| value.is_finite()),
                "a position that is no number: {position:?}"
            );
        }
        assert!(point.present() <= file.frames());
        assert!(point.longest_gap() <= file.frames());
    }
}
