//! Coverage of the intervals: campaigns of a twin with random errors, compared with the truth.

use crate::twin_campaigns;

use std::fmt::Write as _;
use std::ops::RangeInclusive;

use calibrate::{
    EvidenceOptions, FitOptions, FitWarning, Intervals, calibrate_campaign, calibrate_run, predict,
    weigh_evidence,
};
use statrs::distribution::{Binomial, DiscreteCDF};
use swimmer_files::SwimmerFile;
use twin_campaigns::Laboratory;

const LEVEL: f64 = 0.9;

/// Outcomes of campaigns without a fault.
#[derive(Debug, Default)]
struct Count {
    /// Intervals of `r_s` and of χ that hold the truth: of the paper's fit, by profile likelihood, by bootstrap.
    inside: [[u64; 2]; 3],
    /// Warnings of an unknown dead band, and of an outlying run: all of them are false.
    false_alarms: [u64; 2],
}

impl std::ops::Add for Count {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        let pairs = self.inside.iter_mut().flatten();
        for (here, there) in pairs.zip(other.inside.iter().flatten()) {
            *here += there;
        }
        for (here, there) in self.false_alarms.iter_mut().zip(other.false_alarms) {
            *here += there;
        }
        self
    }
}

/// Half of the campaigns in a thread each.
fn count(campaigns: RangeInclusive<u64>) -> Count {
    let (first, last) = (*campaigns.start(), *campaigns.end());
    let middle = u64::midpoint(first, last);
    let count = std::thread::scope(|scope| {
        let half = scope.spawn(|| count_one_by_one(first..=middle));
        count_one_by_one(middle + 1..=last) + half.join().unwrap()
    });
    println!("{count:?}");
    count
}

fn count_one_by_one(campaigns: RangeInclusive<u64>) -> Count {
    let mut count = Count::default();
    for seed in campaigns {
        let laboratory = Laboratory::by_chance(seed);
        let (campaign, data) = laboratory.campaign();
        let found = calibrate_campaign(&campaign, &data, FitOptions { level: LEVEL }).unwrap();
        let options = EvidenceOptions { draws: 1000, seed };
        let evidence = weigh_evidence(&found, options).unwrap();
        let truth = &laboratory.swimmer;
        let all = [
            &found.fit.intervals,
            &evidence.likelihood.intervals,
            &evidence.bootstrap.as_ref().unwrap().intervals,
        ];
        for warning in &found.fit.warnings {
            match warning {
                FitWarning::DeadBand { .. } | FitWarning::Gain { .. } => count.false_alarms[0] += 1,
                FitWarning::Outlier { .. } => count.false_alarms[1] += 1,
                _ => {}
            }
        }
        let mut line = format!("{seed:3}: {} runs;", found.runs.len());
        for (inside, intervals) in count.inside.iter_mut().zip(all) {
            let Intervals {
                sphere_radius, chi, ..
            } = intervals;
            let ends = [(sphere_radius, truth.sphere_radius), (chi, truth.chi)];
            for (inside, ([low, high], truth)) in inside.iter_mut().zip(ends) {
                *inside += u64::from((*low..=*high).contains(&truth));
                // The truth's place between the ends: −1 and 1 are the ends themselves.
                let place = (2.0 * truth - low - high) / (high - low);
                let wide = 50.0 * (high - low) / truth;
                let _ = write!(line, " {place:+.2} (±{wide:.2} %)");
            }
            line.push(';');
        }
        println!(
            "{line} outliers {}, surface {:.0e}",
            evidence.outliers.len(),
            evidence.surface_error
        );
    }
    count
}

#[test]
fn intervals_cover_the_truth_as_often_as_they_say() {
    let campaigns = 20;
    let count = count(1..=campaigns);
    // One honest interval in a thousand covers less often than this.
    let least = Binomial::new(LEVEL, campaigns).unwrap().inverse_cdf(1e-3);
    for inside in count.inside[..2].iter().flatten() {
        assert!(
            *inside >= least,
            "{inside} of {campaigns}, at least {least}"
        );
    }
}

#[test]
#[ignore = "half an hour: three hundred campaigns"]
fn three_hundred_campaigns_are_covered_in_nine_of_ten() {
    let count = count(1..=300);
    for inside in count.inside.iter().flatten() {
        assert!((255..=285).contains(inside), "{inside} of 300");
    }
    // One in a hundred is promised; once in a thousand times there are more than this.
    let most = Binomial::new(0.01, 300).unwrap().inverse_cdf(0.999);
    for alarms in count.false_alarms {
        assert!(alarms <= most, "{alarms} false alarms, at most {most}");
    }
}

/// Mean deviations of X, ΔY and Δθ from what the model predicts, relative to it, for each amplitude.
fn biases(seeds: RangeInclusive<u64>, change: impl Fn(&mut Laboratory)) -> Vec<[f64; 3]> {
    let count = seeds.clone().count() as f64;
    let mut sums = Vec::new();
    for seed in seeds {
        let mut laboratory = Laboratory::quiet(seed);
        change(&mut laboratory);
        let (campaign, data) = laboratory.campaign();
        let truth = SwimmerFile {
            swimmer: laboratory.swimmer,
            ..campaign.swimmer
        };
        sums.resize(data.runs.len(), [0.0; 3]);
        for (run, sum) in data.runs.iter().zip(&mut sums) {
            let expected = predict(&truth, &run.gait, run.period_s).unwrap();
            let found = calibrate_run(run, &campaign.reflectors, &truth).unwrap();
            let cycles = found.cycles;
            for (sum, (found, expected)) in sum.iter_mut().zip([
                (cycles.x.mean, expected.x_m),
                (cycles.delta_y.mean, expected.delta_y_m),
                (cycles.delta_theta.mean, expected.delta_theta_rad),
            ]) {
                *sum += (found / expected - 1.0) / count;
            }
        }
    }
    sums
}

#[test]
fn a_millimetre_of_noise_leaves_amplitudes_as_they_are() {
    let found = biases(1..=8, |laboratory| {
        laboratory.camera.noise_sd = 1e-3;
        laboratory.cycles = 12;
    });
    println!("relative bias of X, ΔY, Δθ: {found:.5?}");
    for [_, y, theta] in found {
        assert!(y.abs() < 2e-3 && theta.abs() < 2e-3, "{y} {theta}");
    }
}
