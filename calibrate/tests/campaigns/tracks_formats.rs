//! One motion in every format: small files of our own making, each with the quirks that its real kin were seen with. A front
//! and a back reflector 71 mm apart and, for four rows, a third point; the back one is missing in two rows.

use std::fs::File;
use std::path::{Path, PathBuf};

use calibrate::{
    PointKind, TrackFile, TrackFormat, TrackOptions, TrackPoint, TrackWarning, Unit,
    read_tracks_with,
};

const ROWS: usize = 12;

fn front(row: usize) -> [f64; 2] {
    [0.1 + 0.002 * row as f64, 0.25 - 0.001 * row as f64]
}

fn back(row: usize) -> Option<[f64; 2]> {
    (row != 3 && row != 4).then_some([0.029 + 0.002 * row as f64, 0.25 - 0.001 * row as f64])
}

fn third(row: usize) -> Option<[f64; 2]> {
    (5..=8)
        .contains(&row)
        .then_some([0.5 + 0.001 * row as f64, 0.4])
}

/// One format's recording of the motion.
struct Sample {
    file: &'static str,
    format: &'static str,
    rate_hz: f64,
    unit: Unit,
    /// Names of front, back and third, if the format has them.
    names: [Option<&'static str>; 3],
    /// A place in the tank, x and y, from one in the file.
    tank: fn([f64; 3]) -> [f64; 2],
    warnings: &'static [TrackWarning],
}

fn y_up([y, _, x]: [f64; 3]) -> [f64; 2] {
    [x, y]
}

fn z_up([x, y, _]: [f64; 3]) -> [f64; 2] {
    [x, y]
}

fn image([x, y, _]: [f64; 3]) -> [f64; 2] {
    [x, 0.3 - y]
}

const PIXEL: Unit = Unit::Scaled(0.0005);

impl Sample {
    const fn new(
        file: &'static str,
        format: &'static str,
        rate_hz: f64,
        unit: Unit,
        names: [&'static str; 3],
        tank: fn([f64; 3]) -> [f64; 2],
    ) -> Self {
        let [a, b, c] = names;
        Self {
            file,
            format,
            rate_hz,
            unit,
            names: [Some(a), Some(b), Some(c)],
            tank,
            warnings: &[],
        }
    }

    const fn warned(mut self, warnings: &'static [TrackWarning]) -> Self {
        self.warnings = warnings;
        self
    }
}

/// Every file of the folder.
#[allow(clippy::too_many_lines)] // a table
fn samples() -> Vec<Sample> {
    let (m, cm, mm) = (Unit::Metre, Unit::Centimetre, Unit::Millimetre);
    let motive = ["robot:Front", "robot:Back", "Unlabeled 7"];
    let plain = ["front", "back", "ghost"];
    vec![
        Sample::new(
            "motive-1.21.csv",
            "motive-1.21",
            100.0,
            m,
            ["robot:Front", "robot:Back", "Unlabeled:7"],
            y_up,
        ),
        Sample::new("motive-1.22.csv", "motive-1.22", 100.0, m, motive, y_up),
        Sample::new("motive-1.23.csv", "motive-1.23", 100.0, m, motive, y_up),
        Sample::new("motive-1.24.csv", "motive-1.24", 100.0, cm, motive, y_up),
        Sample::new("motive-1.25.csv", "motive-1.25", 100.0, mm, motive, y_up),
        Sample::new("motive-excel-eu.csv", "motive-1.22", 100.0, m, motive, y_up),
        Sample::new(
            "motive-without-header.csv",
            "motive-without-header",
            100.0,
            Unit::Scaled(1.0),
            ["column 3", "column 6", "column 9"],
            y_up,
        )
        .warned(&[TrackWarning::NoHeader]),
        Sample::new(
            "motive-1.1.csv",
            "motive-1.1",
            100.0,
            m,
            ["robot-Marker 1", "robot-Marker 2", "Marker-4711"],
            y_up,
        ),
        Sample {
            // The list has no identity: only the bodies' own records name the points.
            names: [Some("robot:Marker1"), Some("robot:Marker2"), None],
            ..Sample::new(
                "trackingtools-1.0.csv",
                "trackingtools-1.0",
                100.0,
                m,
                plain,
                y_up,
            )
        },
        Sample {
            names: [Some("front"), None, None],
            ..Sample::new("tracker-single.txt", "tracker", 50.0, PIXEL, plain, z_up)
        },
        Sample::new("tracker-multi.txt", "tracker", 50.0, PIXEL, plain, z_up),
        Sample::new(
            "tracker-side-by-side.csv",
            "tracker",
            50.0,
            PIXEL,
            plain,
            z_up,
        ),
        Sample::new("deeplabcut.csv", "deeplabcut", 50.0, PIXEL, plain, image).warned(&[
            TrackWarning::Unlikely {
                count: 10,
                threshold: 0.9,
            },
        ]),
        Sample::new(
            "deeplabcut-multi.csv",
            "deeplabcut",
            50.0,
            PIXEL,
            ["robot:front", "robot:back", "ghost"],
            image,
        ),
        Sample::new(
            "tank.trc",
            "trc",
            100.0,
            mm,
            ["Front", "Back", "Unlabeled 7"],
            y_up,
        ),
        Sample::new(
            "qtm.tsv",
            "qtm",
            100.0,
            mm,
            ["Front", "Back", "New 0000"],
            z_up,
        ),
        Sample::new(
            "vicon.csv",
            "vicon",
            100.0,
            mm,
            ["robot:Front", "robot:Back", "robot:Extra"],
            z_up,
        ),
        Sample::new(
            "cortex.trc",
            "trc",
            100.0,
            mm,
            ["Front", "Back", "Unlabeled 7"],
            y_up,
        ),
        Sample {
            names: [Some("robot"), Some("tool"), None],
            ..Sample::new("vicon-objects.csv", "vicon", 100.0, mm, plain, z_up)
        },
        Sample::new(
            "sleap.csv",
            "sleap",
            50.0,
            PIXEL,
            ["robot:front", "robot:back", "ghost:front"],
            image,
        ),
        Sample::new("kinovea.txt", "kinovea", 50.0, PIXEL, plain, z_up),
        Sample::new(
            "kinovea.csv",
            "kinovea",
            50.0,
            PIXEL,
            ["front/0", "back/0", "ghost/0"],
            z_up,
        ),
        Sample::new(
            "table-pixels.csv",
            "table",
            50.0,
            PIXEL,
            ["1", "2", "3"],
            image,
        )
        .warned(&[TrackWarning::PixelsDown]),
        Sample::new("table-spaces.txt", "table", 50.0, m, plain, z_up),
    ]
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats")
}

/// Options that a user would give for these files: a scale if they have no unit, a rate if they have no time.
fn options(sample: &Sample) -> TrackOptions {
    TrackOptions {
        metres_per_unit: match sample.unit {
            Unit::Scaled(_) if matches!(sample.format, "tracker" | "kinovea") => Some(1.0),
            Unit::Scaled(metres) => Some(metres),
            _ => None,
        },
        rate_hz: matches!(sample.format, "deeplabcut" | "sleap").then_some(50.0),
        ..TrackOptions::default()
    }
}

fn read(sample: &Sample) -> TrackFile {
    let path = folder().join(sample.file);
    read_tracks_with(File::open(&path).unwrap(), &path, &options(sample)).unwrap()
}

fn named<'f>(file: &'f TrackFile, name: &str) -> &'f TrackPoint {
    // Vicon's objects are solved bodies.
    let measured = |point: &&TrackPoint| {
        let body = file.format == TrackFormat::Vicon && point.kind == PointKind::RigidBody;
        point.name == name && (point.kind.is_measured() || body)
    };
    file.points
        .iter()
        .find(measured)
        .unwrap_or_else(|| panic!("no `{name}`"))
}

#[test]
fn every_format_tells_the_same_motion() {
    for sample in samples() {
        let file = read(&sample);
        let name = sample.file;
        assert_eq!(file.format.to_string(), sample.format, "{name}");
        assert!(
            (file.rate_hz - sample.rate_hz).abs() < 0.04 * sample.rate_hz,
            "{name}: {}",
            file.rate_hz
        );
        assert_eq!(file.frames(), ROWS, "{name}");
        let expected: [&dyn Fn(usize) -> Option<[f64; 2]>; 3] =
            [&|row| Some(front(row)), &back, &third];
        for (expected, point) in expected.iter().zip(sample.names) {
            let Some(point) = point else { continue };
            let point = named(&file, point);
            for row in 0..ROWS {
                let seen = point.position(row).map(|p| (sample.tank)(p.into()));
                match (seen, expected(row)) {
                    (Some([x, y]), Some([a, b])) => assert!(
                        (x - a).abs() < 1.1e-6 && (y - b).abs() < 1.1e-6,
                        "{name}, {}, row {row}: {x} {y}, not {a} {b}",
                        point.name
                    ),
                    (None, None) => {}
                    other => panic!("{name}, {}, row {row}: {other:?}", point.name),
                }
            }
        }
        let surprises: Vec<_> = file
            .warnings
            .iter()
            .filter(|warning| !sample.warnings.contains(warning))
            .collect();
        // Real stamps jitter.
        let uneven = matches!(surprises[..], [TrackWarning::UnevenTimes { .. }]);
        assert!(
            surprises.is_empty() || (uneven && sample.format == "trackingtools-1.0"),
            "{name}: {surprises:?}"
        );
        for warning in sample.warnings {
            assert!(file.warnings.contains(warning), "{name}: no {warning:?}");
        }
    }
}

#[test]
fn every_sample_of_the_folder_is_here() {
    let mut files: Vec<String> = std::fs::read_dir(folder())
        .unwrap()
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    files.sort();
    let mut listed: Vec<String> = samples().iter().map(|s| s.file.to_owned()).collect();
    listed.sort();
    assert_eq!(files, listed);
}

#[test]
fn units_are_told_or_left_open() {
    for sample in samples() {
        let path = folder().join(sample.file);
        let options = TrackOptions {
            metres_per_unit: None,
            ..options(&sample)
        };
        let file = read_tracks_with(File::open(&path).unwrap(), &path, &options).unwrap();
        let expected = match (sample.unit, sample.format) {
            (Unit::Scaled(_), "deeplabcut" | "sleap" | "table") => Unit::Pixel,
            (Unit::Scaled(_), _) => Unit::Unknown,
            (unit, _) => unit,
        };
        assert_eq!(file.unit, expected, "{}", sample.file);
    }
}

#[test]
fn solved_places_of_a_lost_body_are_stale() {
    for (file, body) in [
        ("trackingtools-1.0.csv", "robot"),
        ("motive-1.1.csv", "robot"),
    ] {
        let sample = samples().into_iter().find(|s| s.file == file).unwrap();
        let file = read(&sample);
        let of = |kind: PointKind, name: &str| {
            let point = file
                .points
                .iter()
                .find(|p| p.kind == kind && p.name == name);
            let point = point.unwrap();
            (point.present(), point.gaps(), point.longest_gap())
        };
        assert_eq!(of(PointKind::RigidBody, body), (10, 1, 2));
        assert_eq!(of(PointKind::RigidBodyMarker, "robot:Marker1"), (10, 1, 2));
        assert_eq!(of(PointKind::Marker, "robot:Marker1"), (12, 0, 0));
        assert_eq!(of(PointKind::Marker, "robot:Marker2"), (10, 1, 2));
    }
}

#[test]
fn stamps_are_kept_where_they_are_real_and_counted_where_they_are_rounded() {
    let by_name = |name: &str| {
        let sample = samples().into_iter().find(|s| s.file == name).unwrap();
        read(&sample)
    };
    assert!((by_name("trackingtools-1.0.csv").times[1] - 0.0311).abs() < 0.0007);
    // Rule 8: the number of the frame, which begins anywhere.
    let wide = by_name("motive-1.23.csv");
    assert_eq!((wide.frame_numbers[0], wide.times[5]), (72_210, 722.15));
    let trc = by_name("tank.trc");
    assert_eq!((trc.frame_numbers[0], trc.times[1]), (1, 0.01));
}

#[test]
fn a_likelihood_may_be_asked_for() {
    let path = folder().join("deeplabcut.csv");
    let with = |likelihood| {
        let options = TrackOptions {
            rate_hz: Some(50.0),
            likelihood: Some(likelihood),
            ..TrackOptions::default()
        };
        let file = read_tracks_with(File::open(&path).unwrap(), &path, &options).unwrap();
        file.points.iter().map(TrackPoint::present).sum::<usize>()
    };
    assert_eq!((with(0.01), with(0.9), with(0.999)), (36, 26, 0));
}
