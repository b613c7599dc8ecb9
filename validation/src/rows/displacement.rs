//! Rows of sections II and IV: the robot, its experiments, displacement gaits, height maps.

use std::f64::consts::{PI, TAU};

use gait_optimizer::{BestAmplitude, HeightMap, OptimalGait, Row as HeightRow};
use nalgebra::Vector2;
use swimmer_files::AnyGait;
use swimmer_model::{Fourier, Harmonic, Links, Model, Tolerance, swim};

use super::computed::{Computed, failed_checks, first, largest, second};
use crate::study::{Simple, Study};

/// Section II.B: data of the robot.
pub(super) fn robot_data(study: &Study) -> Vec<Computed> {
    const OMEGA: f64 = 0.24;
    const KINEMATIC_VISCOSITY: f64 = 0.06;
    let Links { front, .. } = study.robot.swimmer().links;
    let velocity = 0.5 * front * OMEGA;
    vec![
        ("robot.velocity", velocity),
        ("robot.reynolds", velocity * front / KINEMATIC_VISCOSITY),
        ("robot.period", TAU / OMEGA),
    ]
}

/// Sections II.B and II.C: experiments of the robot with circles.
pub(super) fn experiments(study: &Study) -> Vec<Computed> {
    let amplitude = 70_f64.to_radians();
    let circle = swim(
        &study.robot,
        &AnyGait::circle(amplitude),
        &Tolerance::default(),
    );
    let best = |simple: &Simple| *first(&simple.displacement[0]);
    let (robot, slender) = (best(&study.robot_simple), best(&study.slender_simple));
    let printed = printed_sinusoid(&study.robot, amplitude, PI / 2.0) / circle.displacement.x;
    vec![
        ("circle70.lateral", circle.displacement_over_length().y),
        ("circle70.rotation", circle.rotation),
        ("circle70.delta_y", 1e3 * circle.delta_y),
        ("circle70.delta_theta", circle.delta_theta.to_degrees()),
        ("sinusoid.magnitude", printed.abs()),
        ("sinusoid.sign", printed),
        (
            "circle.model_over_robot",
            slender.displacement_over_length / robot.displacement_over_length,
        ),
        ("circle.experiment_optimum", robot.amplitude.to_degrees()),
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
pub(super) fn simple_displacement(study: &Study) -> Vec<Computed> {
    let [circles, squares] = &study.robot_simple.displacement;
    let turned = |best: &[BestAmplitude]| {
        second(best).displacement_over_length / first(best).displacement_over_length
    };
    vec![
        ("displacement.circle.first", first(circles).amplitude),
        ("displacement.circle.second", second(circles).amplitude),
        ("displacement.square.first", first(squares).amplitude),
        ("displacement.square.second", second(squares).amplitude),
        ("displacement.circle.second_over_first", turned(circles)),
        ("displacement.square.second_over_first", turned(squares)),
    ]
}

/// Section IV.D: gaits (b), (c), (d).
pub(super) fn displacement_gaits(study: &Study) -> Vec<Computed> {
    let [b, c, d] = &study.robot_displacement;
    let ratio =
        |over: &OptimalGait, under: &OptimalGait| (over.displacement / under.displacement).abs();
    let unbounded = f64::from(u8::from(study.robot_unbounded));
    vec![
        ("displacement.unbounded", unbounded),
        ("displacement.b", b.displacement_over_length),
        ("displacement.c", c.displacement_over_length),
        ("displacement.d", d.displacement_over_length),
        ("displacement.c_over_b", ratio(c, b)),
        ("displacement.d_over_b", ratio(d, b)),
        ("displacement.d_over_c", ratio(d, c)),
        ("displacement.b.certificate", failed_checks(b)),
        ("displacement.c.certificate", failed_checks(c)),
        ("displacement.d.certificate", failed_checks(d)),
    ]
}

/// Section IV.B and its figure: area rule and zero-level curves.
pub(super) fn height_maps(study: &Study) -> Vec<Computed> {
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
            .flat_map(|curve| curve.points.array_windows())
            .map(|[a, b]| distance(shape, a, b))
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
        ("area_rule", ratio),
        ("zero_curve.purcell", largest(apart)),
        ("zero_curve.purcell.joins", joining(&study.purcell_map)),
        ("zero_curve.robot", joining(&study.robot_map)),
    ]
}

/// Distance of a point from a side.
fn distance(point: &Vector2<f64>, a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
    let side = b - a;
    let along = ((point - a).dot(&side) / side.norm_squared()).clamp(0.0, 1.0);
    (a + side * along - point).norm()
}

/// Returns `true` if a curve connects φ₁ = φ₂ > 0 to φ₁ = −φ₂, φ₂ > 0 without crossing another symmetry line in between.
fn joins_both_lines(points: &[Vector2<f64>]) -> bool {
    #[derive(PartialEq)]
    enum SymmetryLine {
        Start,
        End,
        Other,
    }
    let crossed = points.array_windows().filter_map(|[a, b]| {
        let across = |value: fn(&Vector2<f64>) -> f64| (value(a) < 0.0) != (value(b) < 0.0);
        if across(|p| p.x - p.y) {
            Some(if a.x + a.y > 0.0 {
                SymmetryLine::Start
            } else {
                SymmetryLine::Other
            })
        } else if across(|p| p.x + p.y) {
            Some(if a.y - a.x > 0.0 {
                SymmetryLine::End
            } else {
                SymmetryLine::Other
            })
        } else {
            None
        }
    });
    // Twice around, since a closed curve may begin anywhere.
    let crossed: Vec<SymmetryLine> = crossed.collect();
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
        .any(|pair| {
            matches!(
                pair,
                (SymmetryLine::Start, SymmetryLine::End) | (SymmetryLine::End, SymmetryLine::Start)
            )
        })
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
