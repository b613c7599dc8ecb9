//! One witness for each rule of the wide format: one small file of our own making, changed in one way at a time. The
//! changed file must read as the same tracks, or be refused with its place.

use std::path::Path;

use calibrate::{PointKind, TrackError, TrackFile, TrackProblem, TrackWarning, Unit, read_tracks};

/// Two reflectors (one measured, one unlabeled), a rigid body, a solved marker with the measured one's name.
const SAMPLE: &str = "\
Format Version,1.23,Take Name,tank 7,Take Notes,,Capture Frame Rate,200.000000,Export Frame Rate,100.000000,Capture Start Time,2026-05-04 03.53.42.776 ,Total Frames in Take,4,Total Exported Frames,4,Rotation Type,Quaternion,Length Units,Meters,Coordinate Space,Global

,Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body Marker,Rigid Body Marker,Rigid Body Marker,Rigid Body Marker,Marker,Marker,Marker,Marker,Marker,Marker
,Name,robot,robot,robot,robot,robot,robot,robot,robot,\"robot:Front\",\"robot:Front\",\"robot:Front\",\"robot:Front\",robot:Front,robot:Front,robot:Front,Unlabeled 12,Unlabeled 12,Unlabeled 12
,ID,\"A1\",\"A1\",\"A1\",\"A1\",\"A1\",\"A1\",\"A1\",\"A1\",\"A1\",\"A1\",\"A1\",\"A1\",\"B2\",\"B2\",\"B2\",\"C3\",\"C3\",\"C3\"
,,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker Error,Position,Position,Position,Marker Quality,Position,Position,Position,Position,Position,Position
Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,,X,Y,Z,,X,Y,Z,X,Y,Z
0,0.000000,0.1,0.2,0.3,0.9,1.5,0.25,-2.5,0.001,1.25,0.5,-2.25,0.9,1.125,0.5,-2.125,1.75,0.5,-2.75
1,0.010000,,,,,,,,,,,,,1.126,0.5,-2.126,1.751,0.5,-2.751
2,0.020000,0.1,0.2,0.3,0.9,1.502,0.25,-2.502,0.001,1.252,0.5,-2.252,0.9,1.127,0.5,-2.127,,,
3,0.030000,0.1,0.2,0.3,0.9,1.503,0.25,-2.503,0.001,1.253,0.5,-2.253,0.9,1.128,0.5,-2.128,,,
";

fn read(text: &str) -> Result<TrackFile, TrackError> {
    read_tracks(text.as_bytes(), Path::new("run.csv"))
}

/// Names, kinds and every position, which a harmless change must keep.
type Content = Vec<(String, PointKind, Vec<Option<Vec<f64>>>)>;

fn content(file: &TrackFile) -> Content {
    let rows = 0..file.frames();
    let places = |point: &calibrate::TrackPoint| {
        rows.clone()
            .map(|row| point.position(row).map(|p| p.as_slice().to_vec()))
            .collect()
    };
    file.points
        .iter()
        .map(|point| (point.name.clone(), point.kind, places(point)))
        .collect()
}

#[track_caller]
fn same(changed: &[u8]) -> TrackFile {
    let file = read_tracks(changed, Path::new("run.csv")).unwrap();
    let original = read(SAMPLE).unwrap();
    assert_eq!(content(&file), content(&original));
    assert_eq!((file.rate_hz, &file.times), (100.0, &original.times));
    file
}

#[track_caller]
fn broken(text: &str) -> (usize, usize, TrackProblem) {
    match read(text) {
        Err(TrackError::Broken { place, problem }) => (place.line, place.column, problem),
        other => panic!("{other:?}"),
    }
}

/// Every line cut into cells, changed, and joined again.
fn per_cell(change: impl Fn(usize, &mut Vec<String>)) -> String {
    let lines = SAMPLE.lines().enumerate().map(|(index, line)| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        change(index, &mut cells);
        cells.join(",")
    });
    lines.map(|line| line + "\n").collect()
}

#[test]
fn the_sample_itself() {
    let file = read(SAMPLE).unwrap();
    let kinds: Vec<_> = file
        .points
        .iter()
        .map(|point| (point.name.as_str(), point.kind, point.id.as_str()))
        .collect();
    assert_eq!(
        kinds,
        [
            ("robot", PointKind::RigidBody, "A1"),
            ("robot:Front", PointKind::RigidBodyMarker, "A1"),
            ("robot:Front", PointKind::Marker, "B2"),
            ("Unlabeled 12", PointKind::Unlabeled, "C3")
        ]
    );
    // Rule 8: the export rate, not the capture rate; rule 5: blank is missing.
    assert_eq!(
        (file.rate_hz, file.unit, file.frames()),
        (100.0, Unit::Metre, 4)
    );
    assert_eq!(
        (
            file.points[0].present(),
            file.points[3].present(),
            file.points[3].longest_gap()
        ),
        (3, 2, 2)
    );
    // Rule 4: the position, not the quaternion in front of it nor the quality behind.
    assert_eq!(
        file.points[0].position(0).unwrap().as_slice(),
        [1.5, 0.25, -2.5]
    );
    assert!(file.warnings.is_empty());
}

#[test]
fn line_ends_marks_and_encodings() {
    same(SAMPLE.replace('\n', "\r\n").as_bytes());
    same(SAMPLE.replace('\n', "\r").as_bytes());
    same(format!("\u{feff}{SAMPLE}").as_bytes());
    same(SAMPLE.trim_end().as_bytes());
    let units: Vec<u16> = "\u{feff}"
        .encode_utf16()
        .chain(SAMPLE.encode_utf16())
        .collect();
    same(
        &units
            .iter()
            .flat_map(|unit| unit.to_le_bytes())
            .collect::<Vec<_>>(),
    );
    same(
        &units
            .iter()
            .flat_map(|unit| unit.to_be_bytes())
            .collect::<Vec<_>>(),
    );
    // An old code page in the take's name.
    let mut bytes = SAMPLE.as_bytes().to_vec();
    let at = SAMPLE.find("tank").unwrap();
    bytes[at] = 0xE4;
    same(&bytes);
}

#[test]
fn saved_again_from_a_spreadsheet() {
    // Rule 10: trailing commas, a row of commas for the empty one, plain numbers, no quotes, small letters.
    same(
        SAMPLE
            .replacen('\n', ",,,,,,\n", 1)
            .replacen("\n\n", "\n,,,,\n", 1)
            .as_bytes(),
    );
    same(
        SAMPLE
            .replace("100.000000", "100")
            .replace("200.000000", "200")
            .as_bytes(),
    );
    same(SAMPLE.replace('"', "").as_bytes());
    same(
        SAMPLE
            .replace("Frame,Time (Seconds),X", "frame,time (seconds),x")
            .as_bytes(),
    );
    same(SAMPLE.replace("\n0,0.000000", ",,\n0,0.000000").as_bytes());
    // A European one: semicolons and decimal commas.
    let european = same(SAMPLE.replace(',', ";").replace('.', ",").as_bytes());
    assert_eq!(european.format.to_string(), "motive-1.23");
    same(SAMPLE.replace(',', "\t").as_bytes());
}

#[test]
fn headers_by_meaning_not_by_row() {
    // Rule 1: no empty second row; an empty row more; rows in another order.
    same(SAMPLE.replacen("\n\n", "\n", 1).as_bytes());
    same(SAMPLE.replacen("\n\n", "\n\n\n", 1).as_bytes());
    let mut lines: Vec<&str> = SAMPLE.lines().collect();
    lines.swap(2, 4);
    same(lines.join("\n").as_bytes());
    // Format 1.21: no labels, rows known by their order.
    same(
        SAMPLE
            .replace("\n,Type,", "\n,,")
            .replace("\n,Name,", "\n,,")
            .replace("\n,ID,", "\n,,")
            .replace("1.23", "1.21")
            .as_bytes(),
    );
    // Format 1.25: a Parent row.
    let parent = format!("\n,Parent{}\n,,Rotation", ",A1".repeat(18));
    same(SAMPLE.replacen("\n,,Rotation", &parent, 1).as_bytes());
    // Rule 11: keys by name.
    same(SAMPLE.replace("Take Notes,,", "").as_bytes());
    same(
        SAMPLE
            .replace(
                "Total Frames in Take",
                "Capture Start Frame,1070265,Total Frames in Take",
            )
            .as_bytes(),
    );
    same(SAMPLE.replace("tank 7", "\"tank 7, warm\"").as_bytes());
    same(SAMPLE.replace("tank 7", "Export Frame Rate").as_bytes());
}

#[test]
fn a_time_code_column_moves_the_data() {
    // Rule 2 (1.24).
    let text = per_cell(|line, cells| {
        let code = match line {
            0 | 1 => return,
            6 => "TimeCode",
            7.. => "15:54:48:28.03",
            _ => "",
        };
        cells.insert(2, code.to_owned());
    });
    same(text.as_bytes());
}

#[test]
fn capture_time_is_text() {
    // Rule 9.
    for start in [
        "2019-09-18 04.30.02.695 PM",
        "2018-10-05 12.05.03.445 P.M.",
        "",
        "yesterday",
    ] {
        same(SAMPLE.replace("2026-05-04 03.53.42.776 ", start).as_bytes());
    }
}

#[test]
fn units_scale_and_are_never_guessed() {
    // Rule 7.
    let original = read(SAMPLE).unwrap();
    for (name, unit, metres) in [
        ("Centimeters", Unit::Centimetre, 0.01),
        ("Millimeters", Unit::Millimetre, 0.001),
    ] {
        let file = read(&SAMPLE.replace("Meters", name)).unwrap();
        assert_eq!(file.unit, unit);
        let (a, b) = (
            file.points[2].position(0).unwrap(),
            original.points[2].position(0).unwrap(),
        );
        assert!((a - b * metres).norm() < 1e-15);
    }
    let (line, column, problem) = broken(&SAMPLE.replace("Meters", "Feet"));
    assert_eq!(
        (line, column, problem),
        (
            1,
            238,
            TrackProblem::UnknownUnit {
                text: "Feet".into()
            }
        )
    );
    let (_, _, problem) = broken(&SAMPLE.replace("Length Units,Meters,", ""));
    assert_eq!(
        problem,
        TrackProblem::NoKey {
            key: "Length Units"
        }
    );
    let (_, _, problem) = broken(&SAMPLE.replace("Global", "Local"));
    assert_eq!(
        problem,
        TrackProblem::CoordinateSpace {
            text: "Local".into()
        }
    );
}

#[test]
fn names_alone_are_not_unique() {
    // Rule 3: the same name under two IDs.
    let file = read(&SAMPLE.replace("Unlabeled 12", "robot:Front")).unwrap();
    let ids: Vec<_> = file
        .points
        .iter()
        .filter(|p| p.name == "robot:Front")
        .map(|p| p.id.as_str())
        .collect();
    assert_eq!(ids, ["A1", "B2", "C3"]);
    // ... and with the ID row lost altogether.
    let lost: String = SAMPLE
        .replace("Unlabeled 12", "robot:Front")
        .lines()
        .filter(|l| !l.starts_with(",ID"))
        .map(|l| l.to_owned() + "\n")
        .collect();
    assert_eq!(read(&lost).unwrap().points.len(), 4);
}

#[test]
fn unlabeled_names() {
    // Rule 6.
    for name in [
        "Unlabeled:108",
        "Unlabeled 2278",
        "Unlabeled1",
        "Marker-49813",
    ] {
        let file = read(&SAMPLE.replace("Unlabeled 12", name)).unwrap();
        assert_eq!(
            (file.points[3].kind, file.points[3].name.as_str()),
            (PointKind::Unlabeled, name)
        );
    }
    for name in ["Unlabeled", "Unlabeled back", "Marker1"] {
        assert_eq!(
            read(&SAMPLE.replace("Unlabeled 12", name)).unwrap().points[3].kind,
            PointKind::Marker,
            "{name}"
        );
    }
    let typed = per_cell(|line, cells| {
        if line == 2 {
            for cell in cells.iter_mut().rev().take(3) {
                "Unlabeled Marker".clone_into(cell);
            }
        }
    });
    assert_eq!(read(&typed).unwrap().points[3].kind, PointKind::Unlabeled);
}

#[test]
fn columns_that_are_no_position() {
    // Rule 4: a marker size after the axes, as Motive 3 exports it; rule 13: Euler angles instead of a quaternion.
    let sized = per_cell(|line, cells| match line {
        0 | 1 => {}
        5 => cells.insert(17, "Size".into()),
        6 => cells.insert(17, "X".into()),
        7.. => cells.insert(17, "8.5".into()),
        _ => cells.insert(17, cells[16].clone()),
    });
    same(sized.as_bytes());
    same(
        SAMPLE
            .replace("Quaternion", "XYZ")
            .replace(
                "Frame,Time (Seconds),X,Y,Z,W",
                "Frame,Time (Seconds),X,Y,Z,X",
            )
            .as_bytes(),
    );
}

#[test]
fn frames_that_jump_or_do_not_grow() {
    // Rule 8.
    let text = SAMPLE
        .replace("\n0,0.000000", "\n72210,722.100000")
        .replace("\n1,0.010000", "\n72211,722.110000");
    let text = text
        .replace("\n2,0.020000", "\n72215,722.150000")
        .replace("\n3,0.030000", "\n72216,722.160000");
    let file = read(&text).unwrap();
    assert_eq!((file.frame_numbers[0], file.times[2]), (72_210, 722.15));
    assert_eq!(
        file.warnings,
        [TrackWarning::FrameJumps {
            jumps: 1,
            frames: 3
        }]
    );
    // The number of the frame before, at a time of its own: the time counts.
    let file = read(&SAMPLE.replace("\n2,", "\n1,")).unwrap();
    assert!((file.times[2] - 0.02).abs() < 1e-12);
    assert_eq!(
        file.warnings,
        [
            TrackWarning::FrameJumps {
                jumps: 1,
                frames: 1
            },
            TrackWarning::Renumbered {
                count: 1,
                first_line: 10
            }
        ]
    );
    let (line, column, problem) = broken(&SAMPLE.replace("\n2,0.020000", "\n1,0.010000"));
    assert_eq!(
        (line, column, problem),
        (
            10,
            1,
            TrackProblem::FrameOrder {
                previous: 1,
                frame: 1
            }
        )
    );
    let (line, column, problem) = broken(&SAMPLE.replace("\n2,", "\n2.5,"));
    assert_eq!(
        (line, column, problem),
        (10, 1, TrackProblem::NotAFrameNumber { text: "2.5".into() })
    );
    let file = read(&SAMPLE.replace("Export Frame Rate,100", "Export Frame Rate,120")).unwrap();
    assert!(
        matches!(
            file.warnings[..],
            [TrackWarning::TimeColumn {
                column_used: true,
                ..
            }]
        ) && (file.rate_hz - 100.0).abs() < 1e-9,
        "{:?}",
        file.warnings
    );
    let file = read(&SAMPLE.replace("Exported Frames,4", "Exported Frames,190951")).unwrap();
    assert_eq!(
        file.warnings,
        [TrackWarning::FrameCount {
            header: 190_951,
            rows: 4
        }]
    );
}

#[test]
fn a_version_that_was_never_seen_is_read_with_a_warning() {
    let file = same(SAMPLE.replace("1.23", "1.31").as_bytes());
    assert_eq!(file.warnings, [TrackWarning::UnseenVersion("1.31".into())]);
    assert_eq!(
        same(SAMPLE.replace("1.23", "1.2").as_bytes())
            .format
            .to_string(),
        "motive-1.2"
    );
}

#[test]
fn a_broken_file_is_refused_with_its_place() {
    // An unclosed quote, in the head and among the data, would swallow the rest of the file.
    let (line, column, problem) = broken(&SAMPLE.replacen("\"robot:Front\"", "\"robot:Front", 1));
    assert_eq!((line, column, problem), (4, 69, TrackProblem::AfterQuote));
    let (line, column, problem) = broken(&SAMPLE.replace("1.127", "\"1.127"));
    assert_eq!(
        (line, column, problem),
        (10, 73, TrackProblem::UnclosedQuote)
    );
    let crlf = SAMPLE.replace("1.127", "\"1.127").replace('\n', "\r\n");
    assert_eq!(broken(&crlf).0, 10);

    let (line, column, problem) = broken(&SAMPLE.replace("-2.127", "-2.1x7"));
    let expected = TrackProblem::NotANumber {
        text: "-2.1x7".into(),
        cell: "robot:Front, Position Z".into(),
    };
    assert_eq!((line, column, problem), (10, 83, expected));
    let (line, _, problem) = broken(&SAMPLE.replace(",1.751,0.5,-2.751", ""));
    assert_eq!(
        (line, problem),
        (
            9,
            TrackProblem::RowLength {
                cells: 17,
                expected: 20
            }
        )
    );
    let (line, _, problem) = broken(&SAMPLE.replace("-2.751\n2,", "-2.751,2,"));
    assert_eq!(
        (line, problem),
        (
            9,
            TrackProblem::RowLength {
                cells: 40,
                expected: 20
            }
        )
    );
    assert_eq!(
        broken(&SAMPLE.replace("Frame,Time", "Fr,Time")),
        (1, 1, TrackProblem::NoAxisRow)
    );
    let (line, column, problem) = broken(&SAMPLE.replace("Time (Seconds)", "When"));
    assert_eq!(
        (line, column, problem),
        (
            7,
            7,
            TrackProblem::NoTimeColumn {
                text: "When".into()
            }
        )
    );
    let (line, column, problem) =
        broken(&SAMPLE.replace("Export Frame Rate,100.000000", "Export Frame Rate,fast"));
    assert_eq!(
        (line, column, problem),
        (
            1,
            98,
            TrackProblem::Rate {
                text: "fast".into()
            }
        )
    );
    assert_eq!(
        broken(SAMPLE.split_once("\n0,").unwrap().0),
        (7, 1, TrackProblem::NoData)
    );
    assert_eq!(
        broken(&SAMPLE.replace("Position", "Rotation")),
        (7, 1, TrackProblem::NoPoints)
    );
    let lost = SAMPLE.replace(",X,Y,Z\n", ",X,Y,Q\n");
    assert_eq!(
        broken(&lost).2,
        TrackProblem::MissingAxis {
            point: "Unlabeled 12".into(),
            axis: 'Z'
        }
    );
    let (line, _, problem) = broken(&SAMPLE[SAMPLE.find(",Type").unwrap()..]);
    assert_eq!(
        (line, problem),
        (
            1,
            TrackProblem::NoKey {
                key: "Format Version"
            }
        )
    );
    assert!(matches!(read(""), Err(TrackError::Empty { .. })));
    assert!(matches!(read("\n\n,,\n"), Err(TrackError::Empty { .. })));
}

#[test]
fn a_last_line_that_was_cut_is_left_out() {
    let cut = &SAMPLE[..SAMPLE.rfind("0.25,-2.503").unwrap()];
    let file = read(cut).unwrap();
    assert_eq!(file.frames(), 3);
    assert!(
        file.warnings
            .contains(&TrackWarning::LastLineCut { line: 11 }),
        "{:?}",
        file.warnings
    );
}

#[test]
fn half_a_position_is_no_position() {
    let file = read(
        &SAMPLE
            .replace("1.127,0.5,", "1.127,,")
            .replace("1.128,0.5,", "1.128,NaN,"),
    )
    .unwrap();
    assert_eq!(file.points[2].present(), 2);
    assert_eq!(
        file.warnings,
        [TrackWarning::HalfBlank {
            count: 2,
            first_line: 10
        }]
    );
}

#[test]
fn an_export_without_header_needs_a_scale_and_tells_rotations_from_places() {
    // Rule 5. Nothing says that the first four columns are a quaternion, but they look like one.
    let sample = SAMPLE.replace("0.1,0.2,0.3,0.9", "0.0,0.6,0.0,0.8");
    let data = &sample[sample.find("0,0.000000").unwrap()..];
    let (line, column, problem) = broken(data);
    assert_eq!(
        (line, column, problem),
        (1, 12, TrackProblem::LooksLikeRotation)
    );
    let two = |columns: usize| {
        let rows = (0..4).map(|k| format!("{k},{:.6}", f64::from(k) / 120.0));
        let ended: Vec<String> = rows
            .map(|row| row + &",1.5".repeat(columns) + "\n")
            .collect();
        ended.concat()
    };
    assert_eq!(
        broken(&two(7)),
        (1, 1, TrackProblem::Triples { columns: 7 })
    );
    let file = read(&two(6)).unwrap();
    assert_eq!(
        (file.rate_hz, file.points.len(), file.unit.metres()),
        (120.0, 2, None)
    );
    assert_eq!(file.warnings, [TrackWarning::NoHeader]);
}
