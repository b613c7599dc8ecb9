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
