//! The shipped binary on both sides of a real pseudo-terminal: `swimmer twin --pty` there, `swimmer robot` here.

use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::binary::{command, interrupt, number, swimmer_in};

/// A `swimmer twin` process; interrupted and waited for at the end, so that none outlives its test.
struct TwinProcess {
    child: Child,
    link: PathBuf,
}

impl TwinProcess {
    fn start(folder: &Path, more: &[&str]) -> Self {
        let mut words = vec!["twin", "--pty", "robot"];
        words.extend(more);
        let child = command(folder, &words)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let twin = Self {
            child,
            link: folder.join("robot"),
        };
        let patience = Instant::now() + Duration::from_secs(20);
        while !twin.link.exists() {
            assert!(
                Instant::now() < patience,
                "the twin made no link {}",
                twin.link.display()
            );
            sleep(Duration::from_millis(20));
        }
        twin
    }

    /// Ctrl-C, then the exit status.
    fn interrupt(&mut self) -> Option<i32> {
        interrupt(&self.child);
        self.child.wait().unwrap().code()
    }
}

impl Drop for TwinProcess {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn upload_play_and_stop(faults: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let mut twin = TwinProcess::start(folder.path(), faults);
    let robot = |words: &[&str]| {
        swimmer_in(
            folder.path(),
            &[&["robot"], words, &["--port", "robot", "--json"]].concat(),
        )
    };

    let info = robot(&["info"]).with_status(0).json();
    assert_eq!(info["board"], "twin", "{info:#}");
    let uploaded = robot(&["upload", "circle:30deg"]).with_status(0).json();
    assert!(number(&uploaded, "knots") > 16.0, "{uploaded:#}");

    let begun = Instant::now();
    let played = robot(&["play", "--cycles", "1", "--period", "2"])
        .with_status(0)
        .json();
    assert_eq!(played["cycles"], 1, "{played:#}");
    assert!(
        begun.elapsed() >= Duration::from_secs(2),
        "a cycle of 2 s was over after {:?}",
        begun.elapsed()
    );

    // Stop from another process while a third one plays.
    let mut playing = command(
        folder.path(),
        &[
            "robot", "play", "--cycles", "60", "--period", "2", "--detach", "--port", "robot",
        ],
    )
    .stdout(Stdio::null())
    .spawn()
    .unwrap();
    assert!(playing.wait().unwrap().success());
    let status = robot(&["status"]).with_status(0).json();
    assert!(
        ["starting", "playing"].contains(&status["state"].as_str().unwrap()),
        "{status:#}"
    );
    robot(&["stop"]).with_status(0);
    let status = robot(&["status"]).with_status(0).json();
    assert_eq!(status["state"], "stopped", "{status:#}");

    assert_eq!(twin.interrupt(), Some(0));
    assert!(
        !folder.path().join("robot").exists(),
        "the twin removes its link"
    );
}

#[test]
fn upload_play_and_stop_through_a_clean_line() {
    upload_play_and_stop(&[]);
}

#[test]
fn upload_play_and_stop_with_five_per_cent_of_frames_dropped() {
    upload_play_and_stop(&["--faults", "drop=5%", "--seed", "7"]);
}

#[test]
fn ctrl_c_stops_the_robot_first() {
    let folder = tempfile::tempdir().unwrap();
    let _twin = TwinProcess::start(folder.path(), &[]);
    let robot = |words: &[&str]| {
        swimmer_in(
            folder.path(),
            &[&["robot"], words, &["--port", "robot", "--json"]].concat(),
        )
    };
    robot(&["upload", "circle:30deg"]).with_status(0);
    let mut playing = command(
        folder.path(),
        &["robot", "play", "--period", "4", "--port", "robot"],
    )
    .stdout(Stdio::null())
    .stderr(Stdio::null())
    .spawn()
    .unwrap();
    sleep(Duration::from_secs(2));
    assert!(
        playing.try_wait().unwrap().is_none(),
        "play without --cycles goes on until Ctrl-C"
    );
    interrupt(&playing);
    playing.wait().unwrap();
    let status = robot(&["status"]).with_status(0).json();
    assert_eq!(status["state"], "stopped", "{status:#}");
    assert_eq!(status["cause"], "requested", "{status:#}");
}

#[test]
fn a_stale_link_is_replaced_and_a_file_is_not() {
    let folder = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink("/dev/pts/no-such-terminal", folder.path().join("robot")).unwrap();
    let mut twin = TwinProcess::start(folder.path(), &[]);
    assert_eq!(twin.interrupt(), Some(0));

    std::fs::write(folder.path().join("robot"), "precious").unwrap();
    swimmer_in(folder.path(), &["twin", "--pty", "robot"]).with_status(2);
    assert_eq!(
        std::fs::read_to_string(folder.path().join("robot")).unwrap(),
        "precious"
    );
}
