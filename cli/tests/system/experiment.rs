//! `swimmer experiment` on the twin: killed and resumed, compared, packed.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::binary::{command, number, swimmer_in};

const SPEC: &str = r#"
swimmer = "robot"
drive = "straight"
repeats = 3
cycles = 1
period = 6.0
settle = 1.0
[tank]
length = 1.6
width = 1.2
[start]
within = 0.02
within_angle = "5deg"
[[gait]]
name = "small"
gait = "circle:50deg"
[[gait]]
name = "middle"
gait = "circle:70deg"
neighbours = 0.1
"#;

/// A folder with the spec and the gaits to drive with.
fn laboratory() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("spec.toml"), SPEC).unwrap();
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../experiment/tests/straight");
    let to = folder.path().join("straight");
    std::fs::create_dir(&to).unwrap();
    for name in ["forward", "left", "turn-left"] {
        let file = format!("{name}.gait");
        std::fs::copy(from.join(&file), to.join(&file)).unwrap();
    }
    folder
}

/// Whole lines of the journal.
fn journal(folder: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(folder.join("spec/journal.jsonl")).unwrap_or_default();
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    let lines = whole.lines();
    lines
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

fn finished(journal: &[Value]) -> Vec<u64> {
    let trials = journal
        .iter()
        .filter_map(|record| record["entry"]["finished"]["trial"].as_u64());
    trials.collect()
}

const RUN: [&str; 7] = [
    "experiment",
    "run",
    "spec.toml",
    "--port",
    "twin",
    "--track",
    "twin",
];

#[test]
fn a_run_that_is_killed_five_times_loses_and_repeats_no_finished_trial() {
    let laboratory = laboratory();
    let folder = laboratory.path();
    let planned = swimmer_in(folder, &["experiment", "plan", "spec.toml", "--json"]).with_status(0);
    let trials = number(&planned.json(), "runs");
    assert!((trials - 12.0).abs() < 0.5, "{trials}");
    // The plan depends on the spec alone.
    swimmer_in(folder, &["experiment", "plan", "spec.toml", "-o", "again"]).with_status(0);
    let plan = |name: &str| std::fs::read(folder.join(name).join("plan.json")).unwrap();
    assert_eq!(plan("spec"), plan("again"));

    // Lines of the journal after which it is killed: while it drives, plays, and between trials.
    for more in [2, 3, 4, 3, 5] {
        let before = journal(folder);
        let mut child = command(folder, &RUN)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let begun = Instant::now();
        while journal(folder).len() < before.len() + more {
            assert!(
                begun.elapsed() < Duration::from_mins(4),
                "the run stands still"
            );
            assert!(
                child.try_wait().unwrap().is_none(),
                "the run ended by itself"
            );
            std::thread::sleep(Duration::from_millis(20));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let after = journal(folder);
        assert_eq!(before, after[..before.len()], "nothing is lost");
    }
    let left = finished(&journal(folder)).len();
    println!("killed five times, {left} of 12 trials finished by then");
    assert!(left < 12);
    let words = [&RUN[..], &["--json"]].concat();
    let ran = swimmer_in(folder, &words).with_status(0).json();
    println!("{ran:#}");
    assert_eq!((&ran["runs"], &ran["done"]), (&12.into(), &12.into()));

    let records = journal(folder);
    let numbers = finished(&records);
    let unique: BTreeSet<u64> = numbers.iter().copied().collect();
    assert_eq!(
        (numbers.len(), unique),
        (12, (1..=12).collect()),
        "each once"
    );
    for record in &records {
        if let Some(track) = record["entry"]["finished"]["track"].as_str() {
            let rows = std::fs::read_to_string(folder.join("spec").join(track)).unwrap();
            assert!(rows.lines().count() > 500, "{track}");
        }
    }
    // Nothing is left to do.
    let again = swimmer_in(folder, &words).with_status(0).json();
    assert_eq!(again["finished_now"], 0);

    let words = ["experiment", "report", "spec.toml", "--json"];
    let report = swimmer_in(folder, &words).with_status(0).json();
    for gait in report["gaits"].as_array().unwrap() {
        println!("{gait}");
        let (measured, predicted) = (number(gait, "measured_m"), number(gait, "predicted_m"));
        assert!((measured / predicted - 1.0).abs() < 0.1, "{gait:#}");
        assert!(number(gait, "interval_m") > 0.0, "{gait:#}");
        assert_eq!(gait["runs"], 3);
    }
    // A larger circle swims farther: the smaller neighbour is beaten, the larger one is not.
    let comparisons = report["comparisons"].as_array().unwrap();
    let shown: Vec<_> = comparisons
        .iter()
        .map(|one| (&one["than"], &one["shown"]))
        .collect();
    assert_eq!(
        shown,
        [
            (&"middle-10".into(), &true.into()),
            (&"middle+10".into(), &false.into())
        ]
    );
    let page = std::fs::read_to_string(folder.join("spec/report.html")).unwrap();
    let is_whole = page.contains("<svg") && !page.contains("src=") && !page.contains("<link");
    assert!(is_whole, "the page asks for nothing from outside");
    packed(folder);
}

/// The archive holds every file, and its checksums hold.
fn packed(folder: &Path) {
    let words = ["experiment", "pack", "spec", "--json"];
    let packed = swimmer_in(folder, &words).with_status(0).json();
    assert!(number(&packed, "files") > 20.0, "{packed:#}");
    let out = folder.join("unpacked");
    std::fs::create_dir(&out).unwrap();
    let run = |program: &str, words: &[&str], at: &Path| {
        let ran = Command::new(program)
            .args(words)
            .current_dir(at)
            .output()
            .unwrap();
        assert!(
            ran.status.success(),
            "{program}: {}",
            String::from_utf8_lossy(&ran.stderr)
        );
        String::from_utf8(ran.stdout).unwrap()
    };
    run("tar", &["-xzf", "../spec.tar.gz"], &out);
    let checked = run("sha256sum", &["-c", "SHA256SUMS"], &out.join("spec"));
    assert!(
        checked.lines().count() > 20 && !checked.contains("FAILED"),
        "{checked}"
    );
    let again = [&words[..], &["-o", "again.tar.gz"]].concat();
    let again = swimmer_in(folder, &again).with_status(0).json();
    assert_eq!(
        again["sha256"], packed["sha256"],
        "the same folder gives the same bytes"
    );
}

const CAMPAIGN: &str = r#"
swimmer = "robot"
drive = "straight"
cycles = 2
period = 6.0
settle = 1.0
[adaptive]
chi = 0.002
sphere_radius = 0.0003
hours = 0.3
[tank]
length = 1.6
width = 1.2
[start]
within = 0.02
within_angle = "5deg"
[[gait]]
name = "small"
gait = "circle:40deg"
[[gait]]
name = "middle"
gait = "circle:70deg"
[[gait]]
name = "large"
gait = "circle:100deg"
"#;

/// Gaits that an adaptive campaign has chosen, by the numbers of their trials.
fn chosen(journal: &[Value]) -> Vec<(u64, String)> {
    let chosen = journal.iter().filter_map(|record| {
        let chosen = &record["entry"]["chosen"];
        Some((
            chosen["trial"].as_u64()?,
            chosen["gait"].as_str()?.to_owned(),
        ))
    });
    chosen.collect()
}

/// The campaign chooses its gaits until both intervals are as narrow as requested. Killed on the way, it chooses on by its journal.
#[test]
fn an_adaptive_campaign_reaches_its_goal() {
    let laboratory = laboratory();
    let folder = laboratory.path();
    std::fs::write(folder.join("spec.toml"), CAMPAIGN).unwrap();
    let planned = swimmer_in(folder, &["experiment", "plan", "spec.toml"]).with_status(0);
    assert!(
        planned.stdout.contains("An adaptive campaign of 3 gaits"),
        "{planned}"
    );

    let mut child = command(folder, &RUN)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while chosen(&journal(folder)).len() < 3 {
        let is_running = child.try_wait().unwrap().is_none();
        assert!(is_running && begun.elapsed() < Duration::from_mins(4));
        std::thread::sleep(Duration::from_millis(20));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let before = journal(folder);

    let words = [&RUN[..], &["--json"]].concat();
    let ran = swimmer_in(folder, &words).with_status(0).json();
    println!("{ran:#}");
    let records = journal(folder);
    assert_eq!(before, records[..before.len()], "nothing is lost");
    let gaits = chosen(&records);
    let numbers: Vec<u64> = gaits.iter().map(|(number, _)| *number).collect();
    assert_eq!(
        numbers,
        finished(&records),
        "each trial was chosen once, and played"
    );
    let first: BTreeSet<&str> = gaits[..3].iter().map(|(_, gait)| gait.as_str()).collect();
    assert_eq!(
        first.len(),
        3,
        "the first trials play different gaits: {gaits:?}"
    );
    assert_eq!(records.last().unwrap()["entry"], "complete");

    let advice = &ran["adaptive"];
    assert_eq!(advice["decision"], "reached", "{ran:#}");
    // The virtual tank holds the swimmer of the spec.
    let fit = &advice["estimate"];
    for (value, half, truth, goal) in [
        ("chi", "chi_half_width", 3.598, 0.002 * 3.598),
        (
            "sphere_radius_m",
            "sphere_radius_half_width_m",
            0.0692,
            3e-4,
        ),
    ] {
        assert!(number(fit, half) <= 1.01 * goal, "{fit:#}");
        assert!((number(fit, value) - truth).abs() <= 3.0 * goal, "{fit:#}");
    }
    let words = ["experiment", "status", "spec.toml"];
    let status = swimmer_in(folder, &words).with_status(0);
    assert!(status.stdout.contains("as narrow as requested"), "{status}");
    let words = ["experiment", "report", "spec.toml", "--json"];
    let report = swimmer_in(folder, &words).with_status(0).json();
    assert_eq!(report["adaptive"], *advice);
    let page = std::fs::read_to_string(folder.join("spec/report.html")).unwrap();
    assert!(page.contains("The calibration so far"));
}

#[test]
fn mistakes_are_refused_before_anything_moves() {
    let laboratory = laboratory();
    let folder = laboratory.path();
    let refused = |words: &[&str], text: &str| {
        let ran = swimmer_in(folder, words).with_status(2);
        assert!(ran.stderr.contains(text), "{ran}");
    };
    refused(&RUN, "holds no planned experiment");
    refused(
        &["experiment", "pack", "straight"],
        "holds no planned experiment",
    );
    let small = SPEC.replace("length = 1.6", "length = 0.36");
    std::fs::write(folder.join("small.toml"), small).unwrap();
    refused(&["experiment", "plan", "small.toml"], "wall");
    assert!(
        !folder.join("small").exists(),
        "nothing half-written stays behind"
    );
    let fast = SPEC.replace("period = 6.0", "period = 1.5");
    std::fs::write(folder.join("fast.toml"), fast).unwrap();
    refused(&["experiment", "plan", "fast.toml"], "the servos need");

    swimmer_in(folder, &["experiment", "plan", "spec.toml"]).with_status(0);
    std::fs::write(
        folder.join("spec.toml"),
        SPEC.replace("repeats = 3", "repeats = 4"),
    )
    .unwrap();
    refused(&RUN, "has changed since");
    std::fs::write(folder.join("spec.toml"), SPEC).unwrap();
    let [words @ .., _] = RUN;
    let live: Vec<&str> = words.into_iter().chain(["-"]).collect();
    refused(&live, "--track twin");
}
