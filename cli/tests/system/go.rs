//! `swimmer robot go`: to poses of a virtual robot, and what ends it early.

use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{ChildStdin, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crate::binary::{Ran, TwinProcess, command, interrupt, number, swimmer_in, typed};

/// Gaits that join at the straight shape.
pub(crate) fn gaits() -> String {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../experiment/tests/straight");
    folder.display().to_string()
}

fn go(folder: &std::path::Path, more: &str) -> Ran {
    let gaits = gaits();
    let mut words = vec![
        "robot", "go", "--port", "twin", "--track", "twin", "--gaits", &gaits,
    ];
    words.extend(more.split(' '));
    swimmer_in(folder, &words)
}

/// The virtual robot is driven past a way-point to a pose, by the cameras of its tank alone. The distances are those of the poses at
/// rest, within the tolerance.
#[test]
fn a_pose_is_reached() {
    let folder = tempfile::tempdir().unwrap();
    let ran = go(
        folder.path(),
        "--to 0.1,-0.05,90deg --via 0.0,0.0 --tank 1.2x1.2 --json",
    )
    .with_status(0);
    let document = ran.json();
    assert_eq!(document["reached"], true, "{document:#}");
    let pose = &document["pose"];
    let off = (number(pose, "x_m") - 0.1).hypot(number(pose, "y_m") + 0.05);
    assert!(off <= 3e-3, "{document:#}");
    assert!(
        (number(pose, "heading_rad") - std::f64::consts::FRAC_PI_2).abs() <= 1_f64.to_radians()
    );
    assert!((number(&document, "off_m") - off).abs() < 1e-9);
    assert!(number(&document, "cycles") >= 3.0 && number(&document, "duration_s") > 10.0);
    // The virtual robot is the model: what it does is what was predicted.
    for gain in document["gains"].as_array().unwrap() {
        assert!((gain.as_f64().unwrap() - 1.0).abs() < 0.1, "{document:#}");
    }
    // A row per decision, on standard error with --json.
    let rows = ran.stderr.lines().filter(|line| line.starts_with("after "));
    assert!(rows.count() >= 3, "{ran}");
}

/// Four way-points, each reached within the tolerance.
#[test]
fn a_square_is_driven() {
    let folder = tempfile::tempdir().unwrap();
    let square =
        "--via -0.05,-0.05,0deg --via 0.05,-0.05,0deg --via 0.05,0.05,0deg --to -0.05,0.05,0deg";
    let ran = go(folder.path(), &format!("{square} --tank 1.2x1.2 --json")).with_status(0);
    let document = ran.json();
    assert_eq!(document["reached"], true, "{document:#}");
    // The rows state the pose at each rest.
    for [x, y] in [[-0.05, -0.05], [0.05, -0.05], [0.05, 0.05], [-0.05, 0.05]] {
        let off = ran.stderr.lines().filter_map(|line| {
            let (_, pose) = line.split_once(" cycles at (")?;
            let (position, _) = pose.split_once(") m")?;
            let (here_x, here_y) = position.split_once(", ")?;
            let [here_x, here_y]: [f64; 2] = [here_x, here_y].map(|part| part.parse().unwrap());
            Some((here_x - x).hypot(here_y - y))
        });
        let nearest = off.fold(f64::INFINITY, f64::min);
        assert!(nearest <= 3e-3, "corner ({x}, {y}): {nearest} m\n{ran}");
    }
}

#[test]
fn a_heading_is_held() {
    let folder = tempfile::tempdir().unwrap();
    let document = go(folder.path(), "--hold 0deg --cycles 20 --tank 2x2 --json")
        .with_status(0)
        .json();
    assert!(document["off_m"].is_null() && document["reached"] == true);
    assert!(number(&document, "cycles") >= 20.0, "{document:#}");
    assert!(
        number(&document, "held_within_rad") < 2_f64.to_radians(),
        "{document:#}"
    );
}

/// Impossible input is refused before any robot or camera is contacted.
#[test]
fn bad_input_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |line: &str, reason: &str| {
        let ran = typed(folder.path(), line).with_status(2);
        assert!(ran.stderr.contains(reason), "{ran}");
    };
    let gone = "robot go --port /dev/gone --track tcp:127.0.0.1:9 --tank 1.0x0.6";
    refused(&format!("{gone} --to 0.6,0"), "beyond a wall");
    refused(&format!("{gone} --to 0.4,0,0deg"), "beyond a wall");
    refused(&format!("{gone} --to 0.1,0 --via 0,0.29"), "beyond a wall");
    refused(&format!("{gone} --to 0.1,0 --within 3mm"), "3mm,1deg");
    refused(
        "robot go --port /dev/gone --track twin --tank 1.0x0.6 --to 0.1,0",
        "--port twin",
    );
    refused(
        "robot go --port twin --track tcp:127.0.0.1:9 --tank 1.0x0.6 --to 0.1,0",
        "--track twin",
    );
    refused(
        "robot go --port twin --track run.csv --tank 1.0x0.6 --to 0.1,0",
        "recording",
    );
}

/// Frames of a robot that rests, 100 a second, until `hidden` is set.
fn film(mut to: ChildStdin, hidden: &AtomicBool, over: &AtomicBool) {
    let begun = Instant::now();
    while !over.load(Ordering::SeqCst) {
        thread::sleep(Duration::from_millis(10));
        if hidden.load(Ordering::SeqCst) {
            continue;
        }
        let t = begun.elapsed().as_secs_f64();
        // Noise makes each frame its own.
        let noise = 1e-4 * (t * 1e3).sin();
        let line = format!(
            "{{\"t\": {t}, \"points\": {{\"Front\": [{}, 0.0], \"Back\": [{}, {noise}]}}}}\n",
            0.0355 + noise,
            -0.0355 + noise
        );
        if to.write_all(line.as_bytes()).is_err() {
            return;
        }
    }
}

/// Runs against a twin in real time, whose cameras this test plays; `act` is called when the first cycle begins.
fn filmed(act: impl FnOnce(&std::process::Child, &AtomicBool)) -> (Ran, Ran) {
    let folder = tempfile::tempdir().unwrap();
    let _twin = TwinProcess::start(folder.path(), &[]);
    let gaits = gaits();
    let words = [
        "robot", "go", "--port", "robot", "--track", "-", "--gaits", &gaits, "--to", "0.2,0.05",
        "--tank", "1.0x0.6",
    ];
    let mut child = command(folder.path(), &words)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let (hidden, over) = (
        Arc::new(AtomicBool::new(false)),
        Arc::new(AtomicBool::new(false)),
    );
    let cameras = {
        let (stdin, hidden, over) = (child.stdin.take().unwrap(), hidden.clone(), over.clone());
        thread::spawn(move || film(stdin, &hidden, &over))
    };
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut stdout = String::new();
    let mut act = Some(act);
    for line in lines.by_ref() {
        let line = line.unwrap();
        if line.contains("; next ")
            && let Some(act) = act.take()
        {
            // Upload and start take about two seconds.
            thread::sleep(Duration::from_secs(3));
            act(&child, &hidden);
        }
        stdout += &(line + "\n");
    }
    let ended = child.wait_with_output().unwrap();
    over.store(true, Ordering::SeqCst);
    cameras.join().unwrap();
    let ran = Ran {
        stdout,
        ..ended.into()
    };
    let status = typed(folder.path(), "robot status --port robot --json").with_status(0);
    (ran, status)
}

#[test]
fn a_lost_track_ends_in_rest() {
    let (ran, status) = filmed(|_, hidden| hidden.store(true, Ordering::SeqCst));
    let ran = ran.with_status(1);
    assert!(ran.stderr.contains("was not seen for"), "{ran}");
    assert_eq!(status.json()["state"], "stopped", "{status}");
}

#[test]
fn ctrl_c_stops_the_robot() {
    let (ran, status) = filmed(|child, _| interrupt(child));
    let ran = ran.with_status(1);
    assert!(ran.stderr.contains("the operator stopped"), "{ran}");
    assert_eq!(status.json()["state"], "stopped", "{status}");
}

/// A stop of another process wins as well, also between two cycles.
#[test]
fn another_processs_stop_ends_the_run() {
    let (ran, status) = filmed(|child, _| {
        // The folder of the run is the working directory of the child.
        let folder = std::fs::read_link(format!("/proc/{}/cwd", child.id())).unwrap();
        let stop = Command::new(env!("CARGO_BIN_EXE_swimmer"))
            .current_dir(folder)
            .args(["robot", "stop", "--port", "robot"])
            .output()
            .unwrap();
        assert!(stop.status.success());
    });
    let ran = ran.with_status(1);
    assert!(ran.stderr.contains("stopped"), "{ran}");
    assert_eq!(status.json()["state"], "stopped", "{status}");
}
