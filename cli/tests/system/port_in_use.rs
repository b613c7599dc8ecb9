//! One program has the port; what a second one of the same user can do then: stop the robot, above all.

use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::binary::{Ran, TwinProcess, command, interrupt, swimmer_in};

/// A twin, and a play of many cycles that holds its port.
struct Scene {
    folder: tempfile::TempDir,
    _twin: TwinProcess,
    play: Child,
}

impl Scene {
    fn playing() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let twin = TwinProcess::start(folder.path(), &[]);
        swimmer_in(
            folder.path(),
            &["robot", "upload", "circle:30deg", "--port", "robot"],
        )
        .with_status(0);
        let words = [
            "robot", "play", "--cycles", "60", "--period", "2", "--port", "robot",
        ];
        let play = command(folder.path(), &words)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let scene = Self {
            folder,
            _twin: twin,
            play,
        };
        scene.wait_for("playing");
        scene
    }

    fn robot(&self, words: &[&str]) -> Ran {
        let words = [&["robot"], words, &["--port", "robot"]].concat();
        swimmer_in(self.folder.path(), &words)
    }

    fn status(&self) -> Value {
        self.robot(&["status", "--json"]).with_status(0).json()
    }

    fn wait_for(&self, state: &str) {
        wait_for(state, || self.status());
    }

    /// Exit status and output of the play.
    fn play_ended(mut self) -> (Option<i32>, String) {
        let status = self.play.wait().unwrap().code();
        let mut text = String::new();
        std::io::Read::read_to_string(&mut self.play.stderr.take().unwrap(), &mut text).unwrap();
        (status, text)
    }
}

fn wait_for(state: &str, status: impl Fn() -> Value) {
    let patience = Instant::now() + Duration::from_secs(20);
    loop {
        let status = status();
        if status["state"] == state {
            return;
        }
        assert!(Instant::now() < patience, "never {state}: {status:#}");
        sleep(Duration::from_millis(100));
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        let _ = self.play.kill();
        let _ = self.play.wait();
    }
}

#[test]
fn a_stop_reaches_the_robot_through_the_play_that_holds_the_port() {
    let scene = Scene::playing();
    let stopped = scene.robot(&["stop"]).with_status(0);
    assert!(
        stopped.stdout.contains("Stopped: the pulses are off."),
        "{stopped}"
    );
    assert_eq!(scene.status()["state"], "stopped");
    let (status, said) = scene.play_ended();
    assert_eq!(status, Some(1), "{said}");
    assert!(said.contains("a stop was requested"), "{said}");
}

#[test]
fn an_estop_does_too_and_stays_latched() {
    let scene = Scene::playing();
    let stopped = scene.robot(&["estop", "--json"]).with_status(0).json();
    assert_eq!(stopped["state"], "e-stopped", "{stopped:#}");
    assert_eq!(scene.status()["state"], "e-stopped");
    let (status, said) = scene.play_ended();
    assert_eq!(status, Some(1), "{said}");
}

#[test]
fn a_pause_and_a_resume_keep_the_play_that_holds_the_port_waiting() {
    let mut scene = Scene::playing();
    let is_detached = |status: &Value| {
        let flags = status["flags"].as_array().unwrap();
        flags.contains(&"detached".into())
    };
    // Without --detach the play's own link holds the pose, and without a limit.
    for (words, sentence, detached) in [
        (&["pause"][..], "this one need not wait", false),
        (&["pause", "--detach"], "at most 60 s, then stops", true),
    ] {
        let paused = scene.robot(words).with_status(0);
        assert!(paused.stdout.contains(sentence), "{paused}");
        let status = scene.status();
        assert_eq!(status["state"], "paused", "{status:#}");
        assert_eq!(is_detached(&status), detached, "{status:#}");
        scene.robot(&["resume"]).with_status(0);
        scene.wait_for("playing");
    }
    assert!(scene.play.try_wait().unwrap().is_none(), "the play goes on");
    interrupt(&scene.play);
    let (status, said) = scene.play_ended();
    assert_eq!(status, Some(1), "{said}");
    assert!(said.contains("Ctrl-C: the robot was stopped"), "{said}");
}

/// A second screen during the play: it receives the same telemetry, and ends with the play.
#[test]
fn a_watch_sees_the_robot_through_the_play_that_holds_the_port() {
    let scene = Scene::playing();
    let watched = scene.robot(&["watch", "--seconds", "3"]).with_status(0);
    let lines: Vec<&str> = watched.stdout.lines().collect();
    assert!(lines.len() >= 2, "{watched}");
    for line in &lines {
        assert!(line.contains("playing"), "{watched}");
    }
    assert!(lines.windows(2).all(|two| two[0] != two[1]), "{watched}");
    let words = ["watch", "--seconds", "0.5", "--json"];
    let status = scene.robot(&words).with_status(0).json();
    assert_eq!(status["state"], "playing", "{status:#}");
    // Frames are seen only by who has the port.
    let refused = scene.robot(&["watch", "--log", "w.mcap"]).with_status(1);
    assert!(refused.stderr.contains("has the port open"), "{refused}");

    let folder = scene.folder.path().to_owned();
    let words = ["robot", "watch", "--port", "robot"];
    let mut watch = command(&folder, &words)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // It must have come in before the play leaves, else it would have the port to itself.
    let mut shown = BufReader::new(watch.stdout.take().unwrap()).lines();
    let first = shown.next().unwrap().unwrap();
    assert!(first.contains("playing"), "{first}");
    scene.robot(&["stop"]).with_status(0);
    let (status, said) = scene.play_ended();
    assert_eq!(status, Some(1), "{said}");
    let watch = watch.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&watch.stderr);
    assert!(watch.status.success(), "{said}");
    assert!(said.contains("has let it go"), "{said}");
}

#[test]
fn what_needs_the_port_for_itself_is_told_who_has_it_and_how_to_stop() {
    let scene = Scene::playing();
    // The last stop, before this play, explains nothing of it.
    let told = scene.robot(&["status"]).with_status(0).stdout;
    assert_eq!(told.lines().next(), Some("  state      playing"), "{told}");
    assert_eq!(scene.status()["cause"], "boot");
    let refused = scene.robot(&["info"]).with_status(1);
    for words in [
        "`swimmer robot play` (process ",
        "`swimmer robot stop --port robot`",
    ] {
        assert!(refused.stderr.contains(words), "{refused}");
    }
    // The holder is known by every name of its port.
    let device = std::fs::read_link(scene.folder.path().join("robot")).unwrap();
    let words = ["robot", "stop", "--port", device.to_str().unwrap()];
    swimmer_in(scene.folder.path(), &words).with_status(0);
}

/// A program other than ours accepts no request, so the message must suffice.
#[test]
fn a_foreign_program_with_the_port_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let _twin = TwinProcess::start(folder.path(), &[]);
    let path = folder.path().join("robot");
    let port = host_link::port::SerialPort::open(path.to_str().unwrap(), 115_200).unwrap();
    let denied = stop(folder.path()).with_status(1);
    for words in [
        "another program has the port open",
        "(process ",
        "switch its power off",
    ] {
        assert!(denied.stderr.contains(words), "{denied}");
    }
    drop(port);
    stop(folder.path()).with_status(0);
}

fn stop(folder: &Path) -> Ran {
    swimmer_in(folder, &["robot", "stop", "--port", "robot"])
}

#[test]
fn a_detached_play_is_attached_to_again() {
    let folder = tempfile::tempdir().unwrap();
    let _twin = TwinProcess::start(folder.path(), &[]);
    let robot = |words: &[&str]| {
        let words = [&["robot"], words, &["--port", "robot", "--json"]].concat();
        swimmer_in(folder.path(), &words)
    };
    let nothing = robot(&["play", "--attach"]).with_status(1);
    assert!(nothing.stderr.contains("nothing to attach to"), "{nothing}");
    let begun = Instant::now();
    let detached = robot(&[
        "play",
        "--gait",
        "circle:30deg",
        "--cycles",
        "2",
        "--period",
        "2",
        "--detach",
    ])
    .with_status(0)
    .json();
    assert_eq!(detached["remaining_s"], 4.0, "{detached:#}");
    for _ in 0..2 {
        // The second time it has ended already; the answer is the same.
        let played = robot(&["play", "--attach"]).with_status(0).json();
        assert_eq!(
            (&played["cycles"], &played["cause"]),
            (&2.into(), &"finished".into()),
            "{played:#}"
        );
        assert_eq!(played["remaining_s"], 0.0, "{played:#}");
        assert!(
            begun.elapsed() >= Duration::from_secs(4),
            "{:?}",
            begun.elapsed()
        );
    }
}

/// Another play is refused before anything is sent, and the one that goes on is left alone.
#[test]
fn a_play_is_refused_while_one_goes_on_detached_and_leaves_it_alone() {
    let folder = tempfile::tempdir().unwrap();
    let _twin = TwinProcess::start(folder.path(), &[]);
    let robot = |words: &[&str]| {
        let words = [&["robot"], words, &["--port", "robot", "--json"]].concat();
        swimmer_in(folder.path(), &words)
    };
    let play = ["play", "--cycles", "60", "--period", "3"];
    robot(&["upload", "circle:30deg"]).with_status(0);
    robot(&[&play[..], &["--detach"]].concat()).with_status(0);
    let gait = robot(&["status"]).with_status(0).json()["gait"].clone();
    for more in [&[][..], &["--gait", "circle:50deg"]] {
        let refused = robot(&[&play[..], more].concat()).with_status(1);
        let reason = refused.json()["error"].as_str().unwrap().to_owned();
        for words in [
            " of 60, ",
            "`swimmer robot play --attach`",
            "`swimmer robot stop`",
        ] {
            assert!(reason.contains(words), "{refused}");
        }
        assert!(!refused.stderr.contains("ploading"), "{refused}");
        let status = robot(&["status"]).with_status(0).json();
        assert!(
            status["state"] == "playing" || status["state"] == "starting",
            "{status:#}"
        );
        assert_eq!(status["gait"], gait);
    }
    wait_for("playing", || robot(&["status"]).with_status(0).json());
    robot(&["pause", "--detach"]).with_status(0);
    let refused = robot(&play).with_status(1);
    assert!(
        refused.stderr.contains("`swimmer robot resume`"),
        "{refused}"
    );
    assert_eq!(robot(&["status"]).with_status(0).json()["state"], "paused");
    robot(&["stop"]).with_status(0);
}
