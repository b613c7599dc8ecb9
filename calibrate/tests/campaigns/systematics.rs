//! Results of campaigns with errors that all cycles of all runs share. The laboratory (`lab`) shares no code with the project,
//! and the truth is compared with the report.

use crate::judged;
use crate::lab;
use crate::oracle;

use calibrate::{NuisanceParameter, Verdict, fit_nuisance};
use judged::{Judged, LEVEL, by_chance, holds, with_systematics};
use lab::Lab;
use statrs::distribution::{Binomial, DiscreteCDF};

const RUNS: [&[f64]; 3] = [
    &[40.0, 65.0, 90.0, 110.0],
    &[30.0, 50.0, 70.0, 85.0, 100.0, 110.0],
    &[30.0, 45.0, 60.0, 70.0, 80.0, 90.0, 100.0, 110.0],
];

/// Default level of `swimmer calibrate`.
const USUAL_LEVEL: f64 = 0.95;

/// Either the truth is within the interval with systematics, or the answer is refused and the gain named; and with the gain
/// fitted, whether r_s and χ are.
fn common_gain(gain: f64, noise: f64, runs: &[f64], seed: u64) -> (bool, [bool; 2]) {
    let lab = Lab::sparse(seed)
        .with_runs(runs)
        .with_gain(gain)
        .with_noise(noise);
    let judged = Judged::at(&lab, USUAL_LEVEL).unwrap();
    let told = judged.holds() == [true; 2] || (judged.refused() && judged.names("gain"));
    let fitted = fit_nuisance(&judged.found, &[NuisanceParameter::Gain]).unwrap();
    let inside = holds(&fitted.intervals().unwrap(), judged.truth);
    println!(
        "gain {gain}, {:.1} mm, {} runs: {}; fitted {:.4} {:?}, truth inside (r_s, χ): {inside:?}",
        1e3 * noise,
        runs.len(),
        judged.line(),
        fitted.parameter("gain").unwrap().value,
        fitted.parameter("gain").unwrap().interval,
    );
    (told, inside)
}

#[test]
fn a_common_gain_is_within_the_interval_or_named() {
    for (gain, noise, runs) in [
        (0.97, 1e-3, RUNS[1]),
        (0.995, 3e-4, RUNS[1]),
        (1.02, 1e-3, RUNS[1]),
        (0.95, 1e-3, RUNS[0]),
    ] {
        let (told, _) = common_gain(gain, noise, runs, 1);
        assert!(told, "gain {gain}");
    }
}

#[test]
#[ignore = "ten minutes: 135 campaigns"]
fn common_gains_at_every_noise() {
    let mut cases = Vec::new();
    for gain in [0.95, 0.97, 0.99, 0.995, 1.02] {
        for noise in [3e-4, 1e-3, 2e-3] {
            for runs in RUNS {
                cases.extend([(gain, noise, runs); 3]);
            }
        }
    }
    // Each with chance of its own.
    let counts = over(1..=cases.len() as u64, |seed| {
        let (gain, noise, runs) = cases[usize::try_from(seed).unwrap() - 1];
        let (told, [r, chi]) = common_gain(gain, noise, runs, seed);
        if !told {
            println!(
                "NEITHER TOLD NOR INSIDE: gain {gain}, {noise} m, {} runs, seed {seed}",
                runs.len()
            );
        }
        [told, r, chi, r && chi].map(u32::from).into()
    });
    println!(
        "told or inside; with the gain fitted, r_s, χ and both inside: {counts:?} of {}",
        cases.len()
    );
    assert_eq!(counts[0] as usize, cases.len());
    assert!(10 * counts[3] as usize >= 9 * cases.len(), "{counts:?}");
}

/// Counts over campaigns, in as many threads.
const THREADS: usize = 2;

fn over(seeds: std::ops::RangeInclusive<u64>, of: impl Fn(u64) -> Vec<u32> + Sync) -> Vec<u32> {
    let seeds: Vec<u64> = seeds.collect();
    let count = |seeds: &[u64]| {
        let mut sums: Vec<u32> = Vec::new();
        for seed in seeds {
            let counts = of(*seed);
            sums.resize(counts.len(), 0);
            for (sum, count) in sums.iter_mut().zip(counts) {
                *sum += count;
            }
        }
        sums
    };
    std::thread::scope(|scope| {
        let parts = seeds.chunks(seeds.len().div_ceil(THREADS));
        let parts: Vec<_> = parts.map(|part| scope.spawn(|| count(part))).collect();
        let sums = parts.into_iter().map(|part| part.join().unwrap());
        sums.reduce(|a, b| a.iter().zip(&b).map(|(a, b)| a + b).collect())
            .unwrap_or_default()
    })
}

/// Trusted, refused; inside with systematics (r_s, χ); inside by the paper's fit (r_s, χ).
fn judge(lab: &Lab) -> Vec<u32> {
    let judged = Judged::of(lab).unwrap();
    println!("{}: {}", lab.seed, judged.line());
    let verdict = judged.assessment.verdict;
    let [r, chi] = judged.holds();
    let [paper_r, paper_chi] = holds(&judged.found.fit.intervals, judged.truth);
    let counts = [
        verdict == Verdict::Trust,
        verdict == Verdict::DoNotUse,
        r,
        chi,
        paper_r,
        paper_chi,
    ];
    counts.map(u32::from).into()
}

#[test]
fn faultless_campaigns_are_trusted() {
    let counts = over(1..=12, |seed| judge(&by_chance(seed)));
    println!("trusted, refused, inside r_s, χ, paper's r_s, χ: {counts:?} of 12");
    // One honest judge in a thousand trusts less often.
    let least = Binomial::new(0.9, 12).unwrap().inverse_cdf(1e-3);
    assert!(u64::from(counts[0]) >= least, "{counts:?}");
}

#[test]
#[ignore = "two hundred campaigns"]
fn two_hundred_faultless_campaigns_are_trusted() {
    let counts = over(1..=200, |seed| judge(&by_chance(seed)));
    println!("trusted, refused, inside r_s, χ, paper's r_s, χ: {counts:?} of 200");
    assert!(counts[0] >= 180, "{counts:?}");
}

#[test]
fn what_is_known_by_halves_is_within_the_interval() {
    let counts = over(1..=12, |seed| judge(&with_systematics(seed)));
    println!("trusted, refused, inside r_s, χ, paper's r_s, χ: {counts:?} of 12");
    let least = Binomial::new(LEVEL, 12).unwrap().inverse_cdf(1e-3);
    assert!(
        counts[2..4]
            .iter()
            .all(|inside| u64::from(*inside) >= least),
        "{counts:?}"
    );
}

/// An oracle knows the model, each value's error and the priors, all exactly: its intervals are the narrowest.
#[test]
#[ignore = "forty campaigns, and an oracle's word on four laboratories"]
fn intervals_are_hardly_wider_than_an_oracles() {
    let mut ratios: Vec<f64> = Vec::new();
    for noise in [3e-4, 1e-3] {
        for runs in &RUNS[1..] {
            let lab = |seed| Lab::sparse(seed).with_runs(runs).with_noise(noise);
            let oracle = oracle::half_widths(&lab(0), LEVEL);
            for seed in 1..=10 {
                let widths = Judged::of(&lab(seed)).unwrap().widths();
                let [r, chi] = [widths[0] / oracle[0], widths[1] / oracle[1]];
                println!(
                    "{:.1} mm, {} runs: {r:.2} {chi:.2} of the oracle's ±{oracle:.4?}",
                    1e3 * noise,
                    runs.len()
                );
                ratios.extend([r, chi]);
            }
        }
    }
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    println!("median width over the oracle's: {median:.3}");
    assert!(median <= 1.5, "{median}");
}

#[test]
#[ignore = "three hundred campaigns"]
fn three_hundred_campaigns_with_systematic_errors_are_covered() {
    let counts = over(1..=300, |seed| judge(&with_systematics(seed)));
    println!("trusted, refused, inside r_s, χ, paper's r_s, χ: {counts:?} of 300");
    assert!(
        counts[2..4]
            .iter()
            .all(|inside| (255..=285).contains(inside)),
        "{counts:?}"
    );
    assert!(counts[1] <= 60, "{counts:?}");
}
