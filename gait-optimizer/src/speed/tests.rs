//! Known values, what the certificate catches, headings and periods.

use super::*;
use crate::{Condition, certify};
use swimmer_files::{AnyGait, Bounds, GaitFile, Objective};
use swimmer_model::Swimmer;

fn within(swimmer: Swimmer<f64>, max: f64) -> SpeedProblem {
    SpeedProblem {
        bounds: Bounds::within(max),
        starts: 12,
        threads: 2,
        ..SpeedProblem::new(swimmer, [1.0; 2])
    }
}

fn certified(found: &Fastest) {
    let certificate = &found.gait.certificate;
    assert!(certificate.pass(), "{}", certificate.failures());
}

/// Certified as a result and from its file alone.
fn certified_twice(found: &Fastest) {
    certified(found);
    let again = found.gait.certify().unwrap();
    assert!(again.pass(), "{}", again.failures());
}

#[test]
fn known_speeds() {
    for (swimmer, max, speed) in [
        (Swimmer::robot(), 2.0, 0.005_233_960_731_8),
        (Swimmer::robot(), 2.8, 0.007_533_853_203_8),
        (Swimmer::purcell(), 2.0, 0.012_915_416_912_7),
        (Swimmer::purcell(), 2.8, 0.015_272_491_902_1),
    ] {
        let found = fastest(&within(swimmer, max)).unwrap();
        certified(&found);
        assert!(
            (found.speed_over_length - speed).abs() < 1e-12,
            "{max} {}",
            found.speed_over_length
        );
        assert!(found.uncertified.is_none() && found.longer.is_none());
    }
}

/// The first guesses alone lead to the fastest gaits that are known.
#[test]
fn a_few_guesses_suffice() {
    let robot = [
        0.005_233_960_731_8,
        0.006_423_207_410_6,
        0.007_042_068_534_6,
        0.007_533_853_203_8,
        0.007_904_302_045_4,
    ];
    let purcell = [
        0.012_915_416_912_7,
        0.012_935_969_365_7,
        0.014_342_411_332_8,
        0.015_272_491_902_1,
        0.015_734_241_522_8,
    ];
    for (swimmer, speeds) in [(Swimmer::robot(), robot), (Swimmer::purcell(), purcell)] {
        for (max, speed) in [2.0, 2.4, 2.6, 2.8, 3.0].into_iter().zip(speeds) {
            let found = fastest(&SpeedProblem {
                starts: SpeedProblem::GUESSES,
                ..within(swimmer, max)
            })
            .unwrap();
            certified(&found);
            assert!(
                (found.speed_over_length - speed).abs() < 1e-12,
                "{max} {found:?}"
            );
        }
    }
}

/// Along the clearance, where it stops a tip at the middle link.
#[test]
fn a_clearance_is_followed() {
    let mut problem = within(Swimmer::robot(), 3.0);
    problem.bounds.no_overlap = true;
    problem.bounds.clearance = 0.02;
    let found = fastest(&problem).unwrap();
    certified_twice(&found);
    let along = |arc: &crate::Arc| arc.kind == swimmer_files::ArcKind::Clearance;
    assert!(found.gait.arcs.iter().any(along));
}

/// The file alone gives the same certificate, at any rate; a circle, a square and the gait scaled down by 1 % do not pass.
#[test]
fn the_certificate_is_that_of_the_curve() {
    let problem = within(Swimmer::purcell(), 2.8);
    let found = fastest(&SpeedProblem {
        rates: [0.3, 0.6],
        ..problem
    })
    .unwrap();
    certified_twice(&found);
    let of = |file: &GaitFile| {
        certify(&problem.swimmer, file, Objective::Speed, &problem.bounds).unwrap()
    };
    let file = found.gait.gait_file("");
    assert!(of(&file).value(Condition::NoBetterCorners).unwrap() > 0.0);
    for curve in [AnyGait::circle(1.6), AnyGait::square(1.4)] {
        let certificate = of(&GaitFile::sampled(&curve, 1024));
        assert!(!certificate.pass());
    }
    let mut moved = file.clone();
    for phi in &mut moved.phi {
        *phi *= 0.99;
    }
    let certificate = of(&moved);
    assert!(certificate.value(Condition::SwitchIntegrals).unwrap() > 1e-4);
    assert!(!certificate.pass());
}

#[test]
fn the_heading_is_as_asked() {
    let problem = within(Swimmer::purcell(), 2.8);
    let any = fastest(&problem).unwrap();
    for (rule, heading) in [
        (HeadingRule::Forward, 0.0),
        (HeadingRule::Sideways, std::f64::consts::FRAC_PI_2),
    ] {
        let found = fastest(&SpeedProblem {
            heading: rule,
            starts: 24,
            ..problem
        })
        .unwrap();
        certified(&found);
        assert!((found.heading - heading).abs() < 1e-9, "{}", found.heading);
        println!("{rule:?} {}", found.speed_over_length);
        assert!(found.speed_over_length < any.speed_over_length * (1.0 + 1e-12));
    }
}

#[test]
fn sideways_the_fastest_is_certified() {
    let problem = SpeedProblem {
        heading: HeadingRule::Sideways,
        starts: 64,
        ..within(Swimmer::robot(), 2.8)
    };
    let found = fastest(&problem).unwrap();
    certified_twice(&found);
    assert!((found.speed_over_length - 0.007_373_297_394_7).abs() < 1e-12);
    assert!(
        found.uncertified.is_none(),
        "{} {:?}",
        found.speed_over_length,
        found.uncertified
    );
}

/// The farthest in the fastest gait's own period is that gait; in another period it is slower, and H is dD/dT.
#[test]
fn the_farthest_in_a_period() {
    let problem = within(Swimmer::purcell(), 2.4);
    let free = fastest(&problem).unwrap();
    let at = |period: f64| {
        let found = fastest(&SpeedProblem {
            period: Some(period),
            ..problem
        })
        .unwrap();
        certified_twice(&found);
        assert!((found.period - period).abs() < 1e-9);
        found
    };
    let same = at(free.period);
    assert!((same.speed_over_length - free.speed_over_length).abs() < 1e-12);
    let (shorter, longer) = (at(free.period - 1e-3), at(free.period + 1e-3));
    let slope = (longer.distance_over_length - shorter.distance_over_length) / 2e-3;
    assert!((slope - free.speed_over_length).abs() < 1e-6, "{slope}");
    assert!(longer.speed_over_length < free.speed_over_length);
    assert!(shorter.speed_over_length < free.speed_over_length);
}

#[test]
fn nonsense_is_refused() {
    let problem = SpeedProblem::new(Swimmer::purcell(), [1.0, 0.0]);
    assert!(matches!(fastest(&problem), Err(SpeedError::Rate { .. })));
    let mut problem = SpeedProblem::new(Swimmer::purcell(), [1.0; 2]);
    problem.bounds.sector = true;
    assert!(matches!(
        fastest(&problem),
        Err(SpeedError::OfQuarters { .. })
    ));
    let problem = SpeedProblem {
        period: Some(f64::NAN),
        ..SpeedProblem::new(Swimmer::purcell(), [1.0; 2])
    };
    assert!(matches!(fastest(&problem), Err(SpeedError::Period { .. })));
}
