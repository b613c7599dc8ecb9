//! What was recorded is there, whatever became of the program or the disk; and no file is written over unasked.

use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use rustix::process::{Pid, Signal, kill_process};

use crate::binary::{Ran, command, swimmer_in};

/// The binary where no file can grow beyond so many blocks of 512 bytes: what a full disk is to a program.
fn on_a_small_disk(folder: &Path, blocks: u32, words: &[&str]) -> Command {
    let mut shell = Command::new("sh");
    let limited = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$@\"");
    shell.current_dir(folder).args(["-c", &limited, "sh"]);
    shell.arg(env!("CARGO_BIN_EXE_swimmer")).args(words);
    shell
}

fn killed(mut child: std::process::Child, after: Duration) {
    sleep(after);
    kill_process(Pid::from_child(&child), Signal::KILL).unwrap();
    child.wait().unwrap();
}

#[test]
fn recordings_survive_a_kill() {
    let folder = tempfile::tempdir().unwrap();
    let run = |words: &str| {
        let words: Vec<&str> = words.split(' ').collect();
        swimmer_in(folder.path(), &words)
    };
    let words = ["twin", "--pty", "robot", "--track", "run.csv"];
    let mut twin = command(folder.path(), &words);
    let twin = twin.stdout(Stdio::null()).spawn().unwrap();
    sleep(Duration::from_millis(500));
    let words = "robot log run.mcap --port robot";
    let words: Vec<&str> = words.split(' ').collect();
    let mut log = command(folder.path(), &words);
    let log = log.stdout(Stdio::null()).stderr(Stdio::null());
    killed(log.spawn().unwrap(), Duration::from_secs(3));
    killed(twin, Duration::ZERO);

    let tracked = run("tracks run.csv --json").with_status(0);
    let frames = tracked.json()["frames"].as_u64().unwrap();
    assert!((200..600).contains(&frames), "{tracked}");
    let replayed = run("robot replay run.mcap").with_status(0);
    assert!(replayed.stderr.contains("has no end"), "{replayed}");
    let read = swimmer_files::read_link_log(&folder.path().join("run.mcap")).unwrap();
    assert!(!read.ended && read.frames.len() > 100);
}

#[test]
fn recordings_survive_a_full_disk() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["twin", "--pty", "robot", "--track", "run.csv"];
    let mut twin = on_a_small_disk(folder.path(), 32, &words);
    let twin = twin.stdout(Stdio::null()).stderr(Stdio::piped());
    let twin = twin.spawn().unwrap();
    sleep(Duration::from_millis(500));
    let words = "robot log run.mcap --seconds 4 --port robot";
    let words: Vec<&str> = words.split(' ').collect();
    let logged = on_a_small_disk(folder.path(), 32, &words).output().unwrap();
    let logged = Ran::from(logged).with_status(1);
    assert!(logged.stderr.contains("the link log ends here"), "{logged}");
    crate::binary::interrupt(&twin);
    let twin = Ran::from(twin.wait_with_output().unwrap()).with_status(1);
    assert!(twin.stderr.contains("the recording ends here"), "{twin}");

    let tracked = swimmer_in(folder.path(), &["tracks", "run.csv", "--json"]).with_status(0);
    let frames = tracked.json()["frames"].as_u64().unwrap();
    assert!((50..400).contains(&frames), "{tracked}");
    let replayed = swimmer_in(folder.path(), &["robot", "replay", "run.mcap"]).with_status(0);
    assert!(replayed.stderr.contains("has no end"), "{replayed}");
}

/// One rule for every FILE.
#[test]
fn a_file_that_exists_stays_unless_told_otherwise() {
    let folder = tempfile::tempdir().unwrap();
    let run = |words: &str| {
        let words: Vec<&str> = words.split(' ').collect();
        swimmer_in(folder.path(), &words)
    };
    for (writes, file) in [
        (
            "simulate --swimmer robot --gait circle:1 --trajectory",
            "t.csv",
        ),
        (
            "optimize displacement --swimmer robot --max-angle 2.8 -o",
            "b.gait",
        ),
        (
            "optimize turning --swimmer robot --max-angle 2.8 -o",
            "l.gait",
        ),
        ("height-map --swimmer robot -o", "m.svg"),
        ("robot log --seconds 1 --port twin", "r.mcap"),
        ("robot info --port twin --log", "i.mcap"),
        ("twin --pty robot --track", "k.csv"),
    ] {
        let place = folder.path().join(file);
        std::fs::write(&place, "mine").unwrap();
        let refused = run(&format!("{writes} {file}")).with_status(2);
        assert!(
            refused.stderr.contains("exists") && refused.stderr.contains("--overwrite"),
            "{refused}"
        );
        assert_eq!(std::fs::read_to_string(&place).unwrap(), "mine");
        let lost = run(&format!("{writes} no/{file}")).with_status(2);
        assert!(lost.stderr.contains("there is no folder no"), "{lost}");
        if !writes.starts_with("twin") {
            let written = run(&format!("{writes} {file} --overwrite")).with_status(0);
            let said = format!("{}{}", written.stdout, written.stderr);
            assert!(said.contains(file), "{written}");
            assert_ne!(std::fs::read(&place).unwrap(), b"mine");
        }
    }
    assert!(!folder.path().join("no").exists());
}
