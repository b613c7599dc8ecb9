//! The fit against the truth: exact data, noisy data over seeds, servos, and data that oppose the model. How often intervals
//! hold the truth is counted in `coverage.rs`.

mod tank;

use calibrate::{CalibrateError, FitError, FitOptions, FitWarning, calibrate_campaign};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_files::{AnyGait, Reflectors, ServoFile};
use swimmer_model::{Swimmer, TangentialDrag};
use tank::{Tank, campaign};

const AMPLITUDES: [f64; 6] = [30.0, 50.0, 70.0, 85.0, 100.0, 110.0];

fn robot() -> Tank {
    Tank::new(Swimmer::robot(), AnyGait::circle(1.0))
}

/// How far the sphere radius and χ are off, relatively.
fn errors(tank: &Tank, text: fn(&Tank) -> String, reflectors: Reflectors) -> (f64, f64) {
    let (campaign, data) = campaign(tank, &AMPLITUDES, text, reflectors);
    let fit = calibrate_campaign(&campaign, &data, FitOptions::default())
        .unwrap()
        .fit;
    let (r_s, chi) = (fit.sphere_radius / 0.0692 - 1.0, fit.chi / 3.598 - 1.0);
    println!("r_s {r_s:.3e} chi {chi:.3e} rmse {:.3e}", fit.rmse);
    (r_s.abs(), chi.abs())
}

#[test]
fn exact_data_give_exact_parameters() {
    // Every digit is in the table; the tank's own steps are what is left.
    let tank = Tank {
        steps: 200,
        ..robot().perfect()
    };
    let (r_s, chi) = errors(&tank, Tank::table, tank.auto());
    assert!(r_s < 1e-9 && chi < 1e-9);
}

#[test]
fn six_digits_give_parameters_to_a_millionth() {
    // A Motive file rounds to a micrometre.
    let tank = Tank {
        steps: 20,
        cycles: 12,
        ..robot().perfect()
    };
    let (r_s, chi) = errors(&tank, Tank::motive, tank.named());
    assert!(r_s < 1e-6 && chi < 1e-6);
}

#[test]
fn random_swimmers_are_recovered_within_a_hundredth() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for seed in 1..=5 {
        let truth = Swimmer {
            sphere_radius: rng.random_range(0.03..0.1),
            chi: rng.random_range(2.0..5.0),
            ..Swimmer::robot()
        };
        let tank = Tank {
            swimmer: truth,
            seed,
            cycles: 6,
            ..robot()
        };
        let (campaign, data) = campaign(&tank, &AMPLITUDES, Tank::motive, tank.named());
        let outcome = calibrate_campaign(&campaign, &data, FitOptions::default()).unwrap();
        let fit = &outcome.fit;
        let (r, c) = (
            fit.sphere_radius / truth.sphere_radius - 1.0,
            fit.chi / truth.chi - 1.0,
        );
        println!(
            "seed {seed}: r_s {:+.2} %, chi {:+.2} %, rmse {:.5}, {:?}",
            100.0 * r,
            100.0 * c,
            fit.rmse,
            fit.intervals
        );
        assert!(r.abs() < 0.01 && c.abs() < 0.01, "seed {seed}: {fit:?}");
        assert!((outcome.swimmer.swimmer.chi - fit.chi).abs() <= 0.0);
        assert_eq!(fit.c_t_form, truth.tangential_drag);
        let sum: f64 = fit.residuals.iter().map(|r| r.share).sum();
        assert!((sum.sqrt() / fit.rmse - 1.0).abs() < 1e-9);
    }
}

#[test]
fn a_swimmer_without_a_sphere_is_found_to_have_none() {
    let truth = Swimmer {
        chi: 2.6,
        ..Swimmer::robot_slender()
    };
    let dead_band = ServoFile {
        dead_band: 0.04,
        ..ServoFile::default()
    };
    // With servos the search, which takes them for ideal, ends somewhere else: the fit must leave that place.
    for servo in [None, Some(dead_band)] {
        let tank = Tank {
            swimmer: truth,
            servo,
            ..robot()
        };
        let (campaign, data) = campaign(&tank, &AMPLITUDES, Tank::motive, tank.named());
        let fit = calibrate_campaign(&campaign, &data, FitOptions::default())
            .unwrap()
            .fit;
        println!(
            "r_s {:.2e} m, chi {:+.3} %",
            fit.sphere_radius,
            100.0 * (fit.chi / 2.6 - 1.0)
        );
        assert!(
            fit.sphere_radius < 1e-4 && (fit.chi / 2.6 - 1.0).abs() < 1e-3,
            "{fit:?}"
        );
        assert!(fit.intervals.sphere_radius[0] <= 0.0);
    }
}

#[test]
fn the_servos_path_is_known_to_the_fit() {
    let servo = ServoFile {
        dead_band: 0.05,
        ..ServoFile::default()
    };
    let tank = Tank {
        servo: Some(servo),
        ..robot()
    };
    let (mut campaign, data) = campaign(&tank, &[40.0, 70.0, 100.0], Tank::motive, tank.named());
    let fit = calibrate_campaign(&campaign, &data, FitOptions::default())
        .unwrap()
        .fit;
    let errors = |fit: &calibrate::Fit| (fit.sphere_radius / 0.0692 - 1.0, fit.chi / 3.598 - 1.0);
    let (r, c) = errors(&fit);
    println!(
        "with servos: r_s {:+.2} %, chi {:+.2} %, rmse {:.5}",
        100.0 * r,
        100.0 * c,
        fit.rmse
    );
    assert!(r.abs() < 0.015 && c.abs() < 0.015, "{fit:?}");
    // Without the table the same tracks give something else: the path matters.
    campaign.swimmer.servo = None;
    let blind = calibrate_campaign(&campaign, &data, FitOptions::default())
        .unwrap()
        .fit;
    let (r, c) = errors(&blind);
    println!(
        "without: r_s {:+.2} %, chi {:+.2} %, rmse {:.5}",
        100.0 * r,
        100.0 * c,
        blind.rmse
    );
    assert!(
        r.abs().max(c.abs()) > 0.01 && blind.rmse > 5.0 * fit.rmse,
        "{blind:?}"
    );
}

#[test]
fn tracks_that_swim_the_other_way_are_refused_with_both_causes() {
    let tank = robot();
    let reflectors = tank.reflectors(tank.named().back.point, tank.named().front.point);
    let (campaign, data) = campaign(&tank, &[50.0, 70.0, 90.0], Tank::motive, reflectors);
    let error = calibrate_campaign(&campaign, &data, FitOptions::default()).unwrap_err();
    assert!(
        matches!(
            error,
            CalibrateError::Fit(FitError::SignOpposes { runs: 3, .. })
        ),
        "{error}"
    );
    let text = error.to_string();
    assert!(text.contains(":cw") && text.contains("exchanged"), "{text}");
}

#[test]
fn another_form_of_drag_moves_chi_and_is_reported() {
    let tank = robot();
    let (mut campaign, data) = campaign(&tank, &AMPLITUDES, Tank::motive, tank.named());
    campaign.swimmer.swimmer.tangential_drag = TangentialDrag::LogAspect(3.0);
    let fit = calibrate_campaign(&campaign, &data, FitOptions::default())
        .unwrap()
        .fit;
    assert_eq!(calibrate::c_t_form(&fit.c_t_form), "log_aspect = 3");
    // Half as much tangential drag again: chi falls, so that the normal drag stays nearer to what it was.
    assert!(fit.chi < 3.598 / 1.2 && fit.rmse > 0.01, "{fit:?}");
}

#[test]
fn one_run_is_fitted_with_a_warning() {
    let tank = robot();
    let (campaign, data) = campaign(&tank, &[70.0], Tank::motive, tank.named());
    let fit = calibrate_campaign(&campaign, &data, FitOptions::default())
        .unwrap()
        .fit;
    assert!(fit.warnings.contains(&FitWarning::FewRuns { runs: 1 }));
    assert!(matches!(
        calibrate_campaign(&campaign, &data, FitOptions { level: 1.5 }).unwrap_err(),
        CalibrateError::Fit(FitError::Level { .. })
    ));
}
