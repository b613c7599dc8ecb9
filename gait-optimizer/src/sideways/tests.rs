use swimmer_files::{Bounds, Objective};
use swimmer_model::{Model, Swimmer, Tolerance, swim};

use super::{SidewaysError, SidewaysProblem, sideways};
use crate::InvalidProblem;

fn problem(swimmer: Swimmer<f64>) -> SidewaysProblem {
    SidewaysProblem {
        bounds: Bounds::within(2.8),
        starts: 24,
        ..SidewaysProblem::new(swimmer)
    }
}

#[test]
fn the_robot_moves_sideways_without_turning() {
    let found = sideways(&problem(Swimmer::robot()), &|_| ()).unwrap();
    assert!(found.gait.certificate.pass());
    assert_eq!(found.gait.objective, Objective::Sideways);
    // Gait (b) turns its heading by 0.92028 rad either way (`swimmer simulate`), X/L = 0.0796979722.
    assert!(found.lateral_over_length >= 0.079_697_972_2 * 0.920_282_807_f64.sin() - 1e-8);
    let model = Model::new(&Swimmer::robot()).unwrap();
    let stroke = swim(&model, &found.gait.gait().unwrap(), &Tolerance::default());
    let across = stroke.displacement_over_length().y;
    assert!((across - found.lateral_over_length).abs() < 1e-9);
    assert!(stroke.rotation.abs() < 1e-8);
    // Told against the mean heading, the first sample does not matter.
    let heading = found.gait.heading().unwrap();
    let cycle = super::square::begun_at(&found.gait, &found.gait.gait().unwrap(), 0.3);
    let unit = Model::new(&found.gait.swimmer.of_unit_length()).unwrap();
    let later = super::gait((&problem(Swimmer::robot()), &unit), cycle).unwrap();
    let off = later.heading().unwrap() - heading;
    assert!(off.abs() < 1e-6, "{heading} and {off:.1e}");
}

/// A wider bound leaves no less: the quarter solver's gaits are among the loops that are compared.
#[test]
fn a_wider_bound_leaves_purcells_swimmer_no_less() {
    let within = |max_angle: f64| {
        let problem = SidewaysProblem {
            bounds: Bounds::within(max_angle),
            starts: 4,
            ..SidewaysProblem::new(Swimmer::purcell())
        };
        sideways(&problem, &|_| ()).unwrap().lateral_over_length
    };
    let (tight, wide) = (within(3.1), within(3.5));
    println!("{tight} {wide}");
    assert!(wide >= tight - 1e-9, "{tight} {wide}");
}

/// The same swimmer, whichever end is called its front.
#[test]
fn front_and_back_are_names() {
    let of = |front: f64, back: f64| {
        let mut swimmer = Swimmer::purcell();
        (swimmer.links.front, swimmer.links.back) = (front, back);
        let problem = SidewaysProblem {
            starts: 4,
            ..problem(swimmer)
        };
        let found = sideways(&problem, &|_| ()).unwrap();
        let model = Model::new(&swimmer).unwrap();
        let stroke = swim(&model, &found.gait.gait().unwrap(), &Tolerance::default());
        let across = stroke.displacement_over_length().y;
        assert!((across - found.lateral_over_length).abs() < 1e-8);
        let certificate = found.gait.certify().unwrap();
        assert!(certificate.pass(), "{}", certificate.failures());
        across
    };
    let (one, other) = (of(1.0, 0.7), of(0.7, 1.0));
    println!("{one} {other}");
    assert!((one - other).abs() < 1e-8, "{one} {other}");
}

#[test]
fn senseless_problems_are_refused() {
    let mut bad = problem(Swimmer::purcell());
    bad.bounds.sector = true;
    let quarter = SidewaysError::Problem(InvalidProblem::QuarterBound { name: "sector" }.into());
    assert_eq!(sideways(&bad, &|_| ()), Err(quarter));
}
