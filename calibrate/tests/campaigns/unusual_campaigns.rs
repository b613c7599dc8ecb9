//! Campaigns that laboratories make and textbooks do not: one long run, repeats of one gait, two cycles a run, one recording named
//! twice, gaits that ran clockwise, results without errors. The laboratory shares nothing with the calibration (`lab`).

use crate::judged;
use crate::lab;

use std::fmt::Write as _;
use std::path::Path;
use std::sync::mpsc;
use std::time::Duration;

use calibrate::{
    CalibrateError, CampaignData, FitOptions, FitWarning, JointEstimate, Verdict, assess,
    calibrate_campaign, predict,
};
use judged::Judged;
use lab::{Lab, Run};
use swimmer_files::{AnyGait, Campaign, GaitSpec, SwimmerFile};

const LEVEL: f64 = 0.95;

/// The outcome of a campaign, or a failure if it takes minutes: some of these never ended.
fn ends(lab: Lab) -> Result<Judged, CalibrateError> {
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || drop(sender.send(Box::new(Judged::at(&lab, LEVEL)))));
    let told = receiver.recv_timeout(Duration::from_mins(4));
    *told.expect("the calibration ends")
}

#[test]
fn a_long_run_by_itself_ends() {
    for seed in 1..=2 {
        let mut lab = Lab::sparse(seed).with_runs(&[85.0]);
        lab.cycles = 37;
        let judged = ends(lab).unwrap();
        println!("{}", judged.line());
        assert_ne!(judged.assessment.verdict, Verdict::Trust);
    }
}

#[test]
fn repeats_of_one_gait_end_and_are_named() {
    for runs in [&[70.0, 70.0][..], &[70.0, 70.0, 70.0]] {
        let judged = ends(Lab::sparse(5).with_runs(runs)).unwrap();
        println!("{}", judged.line());
        assert_ne!(judged.assessment.verdict, Verdict::Trust);
        let repeats = &judged.assessment.goodness.repeats;
        assert_eq!(repeats.len(), 1);
        assert_eq!(repeats[0].runs.len(), runs.len());
        assert!(judged.names("repeated"), "{:?}", judged.assessment.reasons);
    }
}

/// A gait that is repeated counts once: its repeats move the paper's fit no more than their mean would.
#[test]
fn repeats_count_as_one_run() {
    let once = Lab::sparse(6)
        .with_runs(&[40.0, 65.0, 90.0, 110.0])
        .with_noise(0.0);
    let mut often = once.clone();
    often
        .runs
        .extend([Run::of(110.0), Run::of(110.0), Run::of(110.0)]);
    // A wall near the large gaits: the fit is a compromise, in which they weigh three times as much if repeats count.
    for lab in [&mut often] {
        for run in lab.runs.iter_mut().filter(|run| run.degrees > 100.0) {
            run.wall = 0.97;
        }
    }
    let mut once = once;
    once.runs[3].wall = 0.97;
    let fit = |lab: &Lab| {
        let (campaign, data) = lab.campaign();
        calibrate_campaign(&campaign, &data, FitOptions::default())
            .unwrap()
            .fit
    };
    let (one, four) = (fit(&once), fit(&often));
    println!(
        "{} {}; {} {}",
        one.sphere_radius, one.chi, four.sphere_radius, four.chi
    );
    assert!((four.chi / one.chi - 1.0).abs() < 1e-4);
    assert!((four.sphere_radius / one.sphere_radius - 1.0).abs() < 1e-4);
}

/// Two cycles that count make one step: nothing is certain by it.
#[test]
fn two_cycles_a_run_are_not_certain() {
    for seed in 1..=3 {
        for noise in [2e-5, 3e-4] {
            let mut lab = Lab::sparse(seed).with_noise(noise);
            lab.cycles = 3;
            let judged = ends(lab).unwrap();
            println!("{}", judged.line());
            let headline = &judged.assessment.headline;
            assert!((headline.estimate.chi / judged.truth[1] - 1.0).abs() < 0.03);
            assert!((headline.estimate.sphere_radius / judged.truth[0] - 1.0).abs() < 0.03);
            let [low, high] = headline.intervals.chi;
            assert!((1e-3..0.3).contains(&(high - low)), "{low} {high}");
        }
    }
}

/// One recording that is named twice makes intervals too narrow, or belongs to another run.
#[test]
fn a_recording_that_is_there_twice_is_not_trusted() {
    let lab = Lab::sparse(7);
    let (mut campaign, mut data) = lab.campaign();
    campaign.runs[3] = campaign.runs[2].clone();
    data.runs[3] = data.runs[2].clone();
    let found = calibrate_campaign(&campaign, &data, FitOptions::default()).unwrap();
    let assessment = assess(&found, &JointEstimate::of(&found).unwrap(), None);
    assert_eq!(assessment.verdict, Verdict::DoNotUse);
    assert!(
        assessment
            .reasons
            .iter()
            .any(|reason| reason.contains("the same recording"))
    );
    // Repeats are recordings of their own.
    let judged = Judged::at(
        &Lab::sparse(7).with_runs(&[40.0, 65.0, 65.0, 90.0, 110.0]),
        LEVEL,
    )
    .unwrap();
    assert!(!judged.names("the same recording"));
}

/// A gait that ran clockwise and is named so is right; named so and run the other way, the advice is to take `:cw` off.
#[test]
fn clockwise_runs_that_are_named_so() {
    let mut lab = Lab::sparse(8);
    for run in [1, 4] {
        lab.runs[run].clockwise = true;
    }
    let named = |lab: &Lab, which: &[usize]| {
        let (mut campaign, mut data) = lab.campaign();
        for run in which {
            let GaitSpec::Circle { amplitude, .. } = campaign.runs[*run].gait else {
                unreachable!("circles only");
            };
            campaign.runs[*run].gait = GaitSpec::Circle {
                amplitude,
                clockwise: true,
            };
            data.runs[*run].gait = AnyGait::circle(amplitude).reversed_if(true);
            data.runs[*run].gait_name += ":cw";
        }
        calibrate_campaign(&campaign, &data, FitOptions::default()).unwrap()
    };
    let right = named(&lab, &[1, 4]);
    assert!(right.excluded.is_empty(), "{:?}", right.excluded);
    assert!((right.fit.chi / 2.93 - 1.0).abs() < 0.02);
    let wrong = named(&lab, &[1, 2, 4]);
    let reasons: Vec<&str> = wrong
        .excluded
        .iter()
        .map(|run| run.reason.as_str())
        .collect();
    assert_eq!(reasons.len(), 1);
    assert!(reasons[0].contains("take :cw off"), "{reasons:?}");
    assert!(!reasons[0].contains("add :cw"), "{reasons:?}");
}

/// Results without any error: intervals by what the fit leaves, a warning that says so, and no trust.
#[test]
fn results_without_errors() {
    let truth = SwimmerFile::preset("robot").unwrap();
    let mut text = "swimmer = \"robot-slender\"\n".to_owned();
    let mut chance = judged::Chance::new(3);
    for degrees in [40_u8, 50, 60, 70, 80, 90] {
        let cycle = predict(
            &truth,
            &AnyGait::circle(f64::from(degrees).to_radians()),
            30.0,
        )
        .unwrap();
        writeln!(
            text,
            "[[run]]\ngait = \"circle:{degrees}deg\"\nperiod_s = 30.0\nx_mm = {:.4}\ndelta_y_mm = {:.4}\ndelta_theta_deg = {:.4}",
            1e3 * cycle.x_m + 0.03 * chance.normal(),
            1e3 * cycle.delta_y_m + 0.03 * chance.normal(),
            cycle.delta_theta_rad.to_degrees() + 0.05 * chance.normal(),
        )
        .unwrap();
    }
    let campaign = Campaign::parse(&text, Path::new("campaign.toml")).unwrap();
    let data = CampaignData::load(&campaign).unwrap();
    let found = calibrate_campaign(&campaign, &data, FitOptions::default()).unwrap();
    let warnings = &found.fit.warnings;
    assert!(warnings.contains(&FitWarning::NoErrors), "{warnings:?}");
    let misfit = |warning: &FitWarning| matches!(warning, FitWarning::ModelMisfit { .. });
    assert!(!warnings.iter().any(misfit), "{warnings:?}");
    let [low, high] = found.fit.intervals.chi;
    assert!(
        low < 3.598 && 3.598 < high && high - low < 0.2,
        "{low} {high}"
    );
    let assessment = assess(&found, &JointEstimate::of(&found).unwrap(), None);
    println!("{:?} {:?}", assessment.verdict, assessment.reasons);
    assert_eq!(assessment.verdict, Verdict::Caution);
    assert!(assessment.goodness.reduced_chi2.is_none());
    // One run that states its errors lends them to the others.
    let stated = text.replacen(
        "delta_y_mm",
        "x_se_mm = 0.03\ndelta_y_se_mm = 0.03\ndelta_theta_se_deg = 0.05\ndelta_y_mm",
        1,
    );
    let campaign = Campaign::parse(&stated, Path::new("campaign.toml")).unwrap();
    let found = calibrate_campaign(&campaign, &data, FitOptions::default()).unwrap();
    assert!(!found.fit.warnings.contains(&FitWarning::NoErrors));
    let [low, high] = found.fit.intervals.chi;
    assert!(
        low < 3.598 && 3.598 < high && high - low < 0.2,
        "{low} {high}"
    );
}
