//! Plain tables with named columns, and small files of our own making in every other format.

use std::path::Path;

use calibrate::{
    TrackError, TrackFile, TrackOptions, TrackProblem, TrackWarning, Unit, read_tracks,
    read_tracks_with,
};

fn read(text: &str) -> Result<TrackFile, TrackError> {
    read_tracks(text.as_bytes(), Path::new("run.csv"))
}

#[track_caller]
fn two_points(text: &str) -> TrackFile {
    let file = read(text).unwrap();
    assert_eq!(file.format.to_string(), "table");
    let places: Vec<Vec<Option<[f64; 2]>>> = file
        .points
        .iter()
        .map(|p| {
            (0..3)
                .map(|row| p.position(row).map(|v| [v.x, v.y]))
                .collect()
        })
        .collect();
    assert_eq!(
        places[0],
        [Some([1.0, 2.0]), Some([1.5, 2.5]), Some([2.0, 3.0])],
        "{text}"
    );
    assert_eq!(
        places[1],
        [Some([3.0, 4.0]), None, Some([4.0, 5.0])],
        "{text}"
    );
    assert!((file.rate_hz - 100.0).abs() < 1e-9 && file.frames() == 3);
    file
}

#[test]
fn delimiters_and_missing_values() {
    let file = two_points("t,x1,y1,x2,y2\n0,1,2,3,4\n0.01,1.5,2.5,,\n0.02,2,3,4,5\n");
    assert_eq!(
        file.points
            .iter()
            .map(|p| p.name.as_str())
            .collect::<Vec<_>>(),
        ["1", "2"]
    );
    assert_eq!(file.points[1].columns, ["x2", "y2"]);
    assert_eq!(file.unit, Unit::Metre);
    two_points("t;x1;y1;x2;y2\r\n0;1;2;3;4\r\n0,01;1,5;2,5;;\r\n0,02;2;3;4;5\r\n");
    two_points("t\tx1\ty1\tx2\ty2\n0\t1\t2\t3\t4\n0.01\t1.5\t2.5\t\t\n0.02\t2\t3\t4\t5\n");
    two_points("t x1 y1 x2 y2\n 0 1 2 3 4\n0.01 1.5 2.5 NaN nan\n0.02   2 3 4 5\n");
    two_points(
        "# recorded in tank 7\n# t x1 y1 x2 y2\n0 1 2 3 4\n0.01 1.5 2.5 NaN NaN\n0.02 2 3 4 5\n",
    );
    two_points(
        "\u{feff}Time (Seconds),x_front,y_front,x_back,y_back,note\n0,1,2,3,4,a\n0.01,1.5,2.5,NaN,NaN,b\n\n0.02,2,3,4,5,c\n",
    );
    two_points(
        "frame,time_ms,front_x,front_y,back_x,back_y\n7,0,1,2,3,4\n8,10,1.5,2.5,,\n9,20,2,3,4,5\n",
    );
}

#[test]
fn units_in_names_and_pixels() {
    let file = two_points(
        "t,x1_mm,y1_mm,x2_mm,y2_mm\n0,1000,2000,3000,4000\n0.01,1500,2500,,\n0.02,2000,3000,4000,5000\n",
    );
    assert_eq!(file.unit, Unit::Millimetre);
    two_points(
        "t [s],x1 [cm],y1 [cm],x2 [cm],y2 [cm]\n0,100,200,300,400\n0.01,150,250,,\n0.02,200,300,400,500\n",
    );
    // Pixels stay pixels until the user gives their length: there are no poses from them.
    let pixels = "t,x1_px,y1_px\n0,100,200\n0.01,150,250\n";
    let file = read(pixels).unwrap();
    assert_eq!((file.unit, file.unit.metres()), (Unit::Pixel, None));
    assert_eq!(
        file.points[0].position(1).unwrap().as_slice(),
        [150.0, 250.0, 0.0]
    );
    let options = TrackOptions {
        metres_per_unit: Some(0.5),
        ..TrackOptions::default()
    };
    let file = read_tracks_with(pixels.as_bytes(), Path::new("f"), &options).unwrap();
    assert_eq!(
        file.points[0].position(1).unwrap().as_slice(),
        [75.0, 125.0, 0.0]
    );
}

#[test]
fn pairs_that_the_caller_names() {
    let text = "t,east,north\n0,1,2\n0.01,3,4\n";
    assert!(matches!(
        read(text),
        Err(TrackError::Broken {
            problem: TrackProblem::NoPoints,
            ..
        })
    ));
    let pair = |x: &str, y: &str| TrackOptions {
        pairs: vec![[x.into(), y.into()]],
        ..TrackOptions::default()
    };
    let file = read_tracks_with(text.as_bytes(), Path::new("f"), &pair("east", "north")).unwrap();
    assert_eq!(
        (
            file.points[0].name.as_str(),
            file.points[0].position(1).unwrap().y
        ),
        ("east,north", 4.0)
    );
    let Err(error) = read_tracks_with(text.as_bytes(), Path::new("f"), &pair("east", "up")) else {
        panic!()
    };
    assert_eq!(
        error.to_string(),
        "f:1:1: there is no column `up`; the columns are t, east, north"
    );
}

#[test]
fn frames_need_a_rate() {
    let text = "frame,x1,y1\n10,1,2\n11,3,4\n";
    assert!(matches!(
        read(text),
        Err(TrackError::Broken {
            problem: TrackProblem::NoRate,
            ..
        })
    ));
    let options = TrackOptions {
        rate_hz: Some(50.0),
        ..TrackOptions::default()
    };
    let file = read_tracks_with(text.as_bytes(), Path::new("f"), &options).unwrap();
    assert_eq!((file.times[0], file.frame_numbers[1]), (0.2, 11));
}

#[test]
fn broken_tables_are_refused_with_their_place() {
    let broken = |text: &str| match read(text) {
        Err(TrackError::Broken { place, problem }) => (place.line, place.column, problem),
        other => panic!("{other:?}"),
    };
    let number = |text: &str, cell: &str| TrackProblem::NotANumber {
        text: text.into(),
        cell: cell.into(),
    };
    assert_eq!(
        broken("t,x1,y1\n0,1,2\n0.01,1,a\n"),
        (3, 8, number("a", "y1"))
    );
    assert_eq!(broken("t,x1,y1\n0,1,2\n,1,2\n"), (3, 1, number("", "time")));
    assert_eq!(
        broken("t,x1,y1\n0,1,2\n0.01,1\n"),
        (
            3,
            7,
            TrackProblem::RowLength {
                cells: 2,
                expected: 3
            }
        )
    );
    assert_eq!(
        broken("t,x1,y1\n0,1,2\n0,1,2\n"),
        (
            3,
            1,
            TrackProblem::TimeOrder {
                previous: 0.0,
                time: 0.0
            }
        )
    );
    assert_eq!(
        broken("t,x1,x1,y1\n0,1,2,3\n"),
        (1, 6, TrackProblem::TwiceTheSameColumn { name: "x1".into() })
    );
    assert_eq!(
        broken("t,x1,x2,y2\n0,1,2,3\n"),
        (
            1,
            3,
            TrackProblem::MissingAxis {
                point: "1".into(),
                axis: 'y'
            }
        )
    );
    assert_eq!(broken("t,x1,y1\n"), (1, 1, TrackProblem::NoData));
    assert_eq!(
        broken("t,\"x1,y1\n0,1,2\n"),
        (1, 3, TrackProblem::UnclosedQuote)
    );
    let file = read("t,x1,y1\n0,1,2\n0.01,3").unwrap();
    assert_eq!(file.warnings, [TrackWarning::LastLineCut { line: 3 }]);
}

#[test]
fn what_is_no_text_is_named() {
    let bytes: [(&[u8], &str); 4] = [
        (b"\x89HDF\r\n\x1a\n", "hdf5"),
        (b"PK\x03\x04\x14\0", "xlsx"),
        (b"\x02\x50\x01\0\0\0", "c3d"),
        (b"\x00\x01\x02", "binary"),
    ];
    for (bytes, wanted) in bytes {
        match read_tracks(bytes, Path::new("f")) {
            Err(TrackError::NotRead { format, .. }) => assert_eq!(format, wanted),
            other => panic!("{wanted}: {other:?}"),
        }
    }
    for text in [
        "hello world\n",
        "1,2\n3,4\n",
        "{\"a\": 1}\n",
        "a,b,c\n1,2,3\n",
    ] {
        assert!(read(text).is_err(), "{text}");
    }
}
