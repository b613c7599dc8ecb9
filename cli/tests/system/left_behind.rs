//! Outputs that cannot be written, and the files left behind: closed readers, pipes, folders of a command that was interrupted.

use std::os::fd::OwnedFd;
use std::os::unix::fs::FileTypeExt as _;
use std::os::unix::net::UnixDatagram;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

use crate::binary::{Ran, command, swimmer_in};

const SIMULATE: [&str; 5] = ["simulate", "--swimmer", "robot", "--gait", "circle:1"];

fn told_to(stdout: impl Into<Stdio>, words: &[&str]) -> Ran {
    let mut command = command(&std::env::temp_dir(), words);
    command.stdout(stdout).stderr(Stdio::piped());
    command.spawn().unwrap().wait_with_output().unwrap().into()
}

#[test]
fn an_answer_that_does_not_arrive_is_a_failure() {
    for words in [
        &SIMULATE[..],
        &[&SIMULATE[..], &["--json"]].concat(),
        &["--help"],
    ] {
        // A socket that leads nowhere takes nothing, as a full disk.
        let nowhere = OwnedFd::from(UnixDatagram::unbound().unwrap());
        let ran = told_to(nowhere, words).with_status(1);
        assert!(ran.stderr.contains("standard output"), "{words:?}: {ran}");
    }
}

#[test]
fn a_reader_that_went_away_is_no_failure() {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let ran = told_to(writer, &SIMULATE).with_status(0);
    assert!(ran.stderr.is_empty(), "{ran}");
    // As `2>&1 | head` leaves both, for what succeeds, fails, and is no command.
    for (words, status) in [
        (&SIMULATE[..], 0),
        (&["robot", "info", "--port", "/dev/no-such-port"], 1),
        (
            &["simulate", "--swimmer", "lost.toml", "--gait", "circle:1"],
            2,
        ),
        (&["dance"], 2),
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut command = command(&std::env::temp_dir(), words);
        command.stdout(writer.try_clone().unwrap()).stderr(writer);
        assert_eq!(command.status().unwrap().code(), Some(status), "{words:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_pipe_is_written_through() {
    use rustix::fs::{CWD, Mode, mkfifoat};

    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    mkfifoat(CWD, &pipe, Mode::from_raw_mode(0o600)).unwrap();
    let reader = {
        let pipe = pipe.clone();
        std::thread::spawn(move || std::fs::read_to_string(pipe).unwrap())
    };
    let words = [&SIMULATE[..], &["--trajectory", "pipe"]].concat();
    let ran = swimmer_in(folder.path(), &words).with_status(0);
    let kind = std::fs::symlink_metadata(&pipe).unwrap().file_type();
    assert!(kind.is_fifo(), "{ran}");
    assert!(reader.join().unwrap().lines().count() > 10);
}

/// Waits until the child has begun to fill a folder in this one, then signals it and waits for its end.
fn signalled(child: Child, folder: &Path, signal: Signal) -> Ran {
    let patience = Instant::now() + Duration::from_mins(1);
    let begun = || {
        std::fs::read_dir(folder).unwrap().any(|entry| {
            let name = entry.unwrap().file_name();
            name.to_string_lossy().ends_with(".partial")
        })
    };
    while !begun() {
        assert!(Instant::now() < patience, "no draft was begun");
        std::thread::sleep(Duration::from_millis(5));
    }
    kill_process(Pid::from_child(&child), signal).unwrap();
    child.wait_with_output().unwrap().into()
}

#[test]
fn an_interrupted_command_leaves_nothing() {
    // Long enough to be interrupted on any machine.
    let atlas = [
        "atlas",
        "--swimmer",
        "purcell",
        "--objective",
        "displacement",
        "--starts",
        "100000",
        "-o",
    ];
    for (place, signal) in [("out", Signal::INT), (".", Signal::TERM)] {
        let folder = tempfile::tempdir().unwrap();
        let mut command = command(folder.path(), &[&atlas[..], &[place, "--json"]].concat());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let ran = signalled(command.spawn().unwrap(), folder.path(), signal).with_status(1);
        assert!(ran.json()["error"].is_string(), "{ran}");
        assert!(ran.stderr.contains("interrupted"), "{ran}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
