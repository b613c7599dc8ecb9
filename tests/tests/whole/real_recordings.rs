//! Real recordings from other laboratories. They are read in place and never committed; where the folder is missing, the
//! tests are ignored (`build.rs`), and the project's own recordings (calibrate/tests/formats) take their place. Counts were made independently (Python's csv module).

use std::fs;
use std::path::{Path, PathBuf};

use calibrate::{PointKind, TrackFile, TrackPoint, TrackWarning, Unit, read_tracks};

fn sample(name: &str) -> (PathBuf, Vec<u8>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../shared/optitrack")
        .join(name);
    match fs::read(&path) {
        Ok(bytes) => (path, bytes),
        Err(error) => panic!("{} cannot be read: {error}", path.display()),
    }
}

fn tracks(name: &str) -> TrackFile {
    let (path, bytes) = sample(name);
    read_tracks(&bytes, &path).unwrap()
}

/// Kind, name, present, gaps, longest gap.
fn table(file: &TrackFile) -> Vec<(PointKind, &str, usize, usize, usize)> {
    let row = |point: &'_ calibrate::TrackPoint| {
        (
            point.kind,
            point.present(),
            point.gaps(),
            point.longest_gap(),
        )
    };
    file.points
        .iter()
        .map(|point| {
            let (kind, present, gaps, longest) = row(point);
            (kind, point.name.as_str(), present, gaps, longest)
        })
        .collect()
}

#[test]
#[cfg_attr(
    not(shared),
    ignore = "needs the real recordings in ../shared/optitrack"
)]
fn ernesto_has_solved_and_measured_markers_of_the_same_name() {
    let file = tracks("motive_v1.23_ernesto_rb_markers.csv");
    assert_eq!(
        (file.format.to_string(), file.rate_hz, file.unit),
        ("motive-1.23".into(), 120.0, Unit::Metre)
    );
    assert_eq!(
        (
            file.frames(),
            file.frame_numbers[0],
            file.frame_numbers[498]
        ),
        (499, 0, 498)
    );
    let mut expected = vec![(PointKind::RigidBody, "ernesto_body", 498, 1, 1)];
    let names = [
        "ernesto_body:Marker1",
        "ernesto_body:Marker2",
        "ernesto_body:Marker3",
        "ernesto_body:Marker4",
    ];
    expected.extend(names.map(|name| (PointKind::RigidBodyMarker, name, 498, 1, 1)));
    expected.extend(names.map(|name| (PointKind::Marker, name, 499, 0, 0)));
    assert_eq!(table(&file), expected);
    // Frame 4: the body is blank while its measured markers are there.
    assert!(file.points[0].position(4).is_none());
    let marker = file.points[5].position(4).unwrap();
    assert_eq!(marker.as_slice(), [3.833_493, 0.032_499, -2.237_665]);
    assert_eq!(
        file.points[0].position(0).unwrap().as_slice(),
        [3.717_927, 0.045_963, -2.209_530]
    );
    assert!(file.warnings.is_empty(), "{:?}", file.warnings);
}

#[test]
#[cfg_attr(
    not(shared),
    ignore = "needs the real recordings in ../shared/optitrack"
)]
fn pathviewr_jumps_and_its_header_lies() {
    let file = tracks("motive_v1.23_pathviewr_rb100.csv");
    assert_eq!(
        (file.format.to_string(), file.rate_hz, file.unit),
        ("motive-1.23".into(), 100.0, Unit::Metre)
    );
    assert_eq!(
        (
            file.frames(),
            file.frame_numbers[0],
            file.frame_numbers[933]
        ),
        (934, 72_210, 105_100)
    );
    assert_eq!((file.times[0], file.times[933]), (722.1, 1051.0));
    let body = PointKind::RigidBody;
    assert_eq!(
        table(&file),
        [
            (body, "device02", 933, 1, 1),
            (body, "device03", 932, 2, 1),
            (body, "device05", 748, 17, 153)
        ]
    );
    let warnings: Vec<_> = file.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        warnings,
        [
            "the frame number jumps 4 times, over 31957 frames that are not in the file",
            "the header says 190951 frames, the file has 934"
        ]
    );
}

#[test]
#[cfg_attr(
    not(shared),
    ignore = "needs the real recordings in ../shared/optitrack"
)]
fn feb20_is_an_excel_re_save_with_bodies_that_were_never_seen() {
    let file = tracks("motive_v1.23_pathviewr_feb20_trunc.csv");
    assert_eq!(
        (file.format.to_string(), file.rate_hz, file.unit),
        ("motive-1.23".into(), 100.0, Unit::Metre)
    );
    assert_eq!(
        (
            file.frames(),
            file.frame_numbers[0],
            file.frame_numbers[99],
            file.points.len()
        ),
        (100, 0, 99, 25)
    );
    let count = |entry: (usize, usize, usize)| {
        table(&file)
            .iter()
            .filter(|row| (row.2, row.3, row.4) == entry)
            .count()
    };
    assert_eq!(
        (count((26, 26, 5)), count((27, 27, 5)), count((0, 1, 100))),
        (11, 6, 8)
    );
    let dowel = &file.points[0];
    assert_eq!(
        (dowel.name.as_str(), dowel.id.as_str()),
        ("dowel01", "35F7B41250EE11EA69D7AB6B1FACEF9B")
    );
    assert_eq!(
        dowel.position(2).unwrap().as_slice(),
        [0.352_837, 0.193_868, 1.504_902]
    );
}

#[test]
#[cfg_attr(
    not(shared),
    ignore = "needs the real recordings in ../shared/optitrack"
)]
fn slow5_has_a_time_code_column_and_centimetres() {
    let file = tracks("motive_v1.24_slow5_EXCERPT.csv");
    assert_eq!(
        (file.format.to_string(), file.rate_hz, file.unit),
        ("motive-1.24".into(), 120.0, Unit::Centimetre)
    );
    assert_eq!(
        (file.frames(), file.frame_numbers[0], file.frame_numbers[7]),
        (8, 0, 2285)
    );
    let (marker, unlabeled) = (PointKind::Marker, PointKind::Unlabeled);
    assert_eq!(
        table(&file),
        [
            (marker, "Oak-D-Kamera:Marker 001", 8, 0, 0),
            (marker, "Oak-D-Kamera:Marker 002", 8, 0, 0),
            (marker, "Oak-D-Kamera:Marker 003", 8, 0, 0),
            (unlabeled, "Unlabeled 1297", 4, 1, 4),
            (unlabeled, "Unlabeled 1298", 0, 1, 8),
            (unlabeled, "Unlabeled 1299", 0, 1, 8),
        ]
    );
    let first = file.points[0].position(0).unwrap();
    assert!((first.x + 0.920_186_54).abs() < 1e-12 && (first.z - 1.341_022_95).abs() < 1e-12);
}

/// Points of a kind by name and present count.
fn present(file: &TrackFile, kind: PointKind) -> Vec<(&str, usize)> {
    let of_kind = file.points.iter().filter(|point| point.kind == kind);
    of_kind
        .map(|point| (point.name.as_str(), point.present()))
        .collect()
}

/// Histogram of the number of points of a kind per row.
fn census(file: &TrackFile, kind: PointKind) -> Vec<(usize, usize)> {
    let mut rows = std::collections::BTreeMap::new();
    for row in 0..file.frames() {
        let here = |point: &&TrackPoint| point.kind == kind && point.position(row).is_some();
        *rows
            .entry(file.points.iter().filter(here).count())
            .or_insert(0) += 1;
    }
    rows.into_iter().collect()
}

#[test]
#[cfg_attr(
    not(shared),
    ignore = "needs the real recordings in ../shared/optitrack"
)]
fn tracking_tools_has_four_bodies_and_a_list_without_identity() {
    let file = tracks("tt_v1.0_olin.csv");
    assert_eq!(
        (file.format.to_string(), file.unit, file.frames()),
        ("trackingtools-1.0".into(), Unit::Metre, 1668)
    );
    // Real stamps.
    assert_eq!(
        (file.times[0], file.times[1667]),
        (0.021_109_84, 6.689_139_03)
    );
    assert!((file.rate_hz - 250.0).abs() < 0.01, "{}", file.rate_hz);
    assert_eq!((file.frame_numbers[0], file.frame_numbers[1667]), (0, 1667));
    assert_eq!(
        present(&file, PointKind::RigidBody),
        [("r", 1002), ("l", 752), ("slider", 0), ("rbt", 1663)]
    );
    let markers = |body: &str, counts: &[usize]| -> Vec<(String, usize)> {
        let named = counts.iter().zip(1..);
        named
            .map(|(count, number)| (format!("{body}:Marker{number}"), *count))
            .collect()
    };
    let expected = [
        markers("r", &[1002; 3]),
        markers("l", &[752; 3]),
        markers("slider", &[0; 6]),
        markers("rbt", &[1662, 1663, 1663, 1663, 1663]),
    ]
    .concat();
    let found: Vec<(String, usize)> = present(&file, PointKind::Marker)
        .into_iter()
        .map(|(name, count)| (name.to_owned(), count))
        .collect();
    assert_eq!(found, expected);
    // 5, 8 or 11 raw markers a frame.
    assert_eq!(
        census(&file, PointKind::Unlabeled),
        [(5, 666), (8, 250), (11, 752)]
    );
    assert!(
        matches!(file.warnings[..], [TrackWarning::UnevenTimes { .. }]),
        "{:?}",
        file.warnings
    );
}

#[test]
#[cfg_attr(
    not(shared),
    ignore = "needs the real recordings in ../shared/optitrack"
)]
fn motive_1_1_names_its_markers() {
    let file = tracks("motive_v1.1_olin.csv");
    assert_eq!(
        (file.format.to_string(), file.unit, file.frames()),
        ("motive-1.1".into(), Unit::Metre, 548)
    );
    assert!((file.rate_hz - 120.0).abs() < 1e-3, "{}", file.rate_hz);
    // 20 frames untracked.
    assert_eq!(
        present(&file, PointKind::RigidBody),
        [("Rigid Body 1", 548 - 20)]
    );
    let measured = present(&file, PointKind::Marker);
    assert_eq!(
        measured[..5],
        [
            ("Rigid Body 1:Marker1", 528),
            ("Rigid Body 1:Marker2", 524),
            ("Rigid Body 1:Marker3", 528),
            ("Rigid Body 1:Marker4", 266),
            ("Rigid Body 1:Marker5", 266)
        ]
    );
    assert_eq!(measured[5], ("Rigid Body 1-Marker 1", 528));
    let unlabeled = present(&file, PointKind::Unlabeled);
    assert_eq!(unlabeled[0], ("Marker-1718", 20));
    assert_eq!(unlabeled.len(), 11 - 5);
    assert!(file.warnings.is_empty(), "{:?}", file.warnings);
    // Anchor E. Another reader's test asserts that y of this marker in frame 100 is 10.0, which is a marker's number.
    let last_of_frame = file
        .points
        .iter()
        .find(|point| point.name == "Rigid Body 1-Marker 5")
        .unwrap();
    assert_eq!(last_of_frame.id, "10");
    let everywhere = file.points.iter().filter_map(|point| point.position(100));
    for place in everywhere {
        assert!(place.amax() < 2.0, "{place} is no place in that room");
    }
}

#[test]
#[cfg_attr(
    not(shared),
    ignore = "needs the real recordings in ../shared/optitrack"
)]
fn tensegrity_has_313_numbers_for_13_reflectors() {
    let file = tracks("motive_v1.1_tensegrity_unlabeled13.csv");
    assert_eq!(
        (file.format.to_string(), file.unit, file.frames()),
        ("motive-1.1".into(), Unit::Metre, 1694)
    );
    assert!((file.rate_hz - 120.0).abs() < 1e-3, "{}", file.rate_hz);
    assert_eq!(file.points.len(), 313);
    assert!(file.points.iter().all(|p| p.kind == PointKind::Unlabeled));
    assert_eq!(
        census(&file, PointKind::Unlabeled),
        [
            (0, 7),
            (12, 8),
            (13, 983),
            (14, 497),
            (15, 136),
            (16, 39),
            (17, 23),
            (18, 1)
        ]
    );
    let mut lives: Vec<usize> = file.points.iter().map(TrackPoint::present).collect();
    lives.sort_unstable();
    assert_eq!((lives[156], lives[312]), (4, 1020));
    // A number is never used again: no gap but before and after.
    assert!(file.points.iter().all(|point| point.gaps() <= 2));
}

#[test]
#[cfg_attr(
    not(shared),
    ignore = "needs the real recordings in ../shared/optitrack"
)]
fn tracker_blocks_share_their_times() {
    let file = tracks("tracker_wide_arnoldjames_EXCERPT.csv");
    assert_eq!(
        (file.format.to_string(), file.unit, file.frames()),
        ("tracker".into(), Unit::Unknown, 6)
    );
    assert!((file.rate_hz - 30.0).abs() < 0.1, "{}", file.rate_hz);
    assert_eq!(
        present(&file, PointKind::Marker),
        [
            ("plate", 6),
            ("end_effector_left", 6),
            ("end_effector_right", 6),
            ("input", 6)
        ]
    );
    assert_eq!(
        file.points[3].position(5).unwrap().as_slice(),
        [-0.0373, 0.0201, 0.0]
    );
}

#[test]
#[cfg_attr(
    not(shared),
    ignore = "needs the real recordings in ../shared/optitrack"
)]
fn tracker_text_of_two_versions() {
    {
        let file = tracks("tracker_single_brocku.txt");
        assert_eq!(
            (file.format.to_string(), file.frames(), file.rate_hz),
            ("tracker".into(), 2, 1.0 / 0.032)
        );
        assert_eq!(present(&file, PointKind::Marker), [("cm_A", 2)]);
        let place = file.points[0].position(1).unwrap();
        assert_eq!(place.as_slice(), [11.642_890_57, -12.620_511_06, 0.0]);
    }
    {
        let file = tracks("tracker6_multi_brocku.txt");
        // Velocities are no places.
        assert_eq!(
            present(&file, PointKind::Marker),
            [("cm A", 0), ("cm B", 0)]
        );
        assert_eq!(file.frames(), 1);
        assert!(
            matches!(
                file.warnings[..],
                [
                    TrackWarning::NoPositions { .. },
                    TrackWarning::NoPositions { .. }
                ]
            ),
            "{:?}",
            file.warnings
        );
    }
}

#[test]
#[cfg_attr(
    not(shared),
    ignore = "needs the real recordings in ../shared/optitrack"
)]
fn trc_and_qtm() {
    {
        let file = tracks("trc_README_example.trc");
        assert_eq!(
            (file.format.to_string(), file.rate_hz, file.unit),
            ("trc".into(), 60.0, Unit::Millimetre)
        );
        assert_eq!(present(&file, PointKind::Marker), [("Marker1", 2)]);
        let place = file.points[0].position(1).unwrap();
        assert!((place - nalgebra::Vector3::new(1.1e-3, 2.1e-3, 3.1e-3)).norm() < 1e-15);
        assert_eq!(file.times, [0.0, 1.0 / 60.0]);
    }
    {
        let file = tracks("qtm_Measurement1_TRIMMED.tsv");
        assert_eq!(
            (file.format.to_string(), file.rate_hz, file.unit),
            ("qtm".into(), 100.0, Unit::Millimetre)
        );
        assert_eq!(
            present(&file, PointKind::Marker),
            [("New 0000", 2), ("New 0002", 2)]
        );
        let place = file.points[1].position(0).unwrap();
        assert!((place - nalgebra::Vector3::new(0.694_169, -0.183_362, 0.097_003)).norm() < 1e-15);
        // The header counts the frames of the whole recording.
        assert_eq!(
            file.warnings,
            [TrackWarning::FrameCount {
                header: 2000,
                rows: 2
            }]
        );
    }
}

#[test]
#[cfg_attr(
    not(shared),
    ignore = "needs the real recordings in ../shared/optitrack"
)]
fn no_sample_is_left_out() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/optitrack");
    let entries = fs::read_dir(&folder).unwrap();
    for entry in entries
        .flatten()
        .filter(|entry| entry.file_name() != "MANIFEST.md")
    {
        let bytes = fs::read(entry.path()).unwrap();
        let answer = read_tracks(&bytes, &entry.path());
        assert!(
            answer.is_ok(),
            "{}: {:?}",
            entry.path().display(),
            answer.err()
        );
    }
}

/// Expected contents of each file.
struct Expected {
    file: &'static str,
    format: &'static str,
    rate_hz: f64,
    unit: &'static str,
    frames: u64,
}

/// The figures of the collection's manifest.
const COLLECTION: [Expected; 12] = [
    Expected {
        file: "motive_v1.23_ernesto_rb_markers.csv",
        format: "motive-1.23",
        rate_hz: 120.0,
        unit: "m",
        frames: 499,
    },
    Expected {
        file: "motive_v1.23_pathviewr_feb20_trunc.csv",
        format: "motive-1.23",
        rate_hz: 100.0,
        unit: "m",
        frames: 100,
    },
    Expected {
        file: "motive_v1.23_pathviewr_rb100.csv",
        format: "motive-1.23",
        rate_hz: 100.0,
        unit: "m",
        frames: 934,
    },
    Expected {
        file: "motive_v1.24_slow5_EXCERPT.csv",
        format: "motive-1.24",
        rate_hz: 120.0,
        unit: "cm",
        frames: 8,
    },
    Expected {
        file: "tt_v1.0_olin.csv",
        format: "trackingtools-1.0",
        rate_hz: 250.0,
        unit: "m",
        frames: 1668,
    },
    Expected {
        file: "motive_v1.1_olin.csv",
        format: "motive-1.1",
        rate_hz: 120.0,
        unit: "m",
        frames: 548,
    },
    Expected {
        file: "motive_v1.1_tensegrity_unlabeled13.csv",
        format: "motive-1.1",
        rate_hz: 120.0,
        unit: "m",
        frames: 1694,
    },
    Expected {
        file: "tracker6_multi_brocku.txt",
        format: "tracker",
        rate_hz: 0.0,
        unit: "unknown",
        frames: 1,
    },
    Expected {
        file: "tracker_single_brocku.txt",
        format: "tracker",
        rate_hz: 31.25,
        unit: "unknown",
        frames: 2,
    },
    Expected {
        file: "tracker_wide_arnoldjames_EXCERPT.csv",
        format: "tracker",
        rate_hz: 30.0,
        unit: "unknown",
        frames: 6,
    },
    Expected {
        file: "qtm_Measurement1_TRIMMED.tsv",
        format: "qtm",
        rate_hz: 100.0,
        unit: "mm",
        frames: 2,
    },
    Expected {
        file: "trc_README_example.trc",
        format: "trc",
        rate_hz: 60.0,
        unit: "mm",
        frames: 2,
    },
];

#[test]
#[cfg_attr(
    not(shared),
    ignore = "needs the real recordings in ../shared/optitrack"
)]
fn the_figures_of_the_manifest() {
    for expected in COLLECTION {
        let held = tracks(expected.file);
        assert_eq!(held.format.to_string(), expected.format);
        // Stamps are rounded, or jitter; a single frame has no rate.
        if expected.frames > 1 {
            let off = held.rate_hz - expected.rate_hz;
            assert!(off.abs() <= 5e-3 * expected.rate_hz, "{}", held.rate_hz);
        }
        assert_eq!(held.unit.to_string(), expected.unit);
        assert_eq!(held.frames() as u64, expected.frames);
        assert!(!held.points.is_empty());
    }
}

/// If the recordings exist, no test of this file is ignored: a build from before they came is built again.
#[test]
fn the_real_recordings_are_tested_where_they_are() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/optitrack");
    assert_eq!(cfg!(shared), folder.is_dir(), "{}", folder.display());
}
