//! The first morning, with a twin whose servos are not as its robot believes. The operator here knows nothing of how they were
//! built: every answer is what the twin's joints are seen to do, to a whole degree, as at a protractor.

use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Stdio};
use std::sync::{Arc, Mutex};
use std::thread::{self, sleep};
use std::time::Duration;

use serde_json::Value;

use crate::binary::{Ran, command, number, swimmer_in};

/// A joint that was seen to turn by less did not turn.
const SEEN_DEG: f64 = 4.0;
/// Time without a new line after which the joints are at rest; the twin lives in real time and may be kept from it for a while.
const AT_REST: Duration = Duration::from_millis(1_200);

/// A twin, and what is seen of its joints.
struct Twin {
    folder: PathBuf,
    servos: Vec<String>,
    process: Mutex<Child>,
    /// Both angles, degrees, each time that they had come to rest.
    seen: Arc<Mutex<Vec<[f64; 2]>>>,
}

impl Twin {
    fn with(folder: &Path, servos: &[&str]) -> Self {
        let seen = Arc::new(Mutex::new(Vec::new()));
        let servos: Vec<String> = servos.iter().map(|&word| word.to_owned()).collect();
        let process = Mutex::new(Self::start(folder, &servos, &seen));
        Self {
            folder: folder.to_owned(),
            servos,
            process,
            seen,
        }
    }

    fn start(folder: &Path, servos: &[String], seen: &Arc<Mutex<Vec<[f64; 2]>>>) -> Child {
        let servos = servos.iter().map(String::as_str);
        let words: Vec<&str> = ["twin", "--pty", "robot", "--show-joints"]
            .into_iter()
            .chain(servos)
            .collect();
        let mut process = command(folder, &words)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(process.stdout.take().unwrap()).lines();
        assert!(lines.next().unwrap().unwrap().contains("runs at"));
        let sees = Arc::clone(seen);
        thread::spawn(move || {
            for line in lines.map_while(Result::ok) {
                if let Some(angles) = angles(&line) {
                    sees.lock().unwrap().push(angles);
                }
            }
        });
        process
    }

    /// Takes the pseudo-terminal away; a new robot with the same servos comes back under its name.
    fn restart(&self) {
        let mut process = self.process.lock().unwrap();
        process.kill().unwrap();
        process.wait().unwrap();
        sleep(Duration::from_secs(2));
        *process = Self::start(&self.folder, &self.servos, &self.seen);
    }

    /// Everything seen so far, once the joints are at rest.
    fn seen(&self) -> Vec<[f64; 2]> {
        loop {
            let before = self.seen.lock().unwrap().len();
            sleep(AT_REST);
            let seen = self.seen.lock().unwrap();
            if seen.len() == before && before > 0 {
                return seen.clone();
            }
        }
    }
}

impl Drop for Twin {
    fn drop(&mut self) {
        let mut process = self.process.lock().unwrap();
        let _ = process.kill();
        let _ = process.wait();
    }
}

/// `… joints  front +25.0°  back +0.0°`.
fn angles(line: &str) -> Option<[f64; 2]> {
    let (_, joints) = line.split_once("joints")?;
    let mut angles = joints
        .split_whitespace()
        .filter_map(|word| word.strip_suffix('°')?.parse().ok());
    Some([angles.next()?, angles.next()?])
}

/// Whoever stands before the robot.
struct Operator<'a> {
    twin: &'a Twin,
    answers: ChildStdin,
    /// Amount of output when the last question was answered.
    looked: usize,
    /// The answer to how far a joint may turn.
    ends: &'a str,
    /// The question at which the operator walks away.
    leaves_at: &'a str,
    /// Questions at which the robot restarts, each once.
    restarts: Vec<&'a str>,
}

impl Operator<'_> {
    /// Answers what was printed since the last answer, if it is a question.
    fn answer(&mut self, line: &str) -> Option<String> {
        if line.contains(self.leaves_at) {
            return Some("q".to_owned());
        }
        let restart = self.restarts.iter().position(|at| line.contains(at));
        if let Some(index) = restart.filter(|_| is_asked(line)) {
            self.restarts.remove(index);
            self.twin.restart();
            // The set-up asks again.
            return None;
        }
        let last = |name: &str| {
            line.rfind(&format!("{name}:"))
                .max(line.rfind(&format!("{name},")))
        };
        let joint = usize::from(last("back") > last("front"));
        let answer =
            if line.ends_with("[Enter or y: go on; n: leave]") || line.contains("Enter takes it") {
                String::new()
            } else if line.contains("Which one turned?") {
                let turned = [0, 1].map(|joint| self.swept(joint) > SEEN_DEG);
                match turned {
                    [true, false] => "front",
                    [false, true] => "back",
                    [true, true] => "both",
                    [false, false] => "none",
                }
                .to_owned()
            } else if line.ends_with("which angle does the joint show?") {
                let seen = self.twin.seen();
                format!("{:.0}", seen.last().unwrap()[joint] + 0.0)
            } else if line.contains("how far may the joint turn") {
                self.ends.to_owned()
            } else if line.contains("Are both links straight") {
                let straight = self
                    .twin
                    .seen()
                    .last()
                    .unwrap()
                    .iter()
                    .all(|angle| angle.abs() < 9.0);
                if straight { "y" } else { "n" }.to_owned()
            } else if line.contains("Swing each joint") {
                "y".to_owned()
            } else if line.contains("did it turn all the way") {
                // Its dead band short of 60° to either side, and there and back.
                let all = self.swept(joint) > 100.0 && self.leftwards_first(joint);
                if all { "y" } else { "n" }.to_owned()
            } else {
                return None;
            };
        self.looked = self.twin.seen.lock().unwrap().len();
        Some(answer)
    }

    /// The swing begins to the left.
    fn leftwards_first(&self, joint: usize) -> bool {
        let seen = self.twin.seen();
        let mut far = seen[self.looked..].iter().map(|angles| angles[joint]);
        far.find(|angle| angle.abs() > 40.0)
            .is_some_and(|angle| angle > 0.0)
    }

    /// From the least to the largest angle since the last answer, degrees.
    fn swept(&self, joint: usize) -> f64 {
        let seen = self.twin.seen();
        let since = &seen[self.looked.saturating_sub(1)..];
        let of = |pick: fn(f64, f64) -> f64, from: f64| {
            since.iter().map(|angles| angles[joint]).fold(from, pick)
        };
        of(f64::max, f64::NEG_INFINITY) - of(f64::min, f64::INFINITY)
    }
}

/// The text ends with a question at which the robot may restart.
fn is_asked(text: &str) -> bool {
    text.ends_with("which angle does the joint show?")
        || text.ends_with("[front, back, both, none]")
}

/// Runs the setup to its end; gives all that was said and answered.
fn set_up(folder: &Path, twin: &Twin, more: &[&str], ends: &str, leaves_at: &str) -> (String, Ran) {
    set_up_with_restarts(folder, twin, more, ends, leaves_at, Vec::new())
}

fn set_up_with_restarts(
    folder: &Path,
    twin: &Twin,
    more: &[&str],
    ends: &str,
    leaves_at: &str,
    restarts: Vec<&str>,
) -> (String, Ran) {
    let words = [&["robot", "setup", "--port", "robot"], more].concat();
    let mut setup = command(folder, &words)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut operator = Operator {
        twin,
        answers: setup.stdin.take().unwrap(),
        looked: 0,
        ends,
        leaves_at,
        restarts,
    };
    let (mut said, mut question) = (String::new(), String::new());
    for line in BufReader::new(setup.stdout.take().unwrap()).lines() {
        let line = line.unwrap();
        said.push_str(&line);
        said.push('\n');
        // A question may take several lines.
        question = format!("{question} {line}");
        if let Some(answer) = operator.answer(&question) {
            writeln!(operator.answers, "{answer}").unwrap();
            question.clear();
        }
    }
    (said, setup.wait_with_output().unwrap().into())
}

fn servo(folder: &Path, joint: &str) -> Value {
    let words = ["robot", "servo", joint, "--port", "robot", "--json"];
    swimmer_in(folder, &words).with_status(0).json()
}

#[test]
fn a_mirrored_an_off_centre_and_two_sluggish_servos_are_found_and_set_up() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let odd = [
        "--servo",
        "front:sign=-",
        "--servo",
        "back:centre=1512",
        "--dead-band",
        "8deg",
    ];
    let twin = Twin::with(folder, &odd);
    assert_eq!(
        servo(folder, "front")["sign"],
        "+",
        "nobody has told the robot"
    );

    let more = ["--swimmer", "robot", "--output", "ours.toml"];
    let (said, ran) = set_up(folder, &twin, &more, "60 60", "no such question");
    assert_eq!(ran.status, 0, "{said}{ran}");
    insta::assert_snapshot!("setup", said);

    let (front, back) = (servo(folder, "front"), servo(folder, "back"));
    assert_eq!((&front["sign"], &back["sign"]), (&"-".into(), &"+".into()));
    for (servo, centre) in [(&front, 1500.0), (&back, 1512.0)] {
        // A degree is 0.64 µs.
        assert!(
            (number(servo, "centre_us") - centre).abs() < 0.7,
            "{servo:#}"
        );
        let reach = servo["reach_rad"].as_array().unwrap();
        for end in reach {
            assert!(
                (end.as_f64().unwrap().abs() - 60f64.to_radians()).abs() < 1e-3,
                "{servo:#}"
            );
        }
    }
    // Predictions use the measured values.
    let file = std::fs::read_to_string(folder.join("ours.toml")).unwrap();
    assert!(
        file.contains("swimmer robot servo front --sign -"),
        "{file}"
    );
    let words = [
        "robot",
        "upload",
        "circle:20deg",
        "--dry-run",
        "--swimmer",
        "ours.toml",
        "--json",
    ];
    let told = swimmer_in(folder, &words).with_status(0).json();
    let dead_band = number(&told["preflight"], "dead_band_rad").to_degrees();
    assert!((dead_band - 8.0).abs() < 1.0, "{dead_band}");
    assert_eq!(told["preflight"]["dead_band_assumed"], false);

    let beyond = ["robot", "upload", "circle:70deg", "--port", "robot"];
    let refused = swimmer_in(folder, &beyond).with_status(1);
    assert!(
        refused.stderr.contains("limit"),
        "an end stop is a limit: {refused}"
    );
}

/// The line is gone at two questions; the answers so far are kept.
#[cfg(unix)]
#[test]
fn a_lost_link_is_waited_for_and_the_set_up_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let odd = ["--servo", "back:centre=1512", "--dead-band", "8deg"];
    let twin = Twin::with(folder, &odd);
    let more = ["--swimmer", "robot", "--output", "ours.toml"];
    let restarts = vec!["Which one turned", "back, 3 of 4"];
    let (said, ran) = set_up_with_restarts(folder, &twin, &more, "60 60", "no such", restarts);
    assert_eq!(ran.status, 0, "{said}{ran}");
    assert_eq!(said.matches("The link was lost").count(), 2, "{said}");
    // Each reading was taken once; the interrupted questions were asked twice.
    let unwrapped = said.replace('\n', " ");
    for (question, times) in [
        ("front, 4 of 4", 1),
        ("back, 2 of 4", 1),
        ("back, 3 of 4", 2),
    ] {
        assert_eq!(
            unwrapped.matches(question).count(),
            times,
            "{question}: {said}"
        );
    }
    for (joint, centre) in [("front", 1500.0), ("back", 1512.0)] {
        let servo = servo(folder, joint);
        assert!(
            (number(&servo, "centre_us") - centre).abs() < 0.7,
            "{servo:#}"
        );
    }
}

#[test]
fn whoever_leaves_finds_the_robot_stopped_and_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let twin = Twin::with(folder, &["--servo", "front:sign=-,centre=1490"]);
    let trim = ["robot", "trim", "--front", "2deg", "--port", "robot"];
    swimmer_in(folder, &trim).with_status(0);
    let before = [servo(folder, "front"), servo(folder, "back")];
    let (said, ran) = set_up(folder, &twin, &[], "", "front: dead band");
    assert_eq!(ran.status, 1, "{said}{ran}");
    assert!(ran.stderr.contains("left the setup"), "{ran}");
    assert!(ran.stderr.contains("stopped and as it was"), "{ran}");
    assert!(said.contains("turns the other way"), "{said}");
    assert_eq!(before, [servo(folder, "front"), servo(folder, "back")]);
    let words = ["robot", "status", "--port", "robot", "--json"];
    let status = swimmer_in(folder, &words).with_status(0).json();
    assert_eq!(status["state"], "stopped", "{status:#}");
}

/// A script whose answers end is one that leaves.
#[test]
fn answers_that_end_leave_the_robot_stopped() {
    let words = ["robot", "setup", "--port", "twin"];
    let ran = command(&std::env::temp_dir(), &words)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let ran = Ran::from(ran).with_status(1);
    assert!(ran.stderr.contains("nobody answered"), "{ran}");
}
