//! `--playable` holds for the gait as it is played: by the table's 512 knots, its pulses and the servos' dead band.

use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use crate::binary::{number, swimmer_in};

/// A folder with a swimmer of three equal links, whose side links keep 1.75 mm apart.
fn equal_links() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let text = "[links]\nmiddle = 0.1\nside = 0.1\n[drag]\nchi = 2.0\nc_t = { log_aspect = 4.0 }\n[servo]\nmax_angle = 2.8\n";
    std::fs::write(folder.path().join("equal.toml"), text).unwrap();
    folder
}

/// The pre-flight of a gait, which ends with this status.
#[track_caller]
fn preflight(folder: &Path, gait: &str, more: &[&str], status: i32) -> Value {
    let upload = [
        "robot",
        "upload",
        gait,
        "--dry-run",
        "--swimmer",
        "equal.toml",
        "--json",
    ];
    let ran = swimmer_in(folder, &[&upload, more].concat());
    ran.with_status(status).json()["preflight"].clone()
}

fn optimize(folder: &Path, words: &[&str]) {
    let within = ["--swimmer", "equal.toml", "-o", "best.gait", "--overwrite"];
    swimmer_in(folder, &[&["optimize"], words, &within].concat()).with_status(0);
}

/// These gaits run along the clearance, and the table cuts their corners: they came within 0.50 mm.
#[test]
fn a_playable_gait_keeps_the_robots_clearance_as_it_is_played() {
    let folder = equal_links();
    for words in [
        &["displacement", "--sign=-", "--playable"][..],
        &["turning", "--playable"],
    ] {
        optimize(folder.path(), words);
        let told = preflight(folder.path(), "best.gait", &[], 0);
        let (gap, margin) = (number(&told, "gap_m"), number(&told, "gap_margin_m"));
        assert!(
            gap >= margin && gap < 2.0 * margin,
            "{words:?}: {gap} {margin}"
        );
        assert_eq!(told["refused"], Value::Null, "{told:#}");
    }
}

#[test]
fn links_that_come_too_close_and_a_tank_that_is_too_small_are_refused() {
    let folder = equal_links();
    let within = [
        "displacement",
        "--sign=-",
        "--max-angle=2.8",
        "--clearance=0.0019",
    ];
    optimize(folder.path(), &within);
    let told = preflight(folder.path(), "best.gait", &[], 1);
    assert!(number(&told, "gap_m") < number(&told, "gap_margin_m"));
    let reason = told["refused"].as_str().unwrap();
    assert!(reason.contains("come within"), "{reason}");
    preflight(folder.path(), "circle:30deg", &["--tank=1x0.6"], 0);
    let told = preflight(folder.path(), "circle:30deg", &["--tank=0.25x0.2"], 1);
    let reason = told["refused"].as_str().unwrap();
    assert!(reason.contains("before the first cycle"), "{reason}");
}
