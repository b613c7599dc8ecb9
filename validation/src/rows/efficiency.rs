//! Rows of section V and of the appendices: Lighthill's efficiency.

use gait_optimizer::{OptimalGait, closed_forms};
use nalgebra::Vector2;
use swimmer_model::{Model, Swimmer};

use super::{RATIO, Row, failed_checks, first, second, value_of};
use crate::study::{Lighthill, Simple, Study};

/// Section V.A: circles and squares again, for the efficiency.
pub(super) fn simple_efficiency(study: &Study) -> Vec<Row> {
    let of = |simple: &Simple| {
        let [circles, squares] = &simple.efficiency;
        (*first(circles), *second(squares))
    };
    let (purcell_small, purcell_large) = of(&study.purcell_simple);
    let (robot_small, robot_large) = of(&study.robot_simple);
    let small = |id, quantity, ours| Row::around(id, quantity, "around 1 to 2", (1.0, 2.0), ours);
    let large = |id, quantity, ours| Row::around(id, quantity, "around 3 to 4", (3.0, 4.0), ours);
    let better =
        |id, quantity, ours| Row::range(id, quantity, "better", (1.0, f64::INFINITY), ours);
    let negative =
        |id, quantity, ours| Row::range(id, quantity, "negative", (f64::NEG_INFINITY, 0.0), ours);
    vec![
        small(
            "efficiency.purcell.circle",
            "Purcell: amplitude of the best small circle [rad]",
            purcell_small.amplitude,
        ),
        large(
            "efficiency.purcell.square",
            "Purcell: amplitude of the best large square [rad]",
            purcell_large.amplitude,
        ),
        small(
            "efficiency.robot.circle",
            "robot: amplitude of the best small circle [rad]",
            robot_small.amplitude,
        ),
        large(
            "efficiency.robot.square",
            "robot: amplitude of the best large square [rad]",
            robot_large.amplitude,
        ),
        better(
            "efficiency.purcell.second_over_first",
            "Purcell: ξ of the large square over the small circle",
            purcell_large.efficiency / purcell_small.efficiency,
        ),
        better(
            "efficiency.robot.second_over_first",
            "robot: ξ of the large square over the small circle",
            robot_large.efficiency / robot_small.efficiency,
        ),
        negative(
            "efficiency.purcell.square.x",
            "Purcell: X/L of the large square",
            purcell_large.displacement_over_length,
        ),
        negative(
            "efficiency.robot.square.x",
            "robot: X/L of the large square",
            robot_large.displacement_over_length,
        ),
        Row::near(
            "efficiency.purcell_over_robot",
            "ξ of Purcell's best simple gait over the robot's",
            100.0,
            purcell_large.efficiency / robot_large.efficiency,
            RATIO,
        )
        .not_reproducible(
            "\"two orders of magnitude\": 22 to 71 times with l = L, by gait and form of c_t",
        ),
    ]
}

/// Sections V.C and V.D: Lighthill gaits.
pub(super) fn lighthill_gaits(study: &Study) -> Vec<Row> {
    let over_small = |gaits: &Lighthill| gaits.large.efficiency / gaits.small.efficiency;
    let over_square = |gaits: &Lighthill, simple: &Simple| {
        gaits.large.efficiency / second(&simple.efficiency[1]).efficiency
    };
    let mut rows = vec![
        Row::near(
            "lighthill.purcell.large_over_small",
            "Purcell: ξ of the large gait over the small one",
            1.46,
            over_small(&study.purcell_lighthill),
            RATIO,
        ),
        Row::near(
            "lighthill.purcell.large_over_square",
            "Purcell: ξ of the large gait over the best large square",
            1.20,
            over_square(&study.purcell_lighthill, &study.purcell_simple),
            RATIO,
        )
        .note("both at constant power"),
        Row::near(
            "lighthill.robot.large_over_small",
            "robot: ξ of the large gait over the small one",
            1.45,
            over_small(&study.robot_lighthill),
            RATIO,
        ),
        Row::near(
            "lighthill.robot.large_over_square",
            "robot: ξ of the large gait over the best large square",
            1.90,
            over_square(&study.robot_lighthill, &study.robot_simple),
            RATIO,
        )
        .note("both at constant power"),
    ];
    let negative = |id, quantity, gait: &OptimalGait| {
        Row::range(
            id,
            quantity,
            "negative",
            (f64::NEG_INFINITY, 0.0),
            gait.displacement_over_length,
        )
    };
    rows.push(negative(
        "lighthill.purcell.large.x",
        "Purcell: X/L of the large gait",
        &study.purcell_lighthill.large,
    ));
    rows.push(negative(
        "lighthill.robot.large.x",
        "robot: X/L of the large gait",
        &study.robot_lighthill.large,
    ));
    for (id, quantity, gait) in [
        (
            "lighthill.purcell.small.certificate",
            "conditions that Purcell's small gait fails, from its curve alone",
            &study.purcell_lighthill.small,
        ),
        (
            "lighthill.purcell.large.certificate",
            "conditions that Purcell's large gait fails, from its curve alone",
            &study.purcell_lighthill.large,
        ),
        (
            "lighthill.robot.small.certificate",
            "conditions that the robot's small gait fails, from its curve alone",
            &study.robot_lighthill.small,
        ),
        (
            "lighthill.robot.large.certificate",
            "conditions that the robot's large gait fails, from its curve alone",
            &study.robot_lighthill.large,
        ),
    ] {
        rows.push(Row::zero(id, quantity, failed_checks(gait), 0.0));
    }
    rows
}

/// Appendices A and B.
pub(super) fn appendices(study: &Study) -> Vec<Row> {
    let gaits = [
        &study.purcell_lighthill.small,
        &study.purcell_lighthill.large,
        &study.robot_lighthill.small,
        &study.robot_lighthill.large,
    ];
    let largest = |name: &str| {
        gaits
            .iter()
            .map(|gait| value_of(gait, name))
            .fold(0.0, f64::max)
    };
    let forms = |symmetric: bool| {
        [&study.purcell, &study.robot]
            .into_iter()
            .flat_map(|model| {
                (1..30).map(move |i| form_deviation(model, 0.1 * f64::from(i), symmetric))
            })
            .fold(0.0, f64::max)
    };
    vec![
        Row::zero(
            "appendix_a.power",
            "largest variation of the power of the four Lighthill gaits, over its mean",
            largest("power_variation"),
            1e-7,
        ),
        Row::zero(
            "appendix_b.ends",
            "largest angle by which they miss a right angle on the symmetry lines [rad]",
            largest("ends_not_square_rad"),
            1e-7,
        ),
        Row::zero(
            "appendix_b.b4",
            "2a + b: largest relative deviation of the printed formula from the model",
            forms(true),
            1e-12,
        ),
        Row::zero(
            "appendix_b.b9",
            "2a − b: largest relative deviation of the mended formula from the model",
            forms(false),
            1e-12,
        )
        .note("D₂ needs 8r³ where 8z³ is printed, and a factor χ before the last bracket"),
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
