//! `swimmer track`: sources as a laboratory has them, and the recordings that it makes.

use std::io::Write as _;
use std::path::Path;
use std::process::Stdio;

use serde_json::Value;

use crate::binary::{Ran, command, number, swimmer_in};

/// Runs `swimmer track` with these lines on standard input.
fn piped(folder: &Path, words: &[&str], lines: &str) -> Ran {
    let mut child = command(folder, &[&["track", "-"], words].concat())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    // A command that refuses its words reads nothing.
    let _ = stdin.write_all(lines.as_bytes());
    drop(stdin);
    child.wait_with_output().unwrap().into()
}

fn script(frames: u32) -> String {
    let line = |step: u32| {
        let (t, x) = (f64::from(step) / 50.0, 0.1 + f64::from(step) * 1e-4);
        let front = if step % 10 == 3 {
            "null".to_owned()
        } else {
            format!("[{x}, 0.2]")
        };
        format!(
            "{{\"t\": {t}, \"points\": {{\"Front\": {front}, \"Back\": [{}, 0.2]}}, \"unlabeled\": [[1, 1]], \"latency_ms\": 35}}\n",
            x - 0.071
        )
    };
    (0..frames).map(line).collect()
}

/// The keys of the contract, and their values for a stream that is known.
#[test]
fn a_script_on_standard_input_is_counted() {
    let folder = tempfile::tempdir().unwrap();
    let text = script(100) + "Traceback\n{\"t\": 9e9999}\n";
    let ran = piped(folder.path(), &["--json"], &text).with_status(0);
    let seen = ran.json();
    assert!((number(&seen, "rate_hz") - 50.0).abs() < 1e-6, "{seen:#}");
    assert!(
        (number(&seen, "latency_ms") - 35.0).abs() < 1e-9,
        "{seen:#}"
    );
    assert_eq!(
        (&seen["frames"], &seen["blanks"]),
        (&100.into(), &10.into())
    );
    assert_eq!((&seen["jumps"], &seen["malformed"]), (&0.into(), &2.into()));
    let names: Vec<&Value> = seen["points"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| &p["name"])
        .collect();
    assert_eq!(names, ["Back", "Front"]);
    assert_eq!(seen["points"][1]["present"], 90);
    assert!(
        seen["warnings"][0].as_str().unwrap().contains("line 102"),
        "{seen:#}"
    );
}

/// Both formats are recordings for `track`, the CSV one also for `tracks` and `calibrate`.
#[test]
fn recordings_are_read_again() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["run.csv", "run.mcap"] {
        let ran = piped(folder.path(), &["-o", name], &script(100)).with_status(0);
        assert!(
            ran.stdout.contains(&format!("The frames are in {name}.")),
            "{ran}"
        );
        let again = swimmer_in(folder.path(), &["track", name, "--fast", "--json"])
            .with_status(0)
            .json();
        assert_eq!(
            (&again["frames"], &again["blanks"]),
            (&100.into(), &10.into()),
            "{name}"
        );
        assert!((number(&again, "rate_hz") - 50.0).abs() < 1e-3, "{again:#}");
        // An existing file is not replaced.
        let refused = piped(folder.path(), &["-o", name], &script(3)).with_status(2);
        assert!(refused.stderr.contains("--overwrite"), "{refused}");
    }
    let tracks = swimmer_in(folder.path(), &["tracks", "run.csv", "--json"])
        .with_status(0)
        .json();
    assert_eq!(
        (&tracks["format"], &tracks["frames"]),
        (&"motive-1.1".into(), &100.into())
    );
}

#[test]
fn wrong_sources_and_files_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let run = |words: &[&str], status| swimmer_in(folder.path(), words).with_status(status).stderr;
    assert!(run(&["track", "tcp:nowhere"], 2).contains("tcp:HOST:PORT"));
    assert!(run(&["track", "no-such.csv"], 2).contains("no-such.csv"));
    assert!(run(&["track", "twin", "-o", "run.txt"], 2).contains(".csv or .mcap"));
    assert!(run(&["track", "tcp:127.0.0.1:1"], 1).contains("start the script"));
    let empty = piped(folder.path(), &[], "nonsense\n").with_status(1);
    assert!(
        empty.stderr.contains("without a frame") && empty.stderr.contains("line 1"),
        "{empty}"
    );
}

#[test]
fn the_twin_is_watched_in_its_own_time() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["track", "twin", "--fast", "--seconds", "30", "--json"];
    let seen = swimmer_in(folder.path(), &words).with_status(0).json();
    assert_eq!(seen["frames"], 3000);
    assert!((number(&seen, "rate_hz") - 100.0).abs() < 1e-6);
    assert_eq!(seen["bodies"][0]["name"], "robot");
}
