//! The twin streams `NatNet`. An independent reader from `PyPI` (`tests/natnet`) and our own decode it at the same time, and both must
//! find what the twin's recording holds. Needs `python3` with `venv`, and `PyPI` once.

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use serde_json::Value;

use crate::binary::{command, number, swimmer_in};

/// A twin whose cameras record and stream; ended politely.
pub(crate) struct Streaming {
    child: Child,
    pub(crate) robot: String,
    pub(crate) cameras: String,
}

impl Streaming {
    pub(crate) fn start(folder: &Path, more: &[&str]) -> Self {
        let mut words = vec![
            "twin",
            "--tcp",
            "127.0.0.1:0",
            "--natnet",
            "127.0.0.1:0",
            "--track",
            "run.csv",
        ];
        words.extend(more);
        let mut child = command(folder, &words)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let mut address = |prefix: &str| {
            let line = lines.next().unwrap().unwrap();
            let (_, rest) = line.split_once(prefix).unwrap_or_else(|| panic!("{line}"));
            let rest = rest.split(';').next().unwrap();
            rest.trim_end_matches('.').to_owned()
        };
        let robot = format!("tcp:{}", address("tcp:"));
        let cameras = address("natnet:");
        Self {
            child,
            robot,
            cameras,
        }
    }

    pub(crate) fn end(&mut self) {
        let id = self.child.id().to_string();
        Command::new("kill").args(["-INT", &id]).status().unwrap();
        self.child.wait().unwrap();
    }
}

impl Drop for Streaming {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// An environment of Python with the pinned reader, made once.
fn python() -> PathBuf {
    let requirements =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/natnet/requirements.txt");
    let wanted = fs::read_to_string(&requirements).unwrap();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("natnet-python");
    let python = folder.join("bin/python");
    let stamp = folder.join("installed.txt");
    if fs::read_to_string(&stamp).is_ok_and(|installed| installed == wanted) {
        return python;
    }
    let run = |command: &mut Command, advice: &str| {
        let ran = command
            .output()
            .unwrap_or_else(|error| panic!("{error}; {advice}"));
        assert!(
            ran.status.success(),
            "{}; {advice}",
            String::from_utf8_lossy(&ran.stderr)
        );
    };
    let mut venv = Command::new("python3");
    venv.args(["-m", "venv", "--clear"]).arg(&folder);
    run(&mut venv, "install python3 and python3-venv");
    let mut pip = Command::new(&python);
    pip.args([
        "-m",
        "pip",
        "install",
        "--quiet",
        "--require-hashes",
        "--no-deps",
        "-r",
    ])
    .arg(&requirements);
    run(&mut pip, "check the network and PyPI");
    fs::write(&stamp, wanted).unwrap();
    python
}

/// Points by name, by stamp in hundredths of a second, in the tank's axes.
type PointsByStamp = BTreeMap<u64, BTreeMap<String, [f64; 3]>>;

fn hundredths(seconds: f64) -> u64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let hundredths = (seconds * 100.0).round() as u64;
    hundredths
}

/// The recording, through `calibrate`'s reader, whose axes are Motive's.
fn recorded(path: &Path) -> PointsByStamp {
    let file = calibrate::read_tracks(&fs::read(path).unwrap(), path).unwrap();
    let mut seen = PointsByStamp::new();
    for (row, time) in file.times.iter().enumerate() {
        let points = seen.entry(hundredths(*time)).or_default();
        for point in &file.points {
            if let Some(place) = point.position(row) {
                points.insert(point.name.clone(), [place.z, place.x, place.y]);
            }
        }
    }
    seen
}

#[track_caller]
fn assert_near(one: [f64; 3], other: [f64; 3]) {
    for (a, b) in one.iter().zip(other) {
        // A micrometre in the recording, single precision on the wire.
        assert!((a - b).abs() < 2e-6, "{one:?} {other:?}");
    }
}

fn triple(value: &Value) -> [f64; 3] {
    let values: Vec<f64> = value
        .as_array()
        .unwrap()
        .iter()
        .map(|v| v.as_f64().unwrap())
        .collect();
    values[..3].try_into().unwrap()
}

#[test]
fn an_independent_reader_and_ours_decode_what_the_twin_recorded() {
    let python = python();
    let folder = tempfile::tempdir().unwrap();
    let mut twin = Streaming::start(folder.path(), &[]);
    let (_, port) = twin.cameras.rsplit_once(':').unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/natnet/read_stream.py");
    let reader = Command::new(python)
        .arg("-B")
        .arg(script)
        .args(["127.0.0.1", port, "8", "read.json"])
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let source = format!("natnet:{}", twin.cameras);
    let ours = command(
        folder.path(),
        &[
            "track",
            &source,
            "--seconds",
            "8",
            "-o",
            "live.csv",
            "--json",
        ],
    )
    .stdout(Stdio::piped())
    .stderr(Stdio::piped())
    .spawn()
    .unwrap();
    // A robot that moves: frames that are shifted in time would not match.
    let words = [
        "robot",
        "play",
        "--gait",
        "circle:70deg",
        "--period",
        "4",
        "--cycles",
        "1",
        "--port",
    ];
    swimmer_in(
        folder.path(),
        &[&words[..], &[twin.robot.as_str()]].concat(),
    )
    .with_status(0);
    let reader = reader.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&reader.stdout).into_owned()
        + &String::from_utf8_lossy(&reader.stderr);
    assert!(reader.status.success(), "{said}");
    assert!(!said.contains("Warning"), "{said}");
    let ours: crate::binary::Ran = ours.wait_with_output().unwrap().into();
    let ours = ours.with_status(0).json();
    twin.end();
    let truth = recorded(&folder.path().join("run.csv"));

    let text = fs::read_to_string(folder.path().join("read.json")).unwrap();
    check_independent(&serde_json::from_str(&text).unwrap(), &truth);
    assert!(
        number(&ours, "rate_hz") > 90.0 && number(&ours, "latency_ms") < 50.0,
        "{ours:#}"
    );
    assert_eq!(ours["malformed"], 0, "{ours:#}");
    check_ours(&folder.path().join("live.csv"), &truth);
}

/// Definitions and frames of the independent reader.
fn check_independent(read: &Value, truth: &PointsByStamp) {
    assert_eq!(
        (&read["application"], &read["version"]),
        (&"swimmer twin".into(), &"4.1.0.0".into())
    );
    assert_eq!(read["sets"]["robot"], serde_json::json!(["Front", "Back"]));
    assert_eq!(
        read["bodies"]["robot"]["markers"],
        serde_json::json!(["Front", "Back"])
    );
    let frames = read["frames"].as_array().unwrap();
    assert!(frames.len() > 500, "{} frames", frames.len());
    let (mut compared, mut hidden, mut moved) = (0, 0, 0.0_f64);
    let mut first: Option<[f64; 3]> = None;
    for frame in frames {
        let points = &truth[&hundredths(number(frame, "t"))];
        assert_eq!(
            hundredths(number(frame, "exposure") * 1e-6),
            hundredths(number(frame, "t"))
        );
        for marker in frame["labeled"].as_array().unwrap() {
            if marker["unlabeled"] == true {
                continue;
            }
            let name =
                ["", "Front", "Back"][usize::try_from(marker["member"].as_u64().unwrap()).unwrap()];
            assert_eq!(marker["model"], read["bodies"]["robot"]["id"]);
            let occluded = marker["occluded"] == true;
            assert_eq!(points.contains_key(name), !occluded, "{frame}");
            if occluded {
                hidden += 1;
                continue;
            }
            let [y, z, x] = triple(&marker["position"]);
            assert_near([x, y, z], points[name]);
            let from = *first.get_or_insert([x, y, z]);
            moved = moved.max((from[0] - x).hypot(from[1] - y));
            compared += 1;
        }
        let unlabeled = frame["labeled"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|m| m["unlabeled"] == true);
        let ghosts = points.keys().filter(|name| name.starts_with("Unlabeled"));
        assert_eq!(unlabeled.count(), ghosts.count());
        let body = &frame["bodies"][0];
        let both = points.contains_key("Front") && points.contains_key("Back");
        assert_eq!(body["valid"], both);
        if both {
            let [y, _, x] = triple(&body["position"]);
            let middle = [0, 1].map(|i| f64::midpoint(points["Front"][i], points["Back"][i]));
            assert!((middle[0] - x).hypot(middle[1] - y) < 3e-6);
            // A turn about Motive's vertical, Y.
            let turn = body["rotation"].as_array().unwrap();
            let heading = 2.0 * turn[1].as_f64().unwrap().atan2(turn[3].as_f64().unwrap());
            let (front, back) = (points["Front"], points["Back"]);
            let expected = (front[1] - back[1]).atan2(front[0] - back[0]);
            assert!((heading - expected).sin().abs() < 1e-3 && (heading - expected).cos() > 0.0);
        }
    }
    assert!(
        compared > 900 && moved > 0.05,
        "{compared} compared, {hidden} hidden, moved {moved} m"
    );
}

/// The recording of our own reader.
fn check_ours(file: &Path, truth: &PointsByStamp) {
    let live = calibrate::read_tracks(&fs::read(file).unwrap(), file).unwrap();
    assert!(live.frames() > 500);
    // Frames that arrive before the definition of the models have points without names.
    let is_named = |row: usize| {
        ["Front", "Back"].iter().any(|name| {
            let point = live.points.iter().find(|point| point.name == *name);
            point.is_some_and(|point| point.position(row).is_some())
        })
    };
    let first = (0..live.frames()).find(|row| is_named(*row)).unwrap();
    assert!(first < 100, "no names in the first {first} frames");
    for (row, time) in live.times.iter().enumerate().skip(first) {
        let points = &truth[&hundredths(*time)];
        for name in ["Front", "Back"] {
            let point = live.points.iter().find(|point| point.name == name).unwrap();
            let place = point.position(row);
            assert_eq!(place.is_some(), points.contains_key(name), "row {row}");
            if let Some(place) = place {
                assert_near(place.into(), points[name]);
            }
        }
    }
}
