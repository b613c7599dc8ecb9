//! The real firmware on an emulated board behind a pseudo-terminal: to the shipped binary it is hardware.

use std::path::{Path, PathBuf};

use emulator::{BoardConfig, BoardKind};

#[cfg(unix)]
use crate::binary::{TwinProcess, number, swimmer_in};

/// The words that lead to firmware and emulator from any folder. Where one is missing, the test fails and says what makes it.
pub(crate) fn board() -> [String; 4] {
    let target = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    let config = BoardConfig::of_checkout(
        Path::new(env!("CARGO_MANIFEST_DIR")),
        target.as_deref(),
        BoardKind::NanoConnect,
    );
    if let Some(missing) = config.missing() {
        panic!("{missing}");
    }
    let word = |path: &Path| path.to_str().unwrap().to_owned();
    [
        "--firmware".to_owned(),
        word(&config.firmware),
        "--emulator".to_owned(),
        word(&config.scripts),
    ]
}

#[cfg(unix)]
#[test]
fn the_firmware_is_driven_like_hardware() {
    let board = board();
    let folder = tempfile::tempdir().unwrap();
    let mut words = vec!["--robot", "emulator", "--firmware-log", "firmware.log"];
    words.extend(board.iter().map(String::as_str));
    let mut twin = TwinProcess::start(folder.path(), &words);
    let robot = |words: &[&str]| {
        let words = [&["robot"], words, &["--port", "robot", "--json"]].concat();
        swimmer_in(folder.path(), &words)
    };

    let info = robot(&["info"]).with_status(0).json();
    assert_eq!(info["board"], "Arduino Nano RP2040 Connect", "{info:#}");
    let uploaded = robot(&["upload", "circle:30deg"]).with_status(0).json();
    assert!(number(&uploaded, "knots") > 16.0, "{uploaded:#}");
    let played = robot(&["play", "--cycles", "1", "--period", "2"])
        .with_status(0)
        .json();
    assert_eq!(played["cycles"], 1, "{played:#}");
    robot(&["play", "--cycles", "60", "--period", "2", "--detach"]).with_status(0);
    let status = robot(&["status"]).with_status(0).json();
    assert!(
        ["starting", "playing"].contains(&status["state"].as_str().unwrap()),
        "{status:#}"
    );
    robot(&["stop"]).with_status(0);
    let status = robot(&["status"]).with_status(0).json();
    assert_eq!(status["state"], "stopped", "{status:#}");

    assert_eq!(twin.interrupt(), Some(0));
    let log = std::fs::read_to_string(folder.path().join("firmware.log")).unwrap();
    assert!(log.contains(" s INFO  swimmer firmware "), "{log}");
}

/// The real firmware on the emulated chip drives the twin's swimmer to poses: its pulses move the servos, the tank's cameras see the
/// swimmer, and the controller chooses each cycle by what they see. In the emulator's time.
fn driven_to(goal: &str) -> serde_json::Value {
    let board = board();
    let folder = tempfile::tempdir().unwrap();
    let gaits = crate::go::gaits();
    let line = format!(
        "robot go --port emulator --track twin --tank 1.2x1.2 --within 3mm,1deg {goal} --json"
    );
    let mut words: Vec<&str> = line.split(' ').collect();
    words.extend(["--gaits", &gaits]);
    words.extend(board.iter().map(String::as_str));
    let begun = std::time::Instant::now();
    let document = swimmer_in(folder.path(), &words).with_status(0).json();
    println!(
        "emulated board, {goal}: {:.2} mm and {:.2}° off after {} cycles and {:.0} s of the robot's time, {:.0} s of the test's",
        1e3 * number(&document, "off_m"),
        number(&document, "off_rad").to_degrees(),
        document["cycles"],
        number(&document, "duration_s"),
        begun.elapsed().as_secs_f64()
    );
    assert_eq!(document["reached"], true, "{document:#}");
    assert!(
        number(&document, "off_m") <= 3e-3 && number(&document, "off_rad") <= 1_f64.to_radians()
    );
    document
}

#[test]
#[ignore = "soak: minutes"]
fn the_firmware_is_driven_to_a_pose() {
    let document = driven_to("--to 0.05,0.0,0deg");
    let pose = &document["pose"];
    let off = (number(pose, "x_m") - 0.05).hypot(number(pose, "y_m"));
    assert!(
        off <= 3e-3 && number(&document, "cycles") >= 2.0,
        "{document:#}"
    );
}

#[test]
#[ignore = "soak: minutes"]
fn the_firmware_is_driven_through_the_tank() {
    for goal in [
        "--to 0.2,-0.1,90deg",
        "--via 0.1,0.05,0deg --to -0.05,0.05,0deg",
        "--to -0.1,-0.1,-90deg",
    ] {
        driven_to(goal);
    }
}
