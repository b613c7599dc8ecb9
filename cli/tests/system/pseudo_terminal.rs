//! The shipped binary on both sides of a real pseudo-terminal: `swimmer twin --pty` there, `swimmer robot` here.

use std::io::{BufRead, BufReader};
use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::binary::{TwinProcess, command, interrupt, number, swimmer_in};

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

#[test]
fn pause_resume_and_estop() {
    let folder = tempfile::tempdir().unwrap();
    let _twin = TwinProcess::start(folder.path(), &[]);
    let words =
        |words: &[&'static str]| [&["robot"], words, &["--port", "robot", "--json"]].concat();
    let robot = |asked: &[&'static str]| swimmer_in(folder.path(), &words(asked));
    let holding = |asked: &[&'static str]| {
        command(folder.path(), &words(asked))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap()
    };
    let state = || {
        robot(&["status"]).with_status(0).json()["state"]
            .as_str()
            .unwrap()
            .to_owned()
    };

    robot(&[
        "play",
        "--gait",
        "circle:30deg",
        "--cycles",
        "60",
        "--period",
        "2",
        "--detach",
    ])
    .with_status(0);
    sleep(Duration::from_secs(2));
    robot(&["pause", "--detach"]).with_status(0);
    assert_eq!(state(), "paused");
    let mut resumed = holding(&["resume"]);
    sleep(Duration::from_secs(1));
    interrupt(&resumed);
    assert_eq!(
        resumed.wait().unwrap().code(),
        Some(1),
        "a play that was cut short has failed"
    );
    assert_eq!(state(), "stopped");

    robot(&["estop"]).with_status(0);
    assert_eq!(state(), "e-stopped");
    let refused = robot(&["play", "--cycles", "1"]).with_status(1);
    assert!(refused.stderr.contains("--clear-estop"), "{refused}");
    assert_eq!(state(), "e-stopped");
    // Without an operator to confirm; then with one, and no other request reaches the robot.
    let asked = robot(&["estop", "--clear"]).with_status(1);
    assert!(asked.stderr.contains("--yes"), "{asked}");
    assert_eq!(state(), "e-stopped");
    robot(&["estop", "--clear", "--yes"]).with_status(0);
    assert_eq!(state(), "stopped");
    robot(&["estop", "--clear"]).with_status(0);
    robot(&["estop"]).with_status(0);

    let mut armed = holding(&["arm", "--clear-estop"]);
    sleep(Duration::from_secs(1));
    interrupt(&armed);
    assert_eq!(
        armed.wait().unwrap().code(),
        Some(0),
        "Ctrl-C is how arming ends"
    );
    assert_eq!(state(), "stopped");
}

/// A play without end has no other end than Ctrl-C, and one with an end leaves a robot that takes the next request.
#[test]
fn after_a_play_the_robot_is_ready() {
    let folder = tempfile::tempdir().unwrap();
    let _twin = TwinProcess::start(folder.path(), &[]);
    let words = |asked: &str| {
        let asked = format!("robot {asked} --port robot --json");
        asked.split(' ').map(str::to_owned).collect::<Vec<_>>()
    };
    let robot = |asked: &str| {
        let words = words(asked);
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        swimmer_in(folder.path(), &words)
    };
    let played = robot("play --gait circle:60deg --cycles 1 --period 3").with_status(0);
    assert_eq!(played.json()["state"], "stopped", "{played}");
    robot("configure --swimmer robot").with_status(0);

    let words = words("play --period 3");
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let mut play = command(folder.path(), &words);
    let play = play.stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = play.spawn().unwrap();
    sleep(Duration::from_secs(3));
    interrupt(&child);
    let ran = crate::binary::Ran::from(child.wait_with_output().unwrap()).with_status(0);
    assert_eq!(ran.json()["state"], "stopped", "{ran}");
    assert_eq!(ran.json()["cause"], "requested", "{ran}");
}

/// The whole loop in real time and over TCP: what the cameras of `swimmer twin` write, `swimmer calibrate` reads.
#[test]
fn a_run_over_tcp_is_tracked() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["twin", "--tcp", "127.0.0.1:0", "--track", "run.csv"];
    let mut twin = command(folder.path(), &words)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(twin.stdout.as_mut().unwrap())
        .read_line(&mut line)
        .unwrap();
    let port = line
        .split_whitespace()
        .find(|word| word.starts_with("tcp:"))
        .unwrap()
        .trim_end_matches(';')
        .to_owned();
    let play = [
        "robot",
        "play",
        "--gait",
        "circle:70deg",
        "--cycles",
        "4",
        "--period",
        "3",
        "--port",
        &port,
    ];
    let played = swimmer_in(folder.path(), &play);
    interrupt(&twin);
    assert_eq!(twin.wait().unwrap().code(), Some(0));
    played.with_status(0);

    let circle = ["--gait", "circle:70deg", "--swimmer", "robot", "--json"];
    let calibrate = [&["calibrate", "run.csv", "--period", "3"], &circle[..]].concat();
    let runs = swimmer_in(folder.path(), &calibrate).with_status(0).json();
    let simulated = swimmer_in(folder.path(), &[&["simulate"], &circle[..]].concat())
        .with_status(0)
        .json();
    let (tracked, ideal) = (
        number(&runs["runs"][0], "x_m"),
        number(&simulated, "displacement_m"),
    );
    assert!(
        (tracked / ideal - 1.0).abs() < 0.1,
        "{tracked} m tracked, {ideal} m without servos between"
    );
}

/// A play over a real pseudo-terminal, logged, and the log lived again.
#[test]
fn a_logged_play_is_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let _twin = TwinProcess::start(folder.path(), &[]);
    let run =
        |words: &[&str]| swimmer_in(folder.path(), &[&["robot"], words, &["--json"]].concat());
    run(&[
        "play",
        "--gait",
        "circle:30deg",
        "--cycles",
        "2",
        "--period",
        "2",
        "--log",
        "run.mcap",
        "--port",
        "robot",
    ])
    .with_status(0);
    let told = run(&["replay", "run.mcap"]).with_status(0).json();
    assert_eq!(
        (&told["same"], &told["requests"]),
        (&true.into(), &3.into()),
        "{told:#}"
    );
    assert!(number(&told, "compared") > 80.0, "{told:#}");

    // The robot holds the gait now, and a second log does not: it must be named. A log begins with the robot at rest.
    run(&["stop", "--port", "robot"]).with_status(0);
    run(&[
        "play",
        "--cycles",
        "1",
        "--period",
        "2",
        "--log",
        "again.mcap",
        "--port",
        "robot",
    ])
    .with_status(0);
    let without = run(&["replay", "again.mcap"]).with_status(1);
    assert_eq!(without.json()["same"], false, "{without}");
    assert!(without.stderr.contains("name it with --gait"), "{without}");
    let error = without.json()["error"].as_str().unwrap().to_owned();
    assert!(error.contains("name it with --gait"), "{without}");
    run(&["replay", "again.mcap", "--gait", "circle:30deg"]).with_status(0);

    let listened = run(&["log", "idle.mcap", "--seconds", "1", "--port", "robot"]).with_status(0);
    assert!(number(&listened.json(), "frames") > 20.0, "{listened}");
    let refused = run(&["log", "idle.mcap", "--seconds", "1", "--port", "robot"]).with_status(2);
    assert!(refused.stderr.contains("exists"), "{refused}");
}

/// Failures are the purpose of a log: it is complete also after a refusal.
#[test]
fn a_log_survives_the_failure_it_records() {
    let folder = tempfile::tempdir().unwrap();
    let words = [
        "robot",
        "play",
        "--cycles",
        "1",
        "--log",
        "failed.mcap",
        "--port",
        "twin",
    ];
    let ran = swimmer_in(folder.path(), &words).with_status(1);
    assert!(
        ran.stderr.contains("The link log is in failed.mcap: "),
        "{ran}"
    );
    let frames = swimmer_files::read_link_log(&folder.path().join("failed.mcap"))
        .unwrap()
        .frames;
    assert!(frames.len() > 10, "{}", frames.len());
}

/// A radio does not identify its sender: requests that need a person at the robot are refused, with the next step.
#[test]
fn a_first_key_needs_somebody_at_the_robot() {
    for (door, status) in [(&["--radio"][..], 1), (&[], 0)] {
        let folder = tempfile::tempdir().unwrap();
        let _twin = TwinProcess::start(folder.path(), door);
        let robot = |words: &[&str]| {
            let words = [&["robot"], words, &["--port", "robot", "--json"]].concat();
            swimmer_in(folder.path(), &words)
        };
        let told = robot(&["status"]).with_status(0).json();
        assert_eq!(told["presence"].is_null(), status == 1, "{told:#}");
        let set = robot(&["key", "make", "robot.key"]).with_status(status);
        let advice =
            set.stderr.contains("for somebody at the robot") && set.stderr.contains("USB cable");
        assert_eq!(advice, status == 1, "{set}");
        assert_eq!(folder.path().join("robot.key").exists(), status == 0);
    }
}
