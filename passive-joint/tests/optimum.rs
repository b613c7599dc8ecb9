//! Best waveforms: conditions, gain over the sinusoid, and a direct transcription that shares only A and W with the search.

mod transcription;

use link_protocol::Joint;
use passive_joint::{Objective, Optima, PassiveError, Problem, SpringChoice, optimize};
use swimmer_model::{Model, Swimmer};
use transcription::Transcription;

fn problem(model: &Model<f64>) -> Problem<'_> {
    Problem {
        model,
        joint: Joint::Back,
        objective: Objective::Displacement,
        spring: SpringChoice::OverViscosity(1.0),
        period: None,
        max_angle: 1.0,
        max_rate: None,
        harmonics: 3,
    }
}

#[test]
fn optima_fulfil_their_conditions_and_beat_the_sinusoid() {
    let purcell = Model::new(&Swimmer::purcell()).unwrap();
    for (objective, max_rate, gain) in [
        (Objective::Displacement, None, 0.435),
        (Objective::Speed, Some(10.0), 0.088),
        (Objective::Efficiency, None, 0.136),
    ] {
        let problem = Problem {
            objective,
            max_rate,
            ..problem(&purcell)
        };
        let Optima { best, sine } = optimize(&problem).unwrap();
        for found in [&best, &sine] {
            assert!(found.conditions.stationarity < 1e-8);
            assert!(found.conditions.complementarity < 1e-8);
            assert!(found.conditions.is_strict);
            assert!(found.largest_angle < 1.0 + 1e-4, "{}", found.largest_angle);
        }
        let share = (best.value - sine.value).exp() - 1.0;
        assert!(
            (gain..gain + 1e-3).contains(&share),
            "{objective:?}: {share}"
        );
    }
}

/// `tests/limit_cycle.rs` finds the same frequency by an integration in time.
#[test]
fn the_best_sinusoid_is_that_of_the_best_frequency() {
    let purcell = Model::new(&Swimmer::purcell()).unwrap();
    let Optima { sine, .. } = optimize(&problem(&purcell)).unwrap();
    assert!((std::f64::consts::TAU / sine.passive.kappa - 4.6333).abs() < 1e-4);
    assert!((sine.values.displacement / 3.0 - 0.018_275_69).abs() < 1e-8);
}

#[test]
fn a_direct_transcription_finds_the_same_optima() {
    let purcell = Model::new(&Swimmer::purcell()).unwrap();
    let robot = Model::new(&Swimmer::robot()).unwrap();
    for (model, joint, objective) in [
        (&purcell, Joint::Back, Objective::Displacement),
        (&purcell, Joint::Back, Objective::Efficiency),
        (&robot, Joint::Front, Objective::Displacement),
    ] {
        let problem = Problem {
            joint,
            objective,
            spring: SpringChoice::Free,
            period: Some(30.0),
            harmonics: 2,
            ..problem(model)
        };
        let Optima { best, sine } = optimize(&problem).unwrap();
        let (value, coefficients) = Transcription::new(&problem).maximise(&sine);
        assert!(
            (value - best.value).abs() < 1e-6,
            "{} and {value}",
            best.value
        );
        for (one, other) in coefficients.iter().zip(best.waveform.coefficients()) {
            assert!(
                (one - other).abs() < 1e-3,
                "{coefficients:?} and {:?}",
                best.waveform
            );
        }
    }
}

#[test]
fn problems_without_an_optimum_are_refused_with_the_reason() {
    let purcell = Model::new(&Swimmer::purcell()).unwrap();
    let refused = |problem: Problem<'_>| optimize(&problem).unwrap_err();
    let speed = Problem {
        objective: Objective::Speed,
        ..problem(&purcell)
    };
    assert_eq!(refused(speed), PassiveError::NeedsRate);
    let free = Problem {
        spring: SpringChoice::Free,
        ..problem(&purcell)
    };
    assert_eq!(refused(free), PassiveError::NeedsPeriod);
    for max_angle in [0.0, f64::NAN] {
        let error = refused(Problem {
            max_angle,
            ..problem(&purcell)
        });
        assert!(matches!(error, PassiveError::Bound { .. }), "{error}");
    }
    let error = refused(Problem {
        harmonics: 9,
        ..problem(&purcell)
    });
    assert!(matches!(error, PassiveError::Harmonics { .. }), "{error}");
}
