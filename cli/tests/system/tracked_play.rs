//! `swimmer robot play --track`: each cycle against its prediction, on twins with and without faults.

use std::path::Path;

use serde_json::Value;

use crate::binary::{Ran, number, swimmer_in};
use crate::natnet_stream::Streaming;

fn play(folder: &Path, port: &str, source: &str, more: &[&str]) -> Ran {
    let words = [
        "robot",
        "play",
        "--gait",
        "circle:70deg",
        "--cycles",
        "3",
        "--period",
        "6",
        "--port",
        port,
        "--track",
        source,
    ];
    swimmer_in(folder, &[&words[..], more].concat())
}

/// Departures, in words.
fn departures(document: &Value) -> Vec<&str> {
    let listed = document["tracked"]["departures"].as_array().unwrap();
    listed.iter().map(|one| one.as_str().unwrap()).collect()
}

/// The virtual robot is the model: tracked and predicted displacement agree within the interval and the servos' run-in.
#[test]
fn a_faultless_play_is_as_predicted() {
    let folder = tempfile::tempdir().unwrap();
    let ran = play(folder.path(), "twin", "twin", &["--json"]).with_status(0);
    let document = ran.json();
    assert_eq!(document["cycles"], 3);
    let tracked = &document["tracked"];
    assert_eq!(tracked["cycles"], 3, "{document:#}");
    let (predicted, measured) = (&tracked["predicted"], &tracked["measured"]);
    for key in ["x_m", "y_m"] {
        let off = number(predicted, key) - number(measured, key);
        let size = number(predicted, "x_m").hypot(number(predicted, "y_m"));
        assert!(size > 0.01, "{document:#}");
        let tolerance = number(measured, "interval_m") + 0.02 * size;
        assert!(off.abs() < tolerance, "{document:#}");
    }
    assert!(number(measured, "interval_m") < 2e-3, "{document:#}");
    let turn = number(predicted, "rotation_rad") - number(measured, "rotation_rad");
    assert!(turn.abs() < 0.02, "{document:#}");
    assert!(departures(&document).is_empty(), "{document:#}");
    let cycles = ran.stderr.lines().filter(|line| line.starts_with("cycle "));
    assert_eq!(cycles.count(), 3, "{ran}");
}

/// Servos that turn 5 % less than the robot knows, in real time over `NatNet`.
#[test]
fn a_gain_of_less_than_one_is_reported_over_natnet() {
    let folder = tempfile::tempdir().unwrap();
    let slope = 0.0274 * 0.95;
    let servos = [
        format!("front:slope={slope}"),
        format!("back:slope={slope}"),
    ];
    let mut twin = Streaming::start(
        folder.path(),
        &["--servo", &servos[0], "--servo", &servos[1]],
    );
    let source = format!("natnet:{}", twin.cameras);
    let ran = play(folder.path(), &twin.robot, &source, &["--json"]).with_status(0);
    twin.end();
    let document = ran.json();
    let listed = departures(&document);
    assert_eq!(listed.len(), 1, "{document:#}");
    let (_, gain) = listed[0].split_once("the joints turn ").unwrap();
    let (gain, _) = gain.split_once(' ').unwrap();
    let gain: f64 = gain.parse().unwrap();
    assert!((gain - 95.0).abs() < 1.5, "{document:#}");
    // Printed when it was found: before the third cycle.
    let warned = ran.stderr.find("warning: the robot departs").unwrap();
    assert!(warned < ran.stderr.find("cycle 3:").unwrap(), "{ran}");
    // The clocks match: the cameras state their latency.
    let delay = document["tracked"]["camera_delay_s"].as_f64().unwrap();
    assert!(delay.abs() < 0.02, "{document:#}");
}

/// With a tank, the robot is stopped before it reaches a wall.
#[test]
fn a_wall_ends_the_play() {
    let folder = tempfile::tempdir().unwrap();
    let tank = ["--tank", "0.345x0.345", "--json"];
    let ran = play(folder.path(), "twin", "twin", &tank).with_status(1);
    assert!(ran.stderr.contains("nearer to a wall"), "{ran}");
    assert_eq!(ran.json()["state"], "stopped", "{ran}");
}

#[test]
fn a_prediction_needs_a_gait() {
    let folder = tempfile::tempdir().unwrap();
    let words = [
        "robot", "play", "--port", "twin", "--track", "twin", "--cycles", "1",
    ];
    let ran = swimmer_in(folder.path(), &words).with_status(2);
    assert!(ran.stderr.contains("--gait"), "{ran}");
}

/// A watcher sees the tracked pose next to the predicted one.
#[test]
fn a_watcher_sees_the_tracked_pose() {
    let folder = tempfile::tempdir().unwrap();
    let mut twin = Streaming::start(folder.path(), &[]);
    let source = format!("natnet:{}", twin.cameras);
    let words = [
        "robot",
        "watch",
        "--seconds",
        "3",
        "--port",
        &twin.robot,
        "--track",
        &source,
    ];
    let ran = swimmer_in(folder.path(), &words).with_status(0);
    twin.end();
    let lines = ran.stdout.lines().filter(|line| line.contains("tracked x"));
    assert!(lines.count() >= 2, "{ran}");
}
