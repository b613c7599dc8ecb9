//! Faulty robots in real time, whose cameras stream `NatNet` over loopback: each fault is named within two cycles, and within three if
//! nothing explains it. The robots run at the same time, each in a process of its own.

use std::thread;

use serde_json::Value;

use crate::binary::{Ran, number, swimmer_in};
use crate::go::gaits;
use crate::natnet_stream::Streaming;

/// Runs a command against a real-time twin with these options.
fn tracked(twin: &str, words: &str) -> Ran {
    let folder = tempfile::tempdir().unwrap();
    let options: Vec<&str> = twin.split_whitespace().collect();
    let mut twin = Streaming::start(folder.path(), &options);
    let source = format!("natnet:{}", twin.cameras);
    let mut all: Vec<&str> = words.split_whitespace().collect();
    all.extend(["--port", &twin.robot, "--track", &source, "--json"]);
    let ran = swimmer_in(folder.path(), &all);
    twin.end();
    ran
}

/// Departures of a document, in words.
fn listed(departures: &Value) -> Vec<&str> {
    let departures = departures.as_array().unwrap();
    departures.iter().map(|one| one.as_str().unwrap()).collect()
}

/// A fault, and the words that name it.
struct Fault {
    twin: &'static str,
    named: &'static str,
    /// Cycle after whose end it must be named.
    by_cycle: usize,
}

#[test]
fn a_play_names_each_fault_within_two_cycles() {
    let faults = [
        Fault {
            twin: "--servo front:slope=0.0001",
            named: "joint 1 does not move",
            by_cycle: 2,
        },
        Fault {
            twin: "--servo back:slope=0.0001",
            named: "joint 2 does not move",
            by_cycle: 2,
        },
        Fault {
            twin: "--current 0.0006,-0.0008",
            named: "the swimmer drifts by (",
            by_cycle: 2,
        },
        // The same circle, the other way round.
        Fault {
            twin: "--servo front:sign=-",
            named: "the robot does not follow this gait",
            by_cycle: 3,
        },
    ];
    thread::scope(|scope| {
        for fault in &faults {
            scope.spawn(|| {
                let words = "robot play --gait circle:70deg --cycles 4 --period 6";
                let ran = tracked(fault.twin, words).with_status(0);
                let document = ran.json();
                assert_eq!(document["tracked"]["cycles"], 4, "{document:#}");
                let departures = listed(&document["tracked"]["departures"]);
                assert_eq!(departures.len(), 1, "{}: {document:#}", fault.twin);
                assert!(
                    departures[0].contains("since cycle 1:") && departures[0].contains(fault.named),
                    "{}: {departures:?}",
                    fault.twin
                );
                // Named when it was known.
                let warned = ran.stderr.find(fault.named).unwrap();
                let next = format!("cycle {}:", fault.by_cycle + 1);
                assert!(warned < ran.stderr.find(&next).unwrap(), "{ran}");
                if fault.twin.starts_with("--current") {
                    let (_, numbers) = departures[0].split_once("drifts by (").unwrap();
                    let (x, y) = numbers.split_once(", ").unwrap();
                    let (y, _) = y.split_once(')').unwrap();
                    let [x, y]: [f64; 2] = [x, y].map(|number| number.parse().unwrap());
                    assert!((x - 0.6).hypot(y + 0.8) < 0.2, "{departures:?}");
                }
            });
        }
    });
}

/// The controller ends the run, or learns the drift and arrives nevertheless.
#[test]
fn a_drive_over_natnet_arrives_or_names_the_fault() {
    let gaits = gaits();
    let go = |twin: &str, goal: &str| {
        tracked(
            twin,
            &format!("robot go --gaits {gaits} --tank 1.2x1.2 {goal}"),
        )
    };
    thread::scope(|scope| {
        scope.spawn(|| {
            let ran = go(
                "--current 0.0003,-0.0004",
                "--to 0.0,0.05 --within 5mm,2deg",
            );
            let document = ran.with_status(0).json();
            assert_eq!(document["reached"], true, "{document:#}");
            let drift: Vec<f64> = document["drift_m_per_s"]
                .as_array()
                .unwrap()
                .iter()
                .map(|part| part.as_f64().unwrap())
                .collect();
            let off = (drift[0] - 3e-4).hypot(drift[1] + 4e-4);
            println!(
                "arrived over NatNet after {} cycles and {:.0} s, {:.1} mm off; drift {drift:?}",
                number(&document, "cycles"),
                number(&document, "duration_s"),
                1e3 * number(&document, "off_m")
            );
            assert!(off < 2.5e-4, "{document:#}");
        });
        scope.spawn(|| {
            let ran = go("--servo back:slope=0.0001", "--hold 0deg").with_status(1);
            assert!(ran.stderr.contains("joint 2 does not move"), "{ran}");
            assert!(number(&ran.json(), "cycles") <= 2.0, "{ran}");
        });
        scope.spawn(|| {
            let ran = go("--servo front:sign=-", "--hold 0deg").with_status(1);
            assert!(ran.stderr.contains("departs from the prediction"), "{ran}");
            assert!(number(&ran.json(), "cycles") <= 3.0, "{ran}");
        });
        // A current that carries the robot towards a wall faster than it swims: no cycle fits any more, or it comes too near.
        scope.spawn(|| {
            let ran = go("--current 0.02,0.0", "--hold 180deg").with_status(1);
            let is_named = ["nearer to a wall", "within the walls"]
                .iter()
                .any(|reason| ran.stderr.contains(reason));
            assert!(is_named, "{ran}");
        });
    });
}

/// With 1000 frames a second over cycles of 15 s, the diagnosis of a robot that stands still takes longer than the robot waits for a
/// keep-alive. The link is kept meanwhile.
#[test]
fn a_long_diagnosis_keeps_the_link() {
    use std::fmt::Write as _;
    use std::io::Write as _;
    use std::process::Stdio;
    use std::time::{Duration, Instant};

    let folder = tempfile::tempdir().unwrap();
    let _twin = crate::binary::TwinProcess::start(folder.path(), &[]);
    let words =
        "robot play --gait circle:70deg --cycles 2 --period 15 --port robot --track - --json";
    let words: Vec<&str> = words.split(' ').collect();
    let mut child = crate::binary::command(folder.path(), &words)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let cameras = thread::spawn(move || {
        let begun = Instant::now();
        let mut frames = 0_u32;
        loop {
            thread::sleep(Duration::from_millis(5));
            let mut lines = String::new();
            while f64::from(frames) * 1e-3 < begun.elapsed().as_secs_f64() {
                let t = f64::from(frames) * 1e-3;
                let noise = 1e-4 * (t * 1e5).sin();
                let [front, back] = [0.0355 + noise, -0.0355 + noise];
                writeln!(
                    lines,
                    "{{\"t\": {t}, \"points\": {{\"Front\": [{front}, {noise}], \"Back\": [{back}, 0.0]}}}}"
                )
                .unwrap();
                frames += 1;
            }
            if stdin.write_all(lines.as_bytes()).is_err() {
                break;
            }
        }
    });
    let ran: Ran = child.wait_with_output().unwrap().into();
    cameras.join().unwrap();
    let ran = ran.with_status(0);
    let document = ran.json();
    assert_eq!(
        (&document["cycles"], &document["tracked"]["cycles"]),
        (&2.into(), &2.into()),
        "{ran}"
    );
    assert_eq!(listed(&document["tracked"]["departures"]).len(), 1, "{ran}");
}
