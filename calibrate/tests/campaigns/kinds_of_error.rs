//! Kinds of error that a laboratory may have: the verdict, the reason that it names, and the distance of the recommended r_s and χ
//! from the truth in half widths of their intervals.

use crate::judged;
use crate::lab;

use std::fmt::Write as _;

use calibrate::{FitOptions, Verdict};
use judged::{Judged, small_errors, with_systematics};
use lab::Lab;

/// Name, a word of the reason that names it (empty if there is nothing to name), and the error itself.
type Kind = (&'static str, &'static str, fn(&mut Lab));

fn degrees(angle: f64) -> f64 {
    angle.to_radians()
}

const KINDS: [Kind; 24] = [
    ("nothing", "", |_| {}),
    ("gain 0.97", "gain", |lab| {
        *lab = lab.clone().with_gain(0.97);
    }),
    ("gain of the front servo 0.97", "gain", |lab| {
        lab.joints[0].gain = 0.97;
    }),
    ("offsets +2°, −1°", "offset", |lab| {
        (lab.joints[0].offset, lab.joints[1].offset) = (degrees(2.0), degrees(-1.0));
    }),
    ("dead bands 3°", "dead band", |lab| {
        lab.joints
            .iter_mut()
            .for_each(|joint| joint.dead_band = degrees(3.0));
    }),
    ("dead band 4° in front", "dead band", |lab| {
        lab.joints[0].dead_band = degrees(4.0);
    }),
    ("lag 60 ms", "", |lab| {
        lab.joints.iter_mut().for_each(|joint| joint.lag_s = 0.06);
    }),
    ("lag 60 ms in front", "lag", |lab| {
        lab.joints[0].lag_s = 0.06;
    }),
    ("reflectors 3 mm further along", "", |lab| {
        lab.places.front[0] += 3e-3;
        lab.places.back[0] += 3e-3;
    }),
    ("reflectors 3 mm across", "", |lab| {
        lab.places.front[1] += 3e-3;
        lab.places.back[1] += 3e-3;
    }),
    ("reflectors' line turned by 3°", "marker angle", |lab| {
        let across = lab.body.middle / 2.0 * degrees(3.0).tan();
        lab.places.front[1] += across;
        lab.places.back[1] -= across;
    }),
    ("camera scale 1.02", "camera scale", |lab| {
        lab.cameras.scale = 1.02;
    }),
    ("camera tilt 8°", "tilt", |lab| {
        lab.cameras.tilt = degrees(8.0);
    }),
    (
        "lens distortion 10 % at 1 m",
        "the model does not fit",
        |lab| lab.cameras.distortion = 0.1,
    ),
    ("drift 0.2 mm/s", "drift", |lab| {
        lab.runs
            .iter_mut()
            .for_each(|run| run.faults.drift = [1.6e-4, 1.2e-4]);
    }),
    ("wall × 0.97 in all", "wall", |lab| {
        lab.runs.iter_mut().for_each(|run| run.wall = 0.97);
    }),
    ("wall × 0.97 in two", "wall", |lab| {
        lab.runs[1].wall = 0.97;
        lab.runs[4].wall = 0.97;
    }),
    ("middle link 0.5 mm longer", "", |lab| {
        lab.body.middle += 5e-4;
    }),
    ("middle link 2 mm longer", "middle link", |lab| {
        lab.body.middle += 2e-3;
    }),
    ("side links 1 mm longer", "link", |lab| {
        lab.body.front += 1e-3;
        lab.body.back += 1e-3;
    }),
    ("front link 3 mm longer", "link", |lab| {
        lab.body.front += 3e-3;
    }),
    ("float drags 1.5 times against turning", "float", |lab| {
        lab.body.turning = 1.5;
    }),
    ("c_t 10 % larger", "c_t", |lab| lab.body.c_t *= 1.1),
    ("a servo turns at most 0.5 rad/s", "", |lab| {
        lab.joints[1].max_rate = 0.5;
    }),
];

/// Half widths between the recommended values and the truth.
fn deviation(judged: &Judged) -> f64 {
    let headline = &judged.assessment.headline;
    let off = |[low, high]: [f64; 2], value: f64, truth: f64| {
        (value - truth).abs() / ((high - low) / 2.0)
    };
    let r = off(
        headline.intervals.sphere_radius,
        headline.estimate.sphere_radius,
        judged.truth[0],
    );
    let chi = off(
        headline.intervals.chi,
        headline.estimate.chi,
        judged.truth[1],
    );
    r.max(chi)
}

/// The line of a kind, and whether it holds: named if it is worth a name, and never trusted beyond two half widths.
fn line((name, word, change): &Kind, noise: f64) -> (String, bool) {
    let mut lab = Lab::sparse(1).with_noise(noise).with_runs_all_over();
    change(&mut lab);
    let head = format!("{name}, {:.1} mm", 1e3 * noise);
    let judged = match Judged::at(&lab, FitOptions::default().level) {
        Err(refused) => return (format!("{head} | refused | {refused}"), true),
        Ok(judged) => judged,
    };
    let off = deviation(&judged);
    let verdict = judged.assessment.verdict;
    let named = word.is_empty() || judged.names(word);
    let safe = verdict != Verdict::Trust || off <= 2.0;
    let usable = verdict != Verdict::Caution || off <= 3.0;
    let mut text = format!(
        "{head} | {verdict} | {} | {off:.2}",
        if word.is_empty() {
            "–"
        } else if named {
            "named"
        } else {
            "NOT NAMED"
        }
    );
    for reason in &judged.assessment.reasons {
        write!(text, "\n        {reason}").unwrap();
    }
    (text, safe && usable && named)
}

#[test]
fn twenty_four_kinds_of_error() {
    let jobs: Vec<(&Kind, f64)> = KINDS.iter().map(|kind| (kind, 3e-4)).collect();
    let half = jobs.len() / 2;
    let all = |jobs: &[(&Kind, f64)]| -> Vec<(String, bool)> {
        let told = |(kind, noise): &(&Kind, f64)| {
            let told = line(kind, *noise);
            println!("{}", told.0);
            told
        };
        jobs.iter().map(told).collect()
    };
    let lines = std::thread::scope(|scope| {
        let first = scope.spawn(|| all(&jobs[..half]));
        let second = all(&jobs[half..]);
        [first.join().unwrap(), second].concat()
    });
    let wrong: Vec<&str> = lines
        .iter()
        .filter(|(_, holds)| !holds)
        .map(|(line, _)| line.as_str())
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Campaigns of a rule: verdicts `trust`, `caution` and `do not use`, intervals of r_s and of χ that hold the truth, and those that
/// are trusted more than two half widths away from it.
fn counted(of: fn(u64) -> Lab, seeds: std::ops::RangeInclusive<u64>) -> [u32; 6] {
    let seeds: Vec<u64> = seeds.collect();
    let count = |seeds: &[u64]| {
        let mut sums = [0; 6];
        for seed in seeds {
            let judged = Judged::at(&of(*seed), FitOptions::default().level).unwrap();
            let off = deviation(&judged);
            let [r, chi] = judged::holds(&judged.assessment.headline.intervals, judged.truth);
            let verdict = judged.assessment.verdict;
            println!("{seed}: {off:.2} half widths; {}", judged.line());
            let counts = [
                verdict == Verdict::Trust,
                verdict == Verdict::Caution,
                verdict == Verdict::DoNotUse,
                r,
                chi,
                verdict == Verdict::Trust && off > 2.0,
            ];
            for (sum, count) in sums.iter_mut().zip(counts) {
                *sum += u32::from(count);
            }
        }
        sums
    };
    let (first, second) = seeds.split_at(seeds.len() / 2);
    let sums = std::thread::scope(|scope| {
        let one = scope.spawn(|| count(first));
        let two = count(second);
        [one.join().unwrap(), two]
    });
    let sum = std::array::from_fn(|i| sums[0][i] + sums[1][i]);
    println!("trust, caution, do not use, inside r_s, χ, trusted beyond two half widths: {sum:?}");
    sum
}

#[test]
#[ignore = "a hundred campaigns"]
fn a_hundred_campaigns_with_small_unmodelled_errors_are_covered() {
    let [.., r, chi, beyond] = counted(small_errors, 1..=100);
    assert!((88..=97).contains(&r) && (88..=97).contains(&chi) && beyond == 0);
}

#[test]
#[ignore = "a hundred campaigns"]
fn a_hundred_campaigns_with_declared_errors_are_covered_and_trusted() {
    let [trusted, .., r, chi, beyond] = counted(with_systematics, 1..=100);
    assert!((90..=99).contains(&r) && (90..=99).contains(&chi) && beyond == 0);
    assert!(trusted >= 70, "{trusted}");
}

#[test]
fn four_campaigns_of_each_rule() {
    for of in [small_errors, with_systematics] {
        let [.., r, chi, beyond] = counted(of, 1..=4);
        assert!(r >= 3 && chi >= 3 && beyond == 0);
    }
}
