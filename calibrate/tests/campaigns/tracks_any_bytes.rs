//! Any bytes give tracks or an error, never a panic; a survey agrees with a full reading.

use crate::writers;

use std::path::Path;
use std::sync::LazyLock;

use calibrate::{TrackFile, TrackOptions, read_tracks_with, survey_tracks};
use proptest::prelude::*;

const SEEDS: [&str; 4] = [
    "Format Version,1.24,Take Name,a,Export Frame Rate,100,Length Units,Meters,Coordinate Space,Global\n\n,Type,,Marker,Marker,Marker\n,Name,,\"F\",F,F\n,ID,,\"1\",1,1\n,,,Position,Position,Position\nFrame,Time (Seconds),TimeCode,X,Y,Z\n0,0.00,1:2,1,2,3\n1,0.01,1:2,,,\n",
    "t;x1;y1;x2;y2\n0;1,5;2;3;4\n0,01;1;;NaN;4\n",
    "# t x1 y1\n0 1 2\n0.1 2 3\n",
    "cm_A\nt\tx\ty\n0\t1\t2\n",
];

/// The samples, and one file of each format in `writers`.
static SAMPLES: LazyLock<Vec<String>> = LazyLock::new(|| {
    let written = writers::written_files().into_iter().map(|file| file.text);
    SEEDS
        .iter()
        .map(|&text| text.to_owned())
        .chain(written)
        .collect()
});

/// Content of a file, read and surveyed.
fn surveyed(bytes: &[u8]) -> Option<TrackFile> {
    let options = TrackOptions::default();
    let survey = survey_tracks(bytes, Path::new("f"), &options);
    let Ok(file) = read_tracks_with(bytes, Path::new("f"), &options) else {
        assert!(survey.is_err(), "surveyed, but not read");
        return None;
    };
    let survey = survey.unwrap();
    assert_eq!(survey.format, file.format);
    assert_eq!((survey.unit, survey.frames), (file.unit, file.frames()));
    assert_eq!(survey.rate_hz.to_bits(), file.rate_hz.to_bits());
    assert_eq!(survey.warnings, file.warnings);
    assert_eq!(survey.points.len(), file.points.len());
    for (told, point) in survey.points.iter().zip(&file.points) {
        assert_eq!(
            (&told.name, told.present, told.gaps, told.longest_gap),
            (
                &point.name,
                point.present(),
                point.gaps(),
                point.longest_gap()
            )
        );
    }
    Some(file)
}

#[test]
fn absurd_times_cost_no_more_than_their_rows() {
    for times in [
        ["0", "0.1", "1e300"],
        ["0", "0.1", "1e308"],
        ["-1e308", "0", "1e308"],
        ["0", "1e-300", "1e300"],
        ["0", "1e-320", "1"],
        ["0.00", "0.01", "99999999999.02"],
    ] {
        let [a, b, c] = times;
        let text = format!("t,x1,y1,x2,y2\n{a},1,2,3,4\n{b},1,2,3,4\n{c},1,2,3,4\n");
        for rate_hz in [None, Some(50.0)] {
            let options = TrackOptions {
                rate_hz,
                metres_per_unit: Some(1.0),
                ..TrackOptions::default()
            };
            let Ok(file) = read_tracks_with(text.as_bytes(), Path::new("f"), &options) else {
                continue;
            };
            assert_eq!(file.times.len(), 3, "{times:?}");
            assert!(
                file.times.iter().all(|time| time.is_finite()),
                "{times:?}: {:?}",
                file.times
            );
            assert!(file.rate_hz.is_finite(), "{times:?}: {}", file.rate_hz);
        }
        surveyed(text.as_bytes());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn arbitrary_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = surveyed(&bytes);
    }

    #[test]
    fn arbitrary_text(text in "(Format Version,|t,x1,y1\n|frame,|,|\"|;|\n|\r\n|[0-9.eE+-]{1,5}|X|Y|Z|Position|Type|é|\\PC){0,60}") {
        let _ = surveyed(text.as_bytes());
    }

    #[test]
    fn damaged_samples(which in any::<prop::sample::Index>(), edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..3u8), 1..6)) {
        let mut bytes = SAMPLES[which.index(SAMPLES.len())].as_bytes().to_vec();
        for (index, byte, kind) in edits {
            if bytes.is_empty() {
                break;
            }
            let at = index.index(bytes.len());
            match kind {
                0 => bytes[at] = byte,
                1 => drop(bytes.remove(at)),
                _ => bytes.insert(at, byte),
            }
        }
        if let Some(file) = surveyed(&bytes) {
            prop_assert!(file.times.iter().all(|time| time.is_finite()));
            for point in &file.points {
                prop_assert!((0..file.frames()).filter_map(|row| point.position(row)).all(|p| p.iter().all(|v| v.is_finite())));
            }
        }
    }
}
