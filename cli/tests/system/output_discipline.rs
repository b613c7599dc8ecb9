//! What scripts rely on: one JSON document, the exit status, nothing half-written.

use crate::binary::{swimmer, swimmer_in};

#[test]
fn bad_usage_and_bad_input_exit_with_two() {
    for words in [
        &["simulate"][..],
        &["simulate", "--swimmer", "robot", "--gait", "circle:70turns"],
        &[
            "simulate",
            "--swimmer",
            "no-such-file.toml",
            "--gait",
            "circle:70deg",
        ],
        &["simulate", "--swimmer", "robot", "--gait", "no-such.gait"],
        &[
            "optimize",
            "displacement",
            "--swimmer",
            "robot",
            "--max-angle",
            "-1",
        ],
        &["robot", "info"],
        &["robot", "play", "--port", "twin", "--detach"],
        &["twin"],
        &["calibrate", "no-such-campaign.toml"],
        &["tracks", "no-such-track.csv"],
        &["dance"],
    ] {
        let ran = swimmer(words).with_status(2);
        assert!(
            ran.stdout.is_empty() && !ran.stderr.is_empty(),
            "{words:?}: {ran}"
        );
        let json = [words, &["--json"]].concat();
        let ran = swimmer(&json).with_status(2);
        assert!(ran.json()["error"].is_string(), "{words:?}: {ran}");
    }
}

#[test]
fn json_may_stand_anywhere_after_the_subcommand() {
    let ways = [
        [
            "simulate",
            "--json",
            "--swimmer",
            "robot",
            "--gait",
            "circle:1",
        ],
        [
            "simulate",
            "--swimmer",
            "robot",
            "--json",
            "--gait",
            "circle:1",
        ],
        [
            "simulate",
            "--swimmer",
            "robot",
            "--gait",
            "circle:1",
            "--json",
        ],
    ];
    let answers: Vec<_> = ways
        .iter()
        .map(|words| swimmer(words).with_status(0).json())
        .collect();
    assert!(answers.iter().all(|answer| *answer == answers[0]));
}

#[test]
fn what_fails_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let left = || std::fs::read_dir(folder.path()).unwrap().count();
    swimmer_in(
        folder.path(),
        &["robot", "upload", "square:3.1", "--port", "twin"],
    )
    .with_status(1);
    swimmer_in(
        folder.path(),
        &[
            "simulate",
            "--swimmer",
            "robot",
            "--gait",
            "x.gait",
            "--trajectory",
            "t.csv",
        ],
    )
    .with_status(2);
    swimmer_in(
        folder.path(),
        &[
            "optimize",
            "displacement",
            "--swimmer",
            "x.toml",
            "-o",
            "y.gait",
        ],
    )
    .with_status(2);
    assert_eq!(left(), 0);
    std::fs::write(folder.path().join("mine.txt"), "keep me").unwrap();
    let ran = swimmer_in(folder.path(), &["demo", "-o", "."]).with_status(2);
    assert!(ran.stderr.contains("not empty"), "{ran}");
    assert_eq!(left(), 1);
}

#[test]
fn a_gait_made_for_another_swimmer_needs_force() {
    let folder = tempfile::tempdir().unwrap();
    let robot = |words: &[&str]| {
        swimmer_in(
            folder.path(),
            &[&["robot"], words, &["--port", "twin", "--json"]].concat(),
        )
    };
    for swimmer in ["robot", "purcell"] {
        let file = format!("{swimmer}.gait");
        let words = [
            "optimize",
            "displacement",
            "--swimmer",
            swimmer,
            "--max-angle",
            "100deg",
            "-o",
            &file,
        ];
        swimmer_in(folder.path(), &words).with_status(0);
    }
    robot(&["upload", "robot.gait"]).with_status(0);
    let refused = robot(&["upload", "purcell.gait"]).with_status(1);
    assert!(
        refused.stderr.contains("made for `purcell`") && refused.stderr.contains("--force"),
        "{refused}"
    );
    robot(&["play", "--gait", "purcell.gait", "--cycles", "1"]).with_status(1);
    robot(&["upload", "purcell.gait", "--force"]).with_status(0);
}
