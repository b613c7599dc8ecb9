//! `robot play --playlist` on the simulated robot: gaits that join, one after the other.

use crate::binary::typed;
use serde_json::Value;

fn playlist(steps: &[(&str, u32, f64)]) -> tempfile::TempDir {
    let mut text = "format = \"swimmer playlist\"\nversion = 1\nswimmer = \"robot\"\n".to_owned();
    for (gait, cycles, period) in steps {
        let step =
            format!("[[step]]\ngait = \"{gait}\"\ncycles = {cycles}\nperiod_s = {period:?}\n");
        text.push_str(&step);
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("list.toml"), text).unwrap();
    folder
}

const PLAY: &str = "robot play --playlist list.toml --swimmer robot --port twin --json";

/// The displacement is that of the model, except for the effects of servos and ticks.
#[test]
fn a_playlist_is_played_to_its_end() {
    let folder = playlist(&[("circle:0.7", 3, 6.0), ("circle:0.7", 2, 9.0)]);
    let played = typed(folder.path(), PLAY).with_status(0).json();
    assert_eq!(played["state"], "stopped");
    assert_eq!(played["cause"], "finished");
    assert_eq!(played["steps"], 2);
    let once = typed(
        folder.path(),
        "simulate --swimmer robot --gait circle:0.7 --json",
    )
    .with_status(0)
    .json();
    let number = |value: &Value| value.as_f64().unwrap();
    let whole = 5.0 * number(&once["displacement_m"]);
    let foretold = number(&played["foretold"]["x_m"]);
    assert!((foretold / whole - 1.0).abs() < 0.05, "{foretold} {whole}");
    assert!(number(&played["foretold"]["rotation_rad"]).abs() < 1e-3);
    let seconds = number(&played["duration_s"]);
    assert!((seconds - 36.0).abs() < 1e-9, "{seconds}");
}

/// Gaits that do not join, and one that the servos cannot follow, are refused before anything moves.
#[test]
fn what_cannot_be_played_is_refused_first() {
    let folder = playlist(&[("circle:0.7", 3, 6.0), ("circle:0.9", 2, 9.0)]);
    let refused = typed(folder.path(), PLAY).with_status(2).json();
    let error = refused["error"].to_string();
    assert!(error.contains("step 2"), "{error}");
    let folder = playlist(&[("circle:0.7", 3, 6.0), ("circle:0.7", 2, 0.5)]);
    let refused = typed(folder.path(), PLAY).json();
    assert!(refused["error"].is_string(), "{refused}");
}

/// A link that carries a table in twice the time that the first step lasts: refused before the start, and the robot has not
/// moved. The same link has time enough if the step has more cycles.
#[cfg(unix)]
#[test]
fn a_link_that_is_too_slow_is_refused_before_the_start() {
    use crate::binary::TwinProcess;

    for faults in ["rate=400,buffer=8192", "delay=150,clump=230"] {
        let folder = playlist(&[
            ("circle:0.7", 1, 6.0),
            ("circle:0.7", 1, 6.5),
            ("circle:0.7", 1, 7.0),
        ]);
        let _twin = TwinProcess::start(folder.path(), &["--faults", faults]);
        let play = PLAY.replace("--port twin", "--port robot");
        let refused = typed(folder.path(), &play).with_status(1);
        let error = refused.json()["error"].to_string();
        assert!(
            error.contains("step 1 of the playlist is over after 6.0 s"),
            "{error}"
        );
        // The link still carries what was sent before, so that a greeting takes several tries.
        let status = (0..8)
            .map(|_| typed(folder.path(), "robot status --port robot --json"))
            .find(|ran| ran.status == 0)
            .expect("the link drains")
            .json();
        assert_eq!(status["state"], "stopped");
        assert_eq!(status["cause"], "boot", "it has moved: {status}");
    }
}
