//! Recorded data survive the end of the program and a full disk; and no file is overwritten without permission.

use std::path::Path;
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;

use rustix::process::{Pid, Signal, kill_process};

use crate::binary::{Ran, command, on_a_small_disk, swimmer_in, typed};
use crate::laboratory::laboratory;

fn killed(mut child: std::process::Child, after: Duration) {
    sleep(after);
    kill_process(Pid::from_child(&child), Signal::KILL).unwrap();
    child.wait().unwrap();
}

#[test]
fn recordings_survive_a_kill() {
    let folder = tempfile::tempdir().unwrap();
    let run = |line: &str| typed(folder.path(), line);
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
    // 20 kB: a log grows by some 8 kB a second.
    let logged = on_a_small_disk(folder.path(), 40, &words).output().unwrap();
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
    let run = |line: &str| typed(folder.path(), line);
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

#[test]
fn a_campaign_tells_of_a_log_without_its_end() {
    let folder = laboratory();
    let place = |name: &str| folder.path().join(name);
    let line = "robot play --gait circle:50deg --cycles 3 --period 30 --port twin --log l.mcap";
    typed(folder.path(), line).with_status(0);
    let campaign = std::fs::read_to_string(place("campaign.toml")).unwrap();
    std::fs::write(place("campaign.toml"), campaign + "log = \"l.mcap\"\n").unwrap();
    let told = |folder: &Path| {
        let ran = swimmer_in(folder, &["calibrate", "campaign.toml", "--json"]).with_status(0);
        ran.json()["warnings"]
            .to_string()
            .contains("run.csv: its link log has no end")
    };
    assert!(!told(folder.path()));
    let log = std::fs::read(place("l.mcap")).unwrap();
    std::fs::write(place("l.mcap"), &log[..log.len() - 60]).unwrap();
    assert!(told(folder.path()));
}
