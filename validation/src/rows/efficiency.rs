//! Rows of section V and of the appendices: Lighthill's efficiency.

use gait_optimizer::{BestAmplitude, Condition, closed_forms};
use nalgebra::Vector2;
use swimmer_model::{Model, Swimmer};

use super::computed::{Computed, failed_checks, first, largest, second, value_of};
use crate::study::{Lighthill, Simple, Study};

/// Section V.A: circles and squares again, for the efficiency.
pub(super) fn simple_efficiency(study: &Study) -> Vec<Computed> {
    let of = |simple: &Simple| {
        let [circles, squares] = &simple.efficiency;
        (*first(circles), *second(squares))
    };
    let (purcell, purcell_large) = of(&study.purcell_simple);
    let (robot, robot_large) = of(&study.robot_simple);
    let ratio = |over: BestAmplitude, under: BestAmplitude| over.efficiency / under.efficiency;
    let x = |best: BestAmplitude| best.displacement_over_length;
    vec![
        ("efficiency.purcell.circle", purcell.amplitude),
        ("efficiency.purcell.square", purcell_large.amplitude),
        ("efficiency.robot.circle", robot.amplitude),
        ("efficiency.robot.square", robot_large.amplitude),
        (
            "efficiency.purcell.second_over_first",
            ratio(purcell_large, purcell),
        ),
        (
            "efficiency.robot.second_over_first",
            ratio(robot_large, robot),
        ),
        ("efficiency.purcell.square.x", x(purcell_large)),
        ("efficiency.robot.square.x", x(robot_large)),
        (
            "efficiency.purcell_over_robot",
            ratio(purcell_large, robot_large),
        ),
    ]
}

/// Sections V.C and V.D: Lighthill gaits.
pub(super) fn lighthill_gaits(study: &Study) -> Vec<Computed> {
    let over_small = |gaits: &Lighthill| gaits.large.efficiency / gaits.small.efficiency;
    let over_square = |gaits: &Lighthill, simple: &Simple| {
        gaits.large.efficiency / second(&simple.efficiency[1]).efficiency
    };
    let (purcell, robot) = (&study.purcell_lighthill, &study.robot_lighthill);
    vec![
        ("lighthill.purcell.large_over_small", over_small(purcell)),
        (
            "lighthill.purcell.large_over_square",
            over_square(purcell, &study.purcell_simple),
        ),
        ("lighthill.robot.large_over_small", over_small(robot)),
        (
            "lighthill.robot.large_over_square",
            over_square(robot, &study.robot_simple),
        ),
        (
            "lighthill.purcell.large.x",
            purcell.large.displacement_over_length,
        ),
        (
            "lighthill.robot.large.x",
            robot.large.displacement_over_length,
        ),
        (
            "lighthill.purcell.small.certificate",
            failed_checks(&purcell.small),
        ),
        (
            "lighthill.purcell.large.certificate",
            failed_checks(&purcell.large),
        ),
        (
            "lighthill.robot.small.certificate",
            failed_checks(&robot.small),
        ),
        (
            "lighthill.robot.large.certificate",
            failed_checks(&robot.large),
        ),
    ]
}

/// Appendices A and B.
pub(super) fn appendices(study: &Study) -> Vec<Computed> {
    let gaits = [
        &study.purcell_lighthill.small,
        &study.purcell_lighthill.large,
        &study.robot_lighthill.small,
        &study.robot_lighthill.large,
    ];
    let largest_of =
        |condition: Condition| largest(gaits.iter().map(|gait| value_of(gait, condition)));
    let forms = |symmetric: bool| {
        let models = [&study.purcell, &study.robot].into_iter();
        largest(models.flat_map(|model| {
            (1..30).map(move |i| form_deviation(model, 0.1 * f64::from(i), symmetric))
        }))
    };
    vec![
        ("appendix_a.power", largest_of(Condition::ConstantPower)),
        ("appendix_b.ends", largest_of(Condition::EndsSquare)),
        ("appendix_b.b4", forms(true)),
        ("appendix_b.b9", forms(false)),
    ]
}

fn form_deviation(model: &Model<f64>, phi: f64, symmetric: bool) -> f64 {
    let swimmer: &Swimmer<f64> = model.swimmer();
    let (computed, formula) = if symmetric {
        let w = model.power_matrix(&Vector2::new(phi, phi));
        (
            2.0 * (w.m11 + w.m12),
            closed_forms::along_the_symmetric_shapes(swimmer, phi),
        )
    } else {
        let w = model.power_matrix(&Vector2::new(-phi, phi));
        (
            2.0 * (w.m11 - w.m12),
            closed_forms::along_the_point_symmetric_shapes(swimmer, phi),
        )
    };
    (formula / computed - 1.0).abs()
}
