//! Rows of sections II and IV: the robot, its experiments, displacement gaits, height maps.

use std::f64::consts::{PI, TAU};

use gait_optimizer::{BestAmplitude, HeightMap, OptimalGait, Row as HeightRow};
use nalgebra::Vector2;
use swimmer_files::AnyGait;
use swimmer_model::{Fourier, Harmonic, Links, Model, Tolerance, swim};

use super::{RATIO, ROUGH, Row, failed_checks, first, second};
use crate::study::{Simple, Study};

/// Section II.B: what is said of the robot.
pub(super) fn robot_data(study: &Study) -> Vec<Row> {
    const OMEGA: f64 = 0.24;
    const KINEMATIC_VISCOSITY: f64 = 0.06;
    let Links { front, .. } = study.robot.swimmer().links;
    let velocity = 0.5 * front * OMEGA;
    vec![
        Row::near(
            "robot.velocity",
            "velocity of a side link, ½ l₂ ω [m/s]",
            0.0168,
            velocity,
            ROUGH,
        )
        .note("½ · 0.137 m · 0.24 rad/s"),
        Row::near(
            "robot.reynolds",
            "Reynolds number v l/ν",
            0.039,
            velocity * front / KINEMATIC_VISCOSITY,
            ROUGH,
        ),
        Row::near("robot.period", "period 2π/ω [s]", 30.0, TAU / OMEGA, ROUGH)
            .not_reproducible("2π/0.24 is 26 s; the paper says about 30"),
    ]
}

/// Sections II.B and II.C: circles of the robot.
pub(super) fn experiments(study: &Study) -> Vec<Row> {
    let circle = swim(
        &study.robot,
        &AnyGait::circle(70_f64.to_radians()),
        &Tolerance::default(),
    );
    let best = |simple: &Simple| first(&simple.displacement[0]).displacement_over_length;
    let amplitude = 70_f64.to_radians();
    let printed = printed_sinusoid(&study.robot, amplitude, PI / 2.0);
    let drawn = circle.displacement.x;
    vec![
        Row::zero(
            "circle70.lateral",
            "net lateral displacement of the 70° circle over L",
            circle.displacement_over_length().y,
            1e-9,
        ),
        Row::zero(
            "circle70.rotation",
            "net rotation of the 70° circle [rad]",
            circle.rotation,
            1e-9,
        ),
        Row::near(
            "sinusoid.magnitude",
            "|X| of the printed sinusoids with ψ = π/2 over that of the circle",
            1.0,
            (printed / drawn).abs(),
            1e-9,
        ),
        Row::near(
            "sinusoid.sign",
            "their X over that of the counter-clockwise circle",
            1.0,
            printed / drawn,
            RATIO,
        )
        .not_reproducible(
            "as printed they run clockwise, so X is negative; the figures show ψ = −π/2",
        ),
        Row::range(
            "circle.model_over_robot",
            "largest X of circles: slender links over the fitted robot",
            "more than 3",
            (3.0, f64::INFINITY),
            best(&study.slender_simple) / best(&study.robot_simple),
        ),
        Row::range(
            "circle.experiment_optimum",
            "amplitude of the robot's best circle [deg]",
            "there is one",
            (0.0, 180.0),
            first(&study.robot_simple.displacement[0])
                .amplitude
                .to_degrees(),
        ),
    ]
}

/// X of φ₁ = ε cos(ωt − ψ/2), φ₂ = ε cos(ωt + ψ/2), along the heading at t = 0.
fn printed_sinusoid(model: &Model<f64>, amplitude: f64, phase: f64) -> f64 {
    let (sin, cos) = (phase / 2.0).sin_cos();
    let gait = Fourier {
        mean: Vector2::zeros(),
        harmonics: [Harmonic {
            cos: Vector2::new(cos, cos) * amplitude,
            sin: Vector2::new(sin, -sin) * amplitude,
        }],
    };
    swim(model, &gait, &Tolerance::default()).displacement.x
}

/// Section IV.A: circles and squares over their amplitude.
pub(super) fn simple_displacement(study: &Study) -> Vec<Row> {
    let [circles, squares] = &study.robot_simple.displacement;
    let turned = |best: &[BestAmplitude]| {
        second(best).displacement_over_length / first(best).displacement_over_length
    };
    let around =
        |id, quantity, ours| Row::around(id, quantity, "around 1.5 to 2", (1.5, 2.0), ours);
    let far = |id, quantity, ours| Row::around(id, quantity, "around 3 to 4", (3.0, 4.0), ours);
    let reversed = |id, quantity, ours| {
        Row::range(
            id,
            quantity,
            "the other way, and farther",
            (f64::NEG_INFINITY, -1.0),
            ours,
        )
    };
    vec![
        around(
            "displacement.circle.first",
            "robot: first best amplitude of circles [rad]",
            first(circles).amplitude,
        ),
        far(
            "displacement.circle.second",
            "robot: second best amplitude of circles [rad]",
            second(circles).amplitude,
        ),
        around(
            "displacement.square.first",
            "robot: first best amplitude of squares [rad]",
            first(squares).amplitude,
        ),
        far(
            "displacement.square.second",
            "robot: second best amplitude of squares [rad]",
            second(squares).amplitude,
        ),
        reversed(
            "displacement.circle.second_over_first",
            "robot: X of the second best circle over the first",
            turned(circles),
        ),
        reversed(
            "displacement.square.second_over_first",
            "robot: X of the second best square over the first",
            turned(squares),
        ),
    ]
}

/// Section IV.D: gaits (b), (c), (d).
pub(super) fn displacement_gaits(study: &Study) -> Vec<Row> {
    let [b, c, d] = &study.robot_displacement;
    let ratio =
        |over: &OptimalGait, under: &OptimalGait| (over.displacement / under.displacement).abs();
    let failed = |gait: &OptimalGait| failed_checks(gait);
    vec![
        Row::zero(
            "displacement.unbounded",
            "optima of the robot without bounds",
            f64::from(u8::from(study.robot_unbounded)),
            0.0,
        ),
        Row::range(
            "displacement.b",
            "X/L of gait (b)",
            "positive",
            (0.0, f64::INFINITY),
            b.displacement_over_length,
        ),
        Row::range(
            "displacement.c",
            "X/L of gait (c)",
            "negative",
            (f64::NEG_INFINITY, 0.0),
            c.displacement_over_length,
        ),
        Row::range(
            "displacement.d",
            "X/L of gait (d)",
            "negative",
            (f64::NEG_INFINITY, 0.0),
            d.displacement_over_length,
        ),
        Row::near(
            "displacement.c_over_b",
            "|X| of gait (c) over (b)",
            1.55,
            ratio(c, b),
            RATIO,
        ),
        Row::near(
            "displacement.d_over_b",
            "|X| of gait (d) over (b)",
            2.04,
            ratio(d, b),
            RATIO,
        ),
        Row::near(
            "displacement.d_over_c",
            "|X| of gait (d) over (c)",
            1.31,
            ratio(d, c),
            RATIO,
        ),
        Row::zero(
            "displacement.b.certificate",
            "conditions that gait (b) fails, from its curve alone",
            failed(b),
            0.0,
        ),
        Row::zero(
            "displacement.c.certificate",
            "conditions that gait (c) fails, from its curve alone",
            failed(c),
            0.0,
        ),
        Row::zero(
            "displacement.d.certificate",
            "conditions that gait (d) fails, from its curve alone",
            failed(d),
            0.0,
        ),
    ]
}

/// Section IV.B and its figure: area rule and zero-level curves.
pub(super) fn height_maps(study: &Study) -> Vec<Row> {
    let small = AnyGait::circle(0.3);
    let ratio = study
        .robot_map
        .area_rule(&small)
        .map_or(f64::NAN, |rule| rule.area.x / rule.swum.x);
    let gait = &study.purcell_displacement;
    let curves = study.purcell_map.zero_curves(HeightRow::X);
    let apart = gait.phi().iter().map(|shape| {
        curves
            .iter()
            .flat_map(|curve| curve.points.windows(2))
            .map(|side| match side {
                [a, b] => distance(shape, a, b),
                _ => f64::INFINITY,
            })
            .fold(f64::INFINITY, f64::min)
    });
    let joining = |map: &HeightMap| {
        let curves = map.zero_curves(HeightRow::X);
        curves
            .iter()
            .filter(|curve| joins_both_lines(&curve.points))
            .count() as f64
    };
    vec![
        Row::near(
            "area_rule",
            "area under the height over X, robot, circle of 0.3 rad",
            1.0,
            ratio,
            RATIO,
        )
        .note("with dA + [A₁, A₂]; the printed minus does not hold"),
        Row::range(
            "zero_curve.purcell",
            "Purcell's swimmer: largest distance of its gait from the zero-level curve [rad]",
            "nearly identical",
            (0.0, 0.05),
            apart.fold(0.0, f64::max),
        ),
        Row::range(
            "zero_curve.purcell.joins",
            "Purcell's swimmer: zero-level curves from φ₁ = φ₂ to φ₁ = −φ₂ within 2.5 rad",
            "at least one",
            (1.0, f64::INFINITY),
            joining(&study.purcell_map),
        ),
        Row::zero(
            "zero_curve.robot",
            "robot: zero-level curves from φ₁ = φ₂ to φ₁ = −φ₂ within 2.8 rad",
            joining(&study.robot_map),
            0.0,
        )
        .note("which is why there is no gait without bounds"),
    ]
}

/// Distance of a point from a side.
fn distance(point: &Vector2<f64>, a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
    let side = b - a;
    let along = ((point - a).dot(&side) / side.norm_squared()).clamp(0.0, 1.0);
    (a + side * along - point).norm()
}

/// Whether a curve leads from φ₁ = φ₂ > 0 to φ₁ = −φ₂, φ₂ > 0 without crossing another symmetry line between.
fn joins_both_lines(points: &[Vector2<f64>]) -> bool {
    #[derive(PartialEq)]
    enum Line {
        Start,
        End,
        Other,
    }
    let crossed = points.windows(2).filter_map(|side| {
        let [a, b] = side else { return None };
        let across = |value: fn(&Vector2<f64>) -> f64| (value(a) < 0.0) != (value(b) < 0.0);
        if across(|p| p.x - p.y) {
            Some(if a.x + a.y > 0.0 {
                Line::Start
            } else {
                Line::Other
            })
        } else if across(|p| p.x + p.y) {
            Some(if a.y - a.x > 0.0 {
                Line::End
            } else {
                Line::Other
            })
        } else {
            None
        }
    });
    // Round once more, for a closed curve may begin anywhere.
    let crossed: Vec<Line> = crossed.collect();
    let closed = points.first() == points.last();
    let next = crossed.iter().cycle().skip(1);
    crossed
        .iter()
        .zip(next)
        .take(if closed {
            crossed.len()
        } else {
            crossed.len().saturating_sub(1)
        })
        .any(|pair| matches!(pair, (Line::Start, Line::End) | (Line::End, Line::Start)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_curve_between_both_lines_joins_them() {
        let circle: Vec<_> = (0..=40)
            .map(|i| f64::from(i) / 40.0 * TAU + 0.1)
            .map(|t| Vector2::new(t.cos(), t.sin()))
            .collect();
        assert!(joins_both_lines(&circle));
        let aside: Vec<_> = circle
            .iter()
            .map(|p| p * 0.3 + Vector2::new(0.0, 1.0))
            .collect();
        assert!(!joins_both_lines(&aside));
        let through: Vec<_> = circle
            .iter()
            .map(|p| p * 0.3 + Vector2::new(1.0, 1.0))
            .collect();
        assert!(!joins_both_lines(&through));
    }
}
