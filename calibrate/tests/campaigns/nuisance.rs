//! Parameters besides `r_s` and χ: found where the data hold them, with a warning where they do not.

use crate::twin_campaigns;

use calibrate::nuisance::{FittedParameter, NuisanceFit, NuisanceWarning};
use calibrate::{
    CampaignFit, FitOptions, FitWarning, NuisanceParameter, calibrate_campaign, fit_nuisance,
};
use swimmer_files::ServoFile;
use twin_campaigns::Laboratory;

fn noticed(found: &CampaignFit) -> Option<(f64, f64)> {
    found.fit.warnings.iter().find_map(|warning| match warning {
        FitWarning::DeadBand { found, gain, .. } => Some((*found, *gain)),
        _ => None,
    })
}

fn fitted(laboratory: &Laboratory, further: &[NuisanceParameter]) -> NuisanceFit {
    let (campaign, data) = laboratory.campaign();
    let found = calibrate_campaign(&campaign, &data, FitOptions::default()).unwrap();
    fit_nuisance(&found, further).unwrap()
}

fn assert_holds(parameter: &FittedParameter, truth: f64) {
    println!("{parameter:?}, truth {truth}");
    let [low, high] = parameter.interval;
    assert!(
        (low..=high).contains(&truth),
        "{parameter:?}, truth {truth}"
    );
}

fn servo(dead_band: f64) -> ServoFile {
    ServoFile {
        dead_band,
        ..ServoFile::default()
    }
}

/// Servos with a dead band of eight degrees, as analog ones have, which the swimmer file does not know.
#[test]
fn a_dead_band_is_noticed_and_fitted() {
    let truth = 8_f64.to_radians();
    let laboratory = Laboratory {
        servo: servo(truth),
        ..Laboratory::quiet(5)
    };
    let (mut campaign, data) = laboratory.campaign();
    for claimed in [None, Some(1_f64.to_radians())] {
        campaign.swimmer.servo = claimed.map(servo);
        let found = calibrate_campaign(&campaign, &data, FitOptions::default()).unwrap();
        let (dead_band, gain) = noticed(&found).expect("an unknown dead band is noticed");
        println!(
            "claimed {claimed:?}: noticed {:.2}°, log-likelihood +{gain:.1}",
            dead_band.to_degrees()
        );
        assert!((dead_band - truth).abs() < 0.01 && gain > 10.0);
        let text = found
            .fit
            .warnings
            .iter()
            .map(ToString::to_string)
            .collect::<String>();
        assert!(
            text.contains("dead band of 8.") && text.contains("--fit-also deadband"),
            "{text}"
        );

        let fit = fit_nuisance(&found, &[NuisanceParameter::DeadBand]).unwrap();
        assert_holds(fit.parameter("dead band").unwrap(), truth);
        assert_holds(
            fit.parameter("r_s").unwrap(),
            laboratory.swimmer.sphere_radius,
        );
        assert_holds(fit.parameter("chi").unwrap(), laboratory.swimmer.chi);
        assert!(
            fit.log_likelihood_gain > 10.0 && fit.warnings.is_empty(),
            "{fit:?}"
        );
        // The plain fit was wrong by more than it said.
        let low = found.fit.chi / laboratory.swimmer.chi;
        assert!(low < 0.98, "{low}");
        let dead_band = fit.swimmer.servo.unwrap().dead_band;
        assert!((dead_band - truth).abs() < 0.003, "{dead_band}");
    }
}

#[test]
fn known_servos_raise_no_suspicion() {
    for seed in 1..=4 {
        let (campaign, data) = Laboratory::by_chance(seed).campaign();
        let found = calibrate_campaign(&campaign, &data, FitOptions::default()).unwrap();
        assert_eq!(noticed(&found), None, "seed {seed}");
    }
}

#[test]
fn offsets_of_the_joints_are_found() {
    let laboratory = Laboratory {
        offsets: [0.05, -0.03],
        ..Laboratory::quiet(6)
    };
    let fit = fitted(&laboratory, &[NuisanceParameter::JointOffsets]);
    assert_holds(fit.parameter("front joint offset").unwrap(), 0.05);
    assert_holds(fit.parameter("back joint offset").unwrap(), -0.03);
    assert!(fit.log_likelihood_gain > 10.0);
}

#[test]
fn reflectors_beside_the_middle_are_found() {
    let laboratory = Laboratory::quiet(7);
    let (mut campaign, data) = laboratory.campaign();
    // The laboratory believes both to sit 30 mm further to the front than they do.
    campaign.reflectors.front.at[0] += 0.03;
    campaign.reflectors.back.at[0] += 0.03;
    let found = calibrate_campaign(&campaign, &data, FitOptions::default()).unwrap();
    let fit = fit_nuisance(&found, &[NuisanceParameter::MarkerOffset]).unwrap();
    let along = fit.parameter("marker offset along").unwrap();
    assert_holds(along, -0.03);
    assert!(
        along.interval[1] < 0.0 && fit.log_likelihood_gain > 5.0,
        "{fit:?}"
    );
    assert_holds(fit.parameter("chi").unwrap(), laboratory.swimmer.chi);
}

/// At a distance a sphere is its drag 6πμ `r_s`: kinematics determine it only relative to `c_t`. Its resistance to rotation is
/// proportional to `r_s`³, and that of a large sphere distinguishes both.
#[test]
fn a_small_sphere_cannot_be_told_from_the_tangential_drag() {
    let alike = |sphere_radius: f64| {
        let mut laboratory = Laboratory::quiet(8);
        laboratory.swimmer.sphere_radius = sphere_radius;
        let fit = fitted(&laboratory, &[NuisanceParameter::TangentialDrag]);
        println!(
            "r_s {sphere_radius}: {:?}\n{:?}\n{:?}",
            fit.parameters, fit.correlations, fit.warnings
        );
        let pair = ["r_s", "c_t/mu"];
        let alike = |w: &NuisanceWarning| matches!(w, NuisanceWarning::Alike { names, .. } if *names == pair);
        fit.warnings.iter().any(alike)
    };
    assert!(alike(0.01));
    assert!(!alike(0.0692));
}
