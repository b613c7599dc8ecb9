//! Warnings and results for faults of a laboratory: a table, compared with `tests/messages/table.txt`, so that a change of behaviour
//! is a change of that file.

use crate::judged;
use crate::lab;

use std::fmt::Write as _;
use std::path::Path;

use calibrate::{FitOptions, Verdict};
use judged::Judged;
use lab::Lab;

const SIX: &[f64] = &[30.0, 50.0, 70.0, 85.0, 100.0, 110.0];
const FOUR: &[f64] = &[40.0, 65.0, 90.0, 110.0];

/// Name of a fault, amplitudes of the runs, and the fault.
type Fault = (&'static str, &'static [f64], fn(&mut Lab));

fn dead_band(lab: &mut Lab, degrees: f64) {
    for joint in &mut lab.joints {
        joint.dead_band = degrees.to_radians();
    }
}

fn offsets(lab: &mut Lab, degrees: [f64; 2]) {
    for (joint, offset) in lab.joints.iter_mut().zip(degrees) {
        joint.offset = offset.to_radians();
    }
}

const CASES: &[Fault] = &[
    ("nothing", SIX, |_| {}),
    ("nothing", FOUR, |_| {}),
    ("drift 0.2 mm/s", SIX, |lab| {
        for run in &mut lab.runs {
            run.faults.drift = [1.6e-4, 1.2e-4];
        }
    }),
    ("drift 0.2 mm/s in two", SIX, |lab| {
        for run in &mut lab.runs[2..4] {
            run.faults.drift = [1.6e-4, 1.2e-4];
        }
    }),
    ("offsets +2°, −1°", SIX, |lab| offsets(lab, [2.0, -1.0])),
    ("wall × 0.97 in two", SIX, |lab| {
        lab.runs[1].wall = 0.97;
        lab.runs[4].wall = 0.97;
    }),
    ("wall × 0.97 in all", SIX, |lab| {
        lab.runs.iter_mut().for_each(|run| run.wall = 0.97);
    }),
    ("cameras' plane tilted 3°", SIX, |lab| {
        lab.cameras.tilt = 3_f64.to_radians();
    }),
    ("lag 60 ms", SIX, |lab| {
        lab.joints.iter_mut().for_each(|joint| joint.lag_s = 0.06);
    }),
    ("lag 60 ms in front", SIX, |lab| lab.joints[0].lag_s = 0.06),
    ("gain 0.97", SIX, |lab| *lab = lab.clone().with_gain(0.97)),
    ("dead band 1°", SIX, |lab| dead_band(lab, 1.0)),
    ("dead band 3°", SIX, |lab| dead_band(lab, 3.0)),
    ("dead band 6°", SIX, |lab| dead_band(lab, 6.0)),
    ("dead band 12°", SIX, |lab| dead_band(lab, 12.0)),
    ("two swapped", SIX, |lab| {
        for run in [1, 3] {
            lab.runs[run].faults.exchanged = true;
        }
    }),
    ("two swapped", FOUR, |lab| {
        for run in [1, 3] {
            lab.runs[run].faults.exchanged = true;
        }
    }),
    ("two clockwise", SIX, |lab| {
        for run in [1, 3] {
            lab.runs[run].clockwise = true;
        }
    }),
    ("two clockwise", FOUR, |lab| {
        for run in [1, 3] {
            lab.runs[run].clockwise = true;
        }
    }),
];

const NOISES: [f64; 2] = [3e-4, 1e-3];

/// Line of the table, and whether it is right: the truth within the intervals, or a refusal.
fn line(case: &Fault, noise: f64) -> (String, bool) {
    let (name, runs, change) = case;
    let mut lab = Lab::sparse(1).with_runs(runs).with_noise(noise);
    change(&mut lab);
    let head = format!("{name}, {} runs, {:.1} mm: ", runs.len(), 1e3 * noise);
    let judged = match Judged::at(&lab, FitOptions::default().level) {
        Err(refused) => return (format!("{head}refused: {refused}\n"), true),
        Ok(judged) => judged,
    };
    let headline = &judged.assessment.headline;
    let off = |value: f64, truth: f64| 100.0 * (value / truth - 1.0);
    let inside = judged.holds() == [true; 2];
    let [r, chi] = judged.widths();
    let mut text = format!(
        "{head}{}; r_s {:+.1} ± {:.1} %, χ {:+.1} ± {:.1} %, {}\n",
        judged.assessment.verdict,
        off(headline.estimate.sphere_radius, judged.truth[0]),
        100.0 * r,
        off(headline.estimate.chi, judged.truth[1]),
        100.0 * chi,
        if inside { "inside" } else { "OUTSIDE" },
    );
    for reason in &judged.assessment.reasons {
        writeln!(text, "    {}", told(reason)).unwrap();
    }
    (
        text,
        inside || judged.assessment.verdict == Verdict::DoNotUse,
    )
}

/// A reason without its numbers, which hang on the machine's last digits.
fn told(reason: &str) -> String {
    let short = reason.split(": look at it").next().unwrap_or(reason);
    let mut out = String::new();
    for word in short.split_inclusive(' ') {
        let is_number = |c: char| c.is_ascii_digit() || "+-−.±%°(),;".contains(c);
        let bare = word.trim_end();
        if bare.is_empty() || !bare.chars().all(is_number) {
            out.push_str(word);
        } else if !out.ends_with("… ") {
            out.push_str("… ");
        }
    }
    out.trim_end().to_owned()
}

#[test]
fn what_is_told_and_what_comes_out() {
    let jobs: Vec<(&Fault, f64)> = CASES
        .iter()
        .flat_map(|case| NOISES.map(|noise| (case, noise)))
        .collect();
    let half = jobs.len() / 2;
    let all = |jobs: &[(&Fault, f64)]| -> Vec<(String, bool)> {
        jobs.iter()
            .map(|(case, noise)| line(case, *noise))
            .collect()
    };
    let lines = std::thread::scope(|scope| {
        let first = scope.spawn(|| all(&jobs[..half]));
        let second = all(&jobs[half..]);
        [first.join().unwrap(), second].concat()
    });
    let table: String = lines.iter().map(|(line, _)| line.as_str()).collect();
    println!("{table}");
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/messages/table.txt");
    if std::env::var_os("UPDATE_OUTCOMES").is_some() {
        std::fs::create_dir_all(golden.parent().unwrap()).unwrap();
        std::fs::write(&golden, &table).unwrap();
    }
    let wrong: Vec<&str> = lines
        .iter()
        .filter(|(_, right)| !right)
        .map(|(line, _)| line.as_str())
        .collect();
    assert!(
        wrong.is_empty(),
        "neither within nor refused:\n{}",
        wrong.concat()
    );
    let kept = std::fs::read_to_string(&golden).unwrap_or_default();
    assert!(
        kept == table,
        "the table changed; look at it, then run with UPDATE_OUTCOMES=1:\n{table}"
    );
}
