//! Usual faults of laboratories and the warnings about them: runs in the opposite direction, drift, offsets, walls, tilt, lag,
//! dead bands. The laboratory (`lab`) shares no code with the project.

use crate::judged;
use crate::lab;

use calibrate::{
    CalibrateError, FitError, FitOptions, FitWarning, NuisanceParameter, Verdict,
    calibrate_campaign, fit_nuisance,
};
use judged::Judged;
use lab::Lab;

/// Two of six exchanged or clockwise are named and left out, and the answer is right.
#[test]
fn two_runs_of_six_that_swim_the_other_way_are_named() {
    type Spoil = fn(&mut lab::Run);
    let cases: [(&str, Spoil); 2] = [
        ("clockwise", |run| run.clockwise = true),
        ("exchanged", |run| run.faults.exchanged = true),
    ];
    for (name, spoil) in cases {
        let mut lab = Lab::sparse(3);
        for run in [1, 4] {
            spoil(&mut lab.runs[run]);
        }
        let judged = Judged::of(&lab).unwrap();
        println!("{name}: {}", judged.line());
        let excluded: Vec<usize> = judged.found.excluded.iter().map(|run| run.index).collect();
        assert_eq!(excluded, [1, 4], "{name}");
        assert!(judged.names("clockwise") && judged.names("exchanged") && judged.names("run4.csv"));
        assert_eq!(judged.assessment.verdict, Verdict::Caution, "{name}");
        assert_eq!(judged.holds(), [true; 2], "{name}");
    }
}

/// Two of four are named; with the two that are left the answer is right or nothing.
#[test]
fn two_runs_of_four_are_named() {
    let mut lab = Lab::sparse(4).with_runs(&[40.0, 65.0, 90.0, 110.0]);
    lab.runs[0].clockwise = true;
    lab.runs[2].faults.exchanged = true;
    let judged = Judged::of(&lab).unwrap();
    println!("{}", judged.line());
    let excluded: Vec<usize> = judged.found.excluded.iter().map(|run| run.index).collect();
    assert_eq!(excluded, [0, 2]);
    assert!(judged.holds() == [true; 2] && judged.assessment.verdict != Verdict::Trust);
}

/// Three of four leave too few: refused, by name.
#[test]
fn three_runs_of_four_are_too_many() {
    let mut lab = Lab::sparse(4).with_runs(&[40.0, 65.0, 90.0, 110.0]);
    for run in &mut lab.runs[..3] {
        run.clockwise = true;
    }
    let (campaign, data) = lab.campaign();
    let error = calibrate_campaign(&campaign, &data, FitOptions::default()).unwrap_err();
    let CalibrateError::Fit(FitError::SignOpposes { opposed, runs, .. }) = &error else {
        panic!("{error}");
    };
    assert_eq!((*opposed, *runs), (3, 4));
    assert!(error.to_string().contains("run1.csv"), "{error}");
}

/// A run that the campaign excludes is not read, and is reported as excluded.
#[test]
fn an_excluded_run_is_kept_out_by_name() {
    let lab = Lab::sparse(5);
    let (mut campaign, mut data) = lab.campaign();
    campaign.runs[2].exclude = Some("the camera was knocked".into());
    data.runs.remove(2);
    let found = calibrate_campaign(&campaign, &data, FitOptions::default()).unwrap();
    let places: Vec<usize> = found.runs.iter().map(|run| run.index).collect();
    assert_eq!(places, [0, 1, 3, 4, 5]);
    assert_eq!(found.excluded.len(), 1);
    assert_eq!(found.excluded[0].reason, "the camera was knocked");
    assert!((found.fit.chi / 2.93 - 1.0).abs() < 0.02);
}

/// The joint and the angle of an offset are identified: symmetric values cannot distinguish front from back, Y and the net turn
/// can.
#[test]
fn offsets_are_told_apart() {
    let mut lab = Lab::sparse(6);
    let truth = [2_f64.to_radians(), -1_f64.to_radians()];
    for (joint, offset) in lab.joints.iter_mut().zip(truth) {
        joint.offset = offset;
    }
    let (campaign, data) = lab.campaign();
    let found = calibrate_campaign(&campaign, &data, FitOptions::default()).unwrap();
    let fit = fit_nuisance(&found, &[NuisanceParameter::JointOffsets]).unwrap();
    for (name, truth) in ["front joint offset", "back joint offset"]
        .into_iter()
        .zip(truth)
    {
        let parameter = fit.parameter(name).unwrap();
        println!("{parameter:?}, truth {truth}");
        assert!(
            (parameter.value - truth).abs() < 0.2_f64.to_radians(),
            "{parameter:?}"
        );
    }
}

/// Servos that turn 3 % less: the gain explains the runs best, and is reported after every fit; c_t and offsets explain them much
/// worse, as their likelihoods show.
#[test]
fn a_wrong_explanation_is_told_apart() {
    let judged = Judged::of(&Lab::sparse(7).with_gain(0.97)).unwrap();
    let explanations = &judged.assessment.explanations;
    for explanation in explanations {
        println!("{explanation:?}");
    }
    let gain_of = |name: &str| {
        let named = explanations
            .iter()
            .find(|explanation| explanation.name == name);
        named.unwrap().gain
    };
    assert!(explanations[0].name.starts_with("gain"), "{explanations:?}");
    assert!(
        gain_of("gain") > gain_of("c_t/mu") + 10.0
            && gain_of("gain") > gain_of("joint offsets") + 10.0
    );
    let told = |warning: &FitWarning| matches!(warning, FitWarning::Gain { found, .. } if (found - 0.97).abs() < 0.003);
    assert!(
        judged.found.fit.warnings.iter().any(told),
        "{:?}",
        judged.found.fit.warnings
    );
    assert!(
        judged.refused() && judged.names("gain"),
        "{:?}",
        judged.assessment.reasons
    );
}

/// A table of faults, warnings and results.
#[test]
#[ignore = "a table of twenty campaigns"]
fn a_table_of_faults() {
    let told = |name: &str, change: &dyn Fn(&mut Lab)| {
        for noise in [3e-4, 1e-3] {
            let mut lab = Lab::sparse(11).with_noise(noise);
            change(&mut lab);
            match Judged::of(&lab) {
                Ok(judged) => println!("{name}, {:.1} mm: {}", 1e3 * noise, judged.line()),
                Err(refused) => println!("{name}, {:.1} mm: refused: {refused}", 1e3 * noise),
            }
        }
    };
    told("nothing", &|_| {});
    told("drift 0.2 mm/s", &|lab| {
        for run in &mut lab.runs {
            run.faults.drift = [2e-4, 0.0];
        }
    });
    told("offsets +2°, −1°", &|lab| {
        lab.joints[0].offset = 2_f64.to_radians();
        lab.joints[1].offset = -1_f64.to_radians();
    });
    told("wall 0.97 in two runs", &|lab| {
        for run in [1, 4] {
            lab.runs[run].wall = 0.97;
        }
    });
    told("wall 0.97 in all", &|lab| {
        for run in &mut lab.runs {
            run.wall = 0.97;
        }
    });
    told("cameras tilted by 5°", &|lab| {
        lab.cameras.tilt = 5_f64.to_radians();
    });
    told("lag 60 ms", &|lab| {
        for joint in &mut lab.joints {
            joint.lag_s = 0.06;
        }
    });
    for degrees in [1.0, 3.0, 6.0, 12.0_f64] {
        told(&format!("dead band {degrees}°"), &|lab| {
            for joint in &mut lab.joints {
                joint.dead_band = degrees.to_radians();
            }
        });
    }
}
