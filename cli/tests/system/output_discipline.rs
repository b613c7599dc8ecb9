//! Guarantees for scripts: one JSON document, the exit status, no partial file.

use crate::binary::{swimmer, swimmer_in, typed};

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
        &["twin", "--tcp", "foo"],
        &["twin", "--tcp", "127.0.0.1:99999"],
        #[cfg(unix)]
        &["twin", "--pty", "no-such-folder/robot"],
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
    // No frame passed: again, and the log is no hindrance.
    for _ in 0..2 {
        let words = ["robot", "info", "--port", "gone", "--log", "z.mcap"];
        swimmer_in(folder.path(), &words).with_status(1);
    }
    // Input is read before the robot is met.
    let line = "robot play --gait x.gait --cycles 1 --port twin --log z.mcap";
    typed(folder.path(), line).with_status(2);
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

/// An output with status 1 has its reason under the key that every failure has.
#[test]
fn a_foretold_refusal_is_an_error_for_scripts() {
    let words = "robot upload circle:150deg --dry-run --swimmer robot --json";
    let words: Vec<&str> = words.split(' ').collect();
    let ran = swimmer(&words).with_status(1);
    let answer = ran.json();
    let refused = answer["preflight"]["refused"].as_str().unwrap();
    assert_eq!(
        answer["error"],
        format!("circle:150deg must not be played: {refused}"),
        "{answer:#}"
    );
    assert!(ran.stderr.contains(refused), "{ran}");
}

/// Help is for people, also with `--json`.
#[test]
fn help_takes_json_and_stays_text() {
    for words in [
        &["help", "--json"][..],
        &["help", "optimize", "--json"],
        &["robot", "help", "play", "--json"],
        &["optimize", "--help", "--json"],
    ] {
        let ran = swimmer(words).with_status(0);
        assert!(
            ran.stdout.contains("Usage: swimmer") && ran.stderr.is_empty(),
            "{words:?}: {ran}"
        );
    }
    swimmer(&["help", "dance", "--json"]).with_status(2).json();
    swimmer(&["dance", "help", "--json"]).with_status(2).json();
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
    // The prediction is not stricter than the upload.
    let foretold = robot(&["upload", "purcell.gait", "--dry-run"]).with_status(1);
    assert_eq!(foretold.stderr, refused.stderr);
    robot(&["upload", "purcell.gait", "--dry-run", "--force"]).with_status(0);
    let other = robot(&["upload", "robot.gait", "--swimmer", "purcell"]).with_status(0);
    assert!(
        other.stderr.contains("another swimmer than `purcell`"),
        "{other}"
    );
    let same = robot(&["upload", "robot.gait", "--swimmer", "robot"]).with_status(0);
    assert!(!same.stderr.contains("another swimmer"), "{same}");
    robot(&["play", "--gait", "purcell.gait", "--cycles", "1"]).with_status(1);
    robot(&["upload", "purcell.gait", "--force"]).with_status(0);
}
