//! Predictions of the advice compared with the result of following it.

use crate::twin_campaigns;

use calibrate::{
    Candidate, EvidenceOptions, FitOptions, JointEstimate, advise, calibrate_campaign,
    weigh_evidence,
};
use swimmer_files::GaitSpec;
use twin_campaigns::Laboratory;

const CAMPAIGNS: u64 = 4;

/// Widths of the intervals of `r_s` and of ln χ by likelihood: mean logarithms over campaigns.
fn widths(amplitudes: &[f64]) -> [f64; 2] {
    let mut logs = [0.0; 2];
    for seed in 1..=CAMPAIGNS {
        let (campaign, data) = laboratory(amplitudes, seed).campaign();
        let found = calibrate_campaign(&campaign, &data, FitOptions::default()).unwrap();
        let options = EvidenceOptions { draws: 10, seed };
        let evidence = weigh_evidence(&found, options).unwrap();
        for (log, profile) in logs.iter_mut().zip(&evidence.profiles) {
            let [low, high] = profile.interval;
            *log += (high / low).ln().ln() / CAMPAIGNS as f64;
        }
    }
    logs
}

fn laboratory(amplitudes: &[f64], seed: u64) -> Laboratory {
    Laboratory {
        amplitudes: amplitudes.to_vec(),
        drift: 5e-6,
        ..Laboratory::quiet(seed)
    }
}

/// Runs between 45° and 75°: the largest circle narrows the intervals as much as predicted, the smallest one hardly.
#[test]
fn advice_that_is_followed_narrows_the_intervals() {
    let base = [45.0, 55.0, 65.0, 75.0];
    let (campaign, data) = laboratory(&base, 1).campaign();
    let found = calibrate_campaign(&campaign, &data, FitOptions::default()).unwrap();
    let advice = advise(&campaign, &found, &JointEstimate::of(&found).unwrap()).unwrap();
    let circle = |degrees: f64| -> Candidate {
        let is = |c: &&Candidate| matches!(c.gait, GaitSpec::Circle { amplitude, .. } if (amplitude.to_degrees() - degrees).abs() < 1e-9);
        advice.candidates.iter().find(is).unwrap().clone()
    };
    let now = widths(&base);
    let after = |degrees: f64| {
        let then = widths(&[45.0, 55.0, 65.0, 75.0, degrees]);
        [0, 1].map(|i| (then[i] - now[i]).exp())
    };
    let (large, small) = (after(110.0), after(20.0));
    println!("110°: foretold {:?}, came {large:.3?}", circle(110.0));
    println!(" 20°: foretold {:?}, came {small:.3?}", circle(20.0));
    for (large, small) in large.iter().zip(&small) {
        assert!(large < &(0.85 * small), "{large} {small}");
    }
    let came = (large[0] * large[1] / small[0] / small[1]).sqrt();
    let foretold = circle(110.0).both / circle(20.0).both;
    assert!((came / foretold - 1.0).abs() < 0.2, "{came} {foretold}");
    // Best first, and nothing that cannot be played: plates of 5 mm touch in a square's corners from 103.9° on, where the tips are
    // l₀ + 2 l₁ cos A apart.
    let ranks: Vec<f64> = advice.candidates.iter().map(|c| c.both).collect();
    assert!(ranks.is_sorted());
    let square = |c: &Candidate| match c.gait {
        GaitSpec::Square { amplitude, .. } => Some(amplitude.to_degrees()),
        _ => None,
    };
    let largest = advice
        .candidates
        .iter()
        .filter_map(square)
        .fold(0.0, f64::max);
    assert!((largest - 100.0).abs() < 1e-9, "{largest}");
    let apart = |degrees: f64| 0.071 + 2.0 * 0.137 * degrees.to_radians().cos();
    assert!(apart(largest) > 0.005 && apart(largest + 5.0) < 0.005);
}
