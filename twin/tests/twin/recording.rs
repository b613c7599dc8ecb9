//! Tracking files of whole plays: format, accuracy, reproducibility.

use std::fs;

use crate::play::{circle, play_recorded, robot, table};
use swimmer_model::Pose;
use twin::{CameraConfig, TwinConfig};

/// Cells of a file by row, after the format checks common to all tests.
fn read(path: &std::path::Path) -> (Vec<Vec<String>>, Vec<Vec<String>>) {
    let text = fs::read_to_string(path).unwrap();
    assert!(
        text.is_ascii()
            && text.ends_with("\r\n")
            && !text.replace("\r\n", "").contains(['\r', '\n'])
    );
    let rows: Vec<Vec<String>> = text
        .split_terminator("\r\n")
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect();
    let (head, data) = rows.split_at(7);
    assert!(data.iter().chain(&head[2..]).all(|row| row.len() == 14));
    (head.to_vec(), data.to_vec())
}

fn number(cell: &str) -> Option<f64> {
    (!cell.is_empty()).then(|| cell.parse().unwrap())
}

#[test]
fn a_recording_has_motive_s_form_and_the_right_totals() {
    let folder = tempfile::tempdir().unwrap();
    let track = folder.path().join("track.csv");
    let played = play_recorded(
        TwinConfig::new(&robot(), 5),
        &table(64, &circle(1.0)),
        1,
        8.0,
        Some(&track),
    );
    let recording = played.recording.unwrap();
    let (head, data) = read(&track);
    assert_eq!(data.len() as u64, recording.frames);
    let header: std::collections::HashMap<&str, &str> = head[0]
        .chunks(2)
        .map(|pair| (&*pair[0], &*pair[1]))
        .collect();
    assert_eq!(header["Format Version"], "1.23");
    assert_eq!(header["Capture Frame Rate"], "100.000000");
    assert_eq!(header["Length Units"], "Meters");
    assert_eq!(
        header["Total Exported Frames"].parse(),
        Ok(recording.frames)
    );
    assert_eq!(head[1], [""]);
    assert_eq!((&*head[6][0], &*head[6][1]), ("Frame", "Time (Seconds)"));
    for (index, row) in data.iter().enumerate() {
        assert_eq!(row[0], index.to_string());
        assert_eq!(row[1], format!("{:.6}", index as f64 / 100.0));
        for point in row[2..].chunks(3) {
            let blanks = point.iter().filter(|cell| cell.is_empty()).count();
            assert!(
                blanks == 0 || blanks == 3,
                "a point is there or not: {row:?}"
            );
        }
    }
    // Both occur: drop-outs of the reflectors, and ghosts.
    assert!(data.iter().any(|row| row[2].is_empty()) && data.iter().any(|row| row[5].is_empty()));
    assert!(
        data.iter().any(|row| !row[8].is_empty()) && data.iter().any(|row| !row[11].is_empty())
    );
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn perfect_cameras_see_the_truth_in_motive_s_axes() {
    let folder = tempfile::tempdir().unwrap();
    let track = folder.path().join("track.csv");
    let mut config = TwinConfig::new(&robot(), 6);
    config.camera = CameraConfig::perfect();
    let half = 0.5 * config.swimmer.links.middle;
    let played = play_recorded(config, &table(64, &circle(1.0)), 2, 8.0, Some(&track));
    let recording = played.recording.unwrap();
    let (_, data) = read(&track);
    assert_eq!(recording.cycle_starts, played.cycle_starts);
    for start in &recording.cycle_starts {
        let index = start.at.abs_diff(recording.started).as_millis() / 10;
        let row = &data[usize::try_from(index).unwrap()];
        let cells: Vec<f64> = row[2..8].iter().map(|cell| number(cell).unwrap()).collect();
        // (x, y) is (Z, X).
        let front = [cells[2], cells[0]];
        let back = [cells[5], cells[3]];
        let seen = Pose::new(
            0.5 * (front[0] + back[0]),
            0.5 * (front[1] + back[1]),
            (front[1] - back[1]).atan2(front[0] - back[0]),
        );
        let length = (front[0] - back[0]).hypot(front[1] - back[1]);
        assert!((length - 2.0 * half).abs() < 3e-6);
        assert!((seen.x - start.pose.x).abs() < 2e-6 && (seen.y - start.pose.y).abs() < 2e-6);
        let turn = (seen.theta - start.pose.theta).rem_euclid(std::f64::consts::TAU);
        assert!(
            !(5e-5..=std::f64::consts::TAU - 5e-5).contains(&turn),
            "{seen:?} {start:?}"
        );
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_seed_others() {
    let folder = tempfile::tempdir().unwrap();
    let run = |name: &str, seed| {
        let track = folder.path().join(name);
        let played = play_recorded(
            TwinConfig::new(&robot(), seed),
            &table(64, &circle(0.8)),
            1,
            6.0,
            Some(&track),
        );
        (fs::read(&track).unwrap(), format!("{:?}", played.telemetry))
    };
    let (first, second, other) = (
        run("first.csv", 7),
        run("second.csv", 7),
        run("other.csv", 8),
    );
    assert_eq!(first, second);
    assert_ne!(first.0, other.0);
}

#[test]
fn two_recordings_of_one_twin_are_two_files() {
    let folder = tempfile::tempdir().unwrap();
    let mut twin = twin::Twin::new(TwinConfig::new(&robot(), 7)).unwrap();
    let mut seconds = 0;
    let mut record = |name: &str| {
        let track = folder.path().join(name);
        twin.start_recording(&track).unwrap();
        seconds += 1;
        twin.advance(std::time::Duration::from_secs(seconds));
        let recording = twin.finish_recording().unwrap().unwrap();
        (recording.frames, fs::read(&track).unwrap())
    };
    let (first, second) = (record("1.csv"), record("2.csv"));
    // Frames at both ends of the first second.
    assert_eq!((first.0, second.0), (101, 101));
    assert_ne!(first.1, second.1);
    assert!(twin.finish_recording().unwrap().is_none());
}
