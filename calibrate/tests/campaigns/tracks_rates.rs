//! Clocks that files keep badly: rounded times, repeated times, repeated frame numbers, and the user's word against the file's.

use std::fmt::Write;
use std::path::Path;

use calibrate::{
    TrackError, TrackFile, TrackOptions, TrackProblem, TrackWarning, read_tracks_with,
};

fn read_at(text: &str, rate_hz: Option<f64>) -> Result<TrackFile, TrackError> {
    let options = TrackOptions {
        rate_hz,
        ..TrackOptions::default()
    };
    read_tracks_with(text.as_bytes(), Path::new("f"), &options)
}

fn read(text: &str) -> TrackFile {
    read_at(text, None).unwrap()
}

/// A table of a point that moves 1 mm a frame, its times written with `digits` digits.
fn table(rate_hz: f64, digits: usize, head: &str, cut: &str) -> String {
    let mut out = head.to_owned();
    for frame in 0..300 {
        let time = f64::from(frame) / rate_hz;
        writeln!(
            out,
            "{time:.digits$}{cut}{:.4}{cut}0.5",
            0.001 * f64::from(frame)
        )
        .unwrap();
    }
    out
}

#[test]
fn thirty_hertz_in_rounded_times() {
    for digits in [2, 3] {
        let file = read(&table(30.0, digits, "t,x1,y1\n", ","));
        assert!((file.rate_hz - 30.0).abs() < 0.03, "{}", file.rate_hz);
        assert!(matches!(
            file.warnings[..],
            [TrackWarning::RoundedTimes { .. }]
        ));
        let steps = file.times.windows(2).map(|pair| pair[1] - pair[0]);
        assert!(
            steps
                .into_iter()
                .all(|step| (step * 30.0 - 1.0).abs() < 1e-3)
        );
    }
}

#[test]
fn the_users_rate_wins_and_the_file_says_so() {
    for digits in [2, 3, 6] {
        let file = read_at(&table(30.0, digits, "t,x1,y1\n", ","), Some(29.97)).unwrap();
        assert!(
            (file.rate_hz - 29.97).abs() < 1e-12 && (file.times[299] * 29.97 - 299.0).abs() < 0.2
        );
        assert!(matches!(
            file.warnings[..],
            [TrackWarning::RateOverridden { .. }]
        ));
        assert!(
            file.warnings[0].to_string().contains("29.97"),
            "{}",
            file.warnings[0]
        );
    }
    // A header's word as well.
    let sample = include_str!("../formats/motive-1.23.csv");
    let file = read_at(sample, Some(50.0)).unwrap();
    let (one, other) = (file.times[1], file.times[0]);
    assert!((file.rate_hz - 50.0).abs() < 1e-12 && (one - other - 0.02).abs() < 1e-12);
    assert!(matches!(
        file.warnings[..],
        [TrackWarning::RateOverridden { file_hz, .. }] if (file_hz - 100.0).abs() < 1e-12
    ));
    // No warning if it is the file's own rate.
    assert!(read_at(sample, Some(100.0)).unwrap().warnings.is_empty());
}

#[test]
fn tracker_with_equal_rounded_times() {
    for head in ["ball\nt\tx\ty\n", "#multi:\n\tball\nt\tx\ty\n"] {
        let file = read(&table(120.0, 2, head, "\t"));
        assert_eq!(
            (file.format.to_string().as_str(), file.frames()),
            ("tracker", 300)
        );
        assert!((file.rate_hz - 120.0).abs() < 0.5, "{}", file.rate_hz);
        assert!((file.points[0].position(299).unwrap().x - 0.299).abs() < 1e-12);
    }
    // Side by side, each with the same times.
    let mut text = String::from("a,,,b,,\nt,x,y,t,x,y\n");
    for frame in 0..300 {
        let time = f64::from(frame) / 120.0;
        writeln!(text, "{time:.2},{frame},1,{time:.2},{frame},2").unwrap();
    }
    let file = read(&text);
    assert_eq!(file.frames(), 300);
    assert!((file.points[1].position(299).unwrap().x - 299.0).abs() < 1e-12);
}

#[test]
fn frame_numbers_that_repeat_beside_good_times() {
    let mut text = include_str!("../formats/motive-1.23.csv").to_owned();
    let clean = read(&text);
    text = text.replace("\n72215,", "\n72214,");
    let file = read(&text);
    assert_eq!(file.frames(), clean.frames());
    for (a, b) in file.times.iter().zip(&clean.times) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    assert!(
        file.warnings
            .iter()
            .any(|w| matches!(w, TrackWarning::Renumbered { count: 1, .. })),
        "{:?}",
        file.warnings
    );
    // Without good times it is still refused.
    let row = text
        .lines()
        .find(|line| line.starts_with("72214,"))
        .unwrap()
        .to_owned();
    let twice = text.replace(&row, &format!("{row}\r\n{row}"));
    assert!(matches!(
        read_at(&twice, None),
        Err(TrackError::Broken {
            problem: TrackProblem::FrameOrder { .. },
            ..
        })
    ));
}

#[test]
fn kinovea_writes_hours_minutes_seconds_hundredths() {
    let mut text = String::from("#Kinovea Trajectory data export\n#T X Y\n");
    for frame in 0..120 {
        let hundredths = frame * 100 / 30;
        let (whole, part) = (hundredths / 100, hundredths % 100);
        writeln!(text, "0:00:{whole:02}:{part:02} {frame}.00 45,5 ").unwrap();
    }
    assert!(
        read_at(&text, None).is_err(),
        "two decimal signs in one file"
    );
    let file = read(&text.replace(',', "."));
    assert!((file.rate_hz - 30.0).abs() < 0.1, "{}", file.rate_hz);
    assert_eq!(
        (file.points[0].name.as_str(), file.frames()),
        ("track 1", 120)
    );
}
