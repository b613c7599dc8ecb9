//! Real recordings from other laboratories. They are read in place and never committed; where the folder is missing, each
//! test says so and passes. Counts were made independently (Python's csv module).

use std::fs;
use std::path::{Path, PathBuf};

use calibrate::{PointKind, TrackError, TrackFile, Unit, read_tracks};

fn sample(name: &str) -> Option<(PathBuf, Vec<u8>)> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../shared/optitrack")
        .join(name);
    match fs::read(&path) {
        Ok(bytes) => Some((path, bytes)),
        Err(error) => {
            eprintln!(
                "SKIPPED: {} cannot be read ({error}); this test needs the real recording",
                path.display()
            );
            None
        }
    }
}

fn tracks(name: &str) -> Option<TrackFile> {
    let (path, bytes) = sample(name)?;
    Some(read_tracks(&bytes, &path).unwrap())
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
fn ernesto_has_solved_and_measured_markers_of_the_same_name() {
    let Some(file) = tracks("motive_v1.23_ernesto_rb_markers.csv") else {
        return;
    };
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
fn pathviewr_jumps_and_its_header_lies() {
    let Some(file) = tracks("motive_v1.23_pathviewr_rb100.csv") else {
        return;
    };
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
fn feb20_is_an_excel_re_save_with_bodies_that_were_never_seen() {
    let Some(file) = tracks("motive_v1.23_pathviewr_feb20_trunc.csv") else {
        return;
    };
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
fn slow5_has_a_time_code_column_and_centimetres() {
    let Some(file) = tracks("motive_v1.24_slow5_EXCERPT.csv") else {
        return;
    };
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

#[test]
fn every_other_file_is_named_by_its_format() {
    let expected = [
        ("tt_v1.0_olin.csv", "trackingtools-1.0"),
        ("motive_v1.1_olin.csv", "motive-1.1"),
        ("motive_v1.1_tensegrity_unlabeled13.csv", "motive-1.1"),
        ("qtm_Measurement1_TRIMMED.tsv", "qtm"),
        ("tracker6_multi_brocku.txt", "tracker"),
        ("tracker_single_brocku.txt", "tracker"),
        ("tracker_wide_arnoldjames_EXCERPT.csv", "tracker"),
        ("trc_README_example.trc", "trc"),
    ];
    for (name, wanted) in expected {
        let Some((path, bytes)) = sample(name) else {
            continue;
        };
        match read_tracks(&bytes, &path) {
            Err(TrackError::NotReadYet { format, .. }) => assert_eq!(format, wanted, "{name}"),
            other => panic!("{name}: {other:?}"),
        }
    }
}

#[test]
fn no_sample_is_left_out() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/optitrack");
    let Ok(entries) = fs::read_dir(&folder) else {
        eprintln!(
            "SKIPPED: {} is missing; this test needs the real recordings",
            folder.display()
        );
        return;
    };
    for entry in entries
        .flatten()
        .filter(|entry| entry.file_name() != "MANIFEST.md")
    {
        let bytes = fs::read(entry.path()).unwrap();
        let answer = read_tracks(&bytes, &entry.path());
        let wide = entry
            .file_name()
            .to_string_lossy()
            .starts_with("motive_v1.2");
        assert!(
            if wide {
                answer.is_ok()
            } else {
                matches!(answer, Err(TrackError::NotReadYet { .. }))
            },
            "{}",
            entry.path().display()
        );
    }
}
