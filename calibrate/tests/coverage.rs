//! Do the intervals hold what they promise? Campaigns of a twin with everything by chance, and the truth beside the intervals.

mod twin_campaigns;

use std::ops::RangeInclusive;

use calibrate::{EvidenceOptions, FitOptions, Intervals, calibrate_campaign, weigh_evidence};
use statrs::distribution::{Binomial, DiscreteCDF};
use twin_campaigns::Laboratory;

const LEVEL: f64 = 0.9;

/// How many intervals of `r_s` and of χ hold the truth: of the paper's fit, by profile likelihood, by bootstrap.
fn covered(campaigns: RangeInclusive<u64>) -> [[u64; 2]; 3] {
    let mut inside = [[0; 2]; 3];
    for seed in campaigns {
        let laboratory = Laboratory::by_chance(seed);
        let (campaign, data) = laboratory.campaign();
        let found = calibrate_campaign(&campaign, &data, FitOptions { level: LEVEL }).unwrap();
        let options = EvidenceOptions { draws: 1000, seed };
        let evidence = weigh_evidence(&campaign, &data, &found, options).unwrap();
        let truth = &laboratory.swimmer;
        let all = [
            &found.fit.intervals,
            &evidence.likelihood.intervals,
            &evidence.bootstrap.intervals,
        ];
        print!("{seed:3}: {} runs;", found.runs.len());
        for (inside, intervals) in inside.iter_mut().zip(all) {
            let Intervals {
                sphere_radius, chi, ..
            } = intervals;
            let ends = [(sphere_radius, truth.sphere_radius), (chi, truth.chi)];
            for (inside, ([low, high], truth)) in inside.iter_mut().zip(ends) {
                *inside += u64::from((*low..=*high).contains(&truth));
                // The truth's place between the ends: −1 and 1 are the ends themselves.
                let place = (2.0 * truth - low - high) / (high - low);
                let wide = 50.0 * (high - low) / truth;
                print!(" {place:+.2} (±{wide:.2} %)");
            }
            print!(";");
        }
        println!(
            " outliers {}, surface {:.0e}",
            evidence.outliers.len(),
            evidence.surface_error
        );
    }
    println!(
        "r_s and χ covered: fit {:?}, likelihood {:?}, bootstrap {:?}",
        inside[0], inside[1], inside[2]
    );
    inside
}

#[test]
fn intervals_cover_the_truth_as_often_as_they_say() {
    let campaigns = 20;
    let inside = covered(1..=campaigns);
    // One honest interval in a thousand campaigns of campaigns covers less often than this.
    let least = Binomial::new(LEVEL, campaigns).unwrap().inverse_cdf(1e-3);
    for inside in &inside[0] {
        assert!(
            *inside >= least,
            "{inside} of {campaigns}, at least {least}"
        );
    }
}

#[test]
#[ignore = "ten minutes: three hundred campaigns"]
fn three_hundred_campaigns_are_covered_in_nine_of_ten() {
    let inside = covered(1..=300);
    for inside in &inside[0] {
        assert!((255..=285).contains(inside), "{inside} of 300");
    }
}
