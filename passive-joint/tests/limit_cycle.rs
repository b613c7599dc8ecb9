//! Limit cycles against published digits, small-stroke asymptotics and an integration in time that starts from rest.

use std::f64::consts::{PI, TAU};

use link_protocol::Joint;
use nalgebra::{Vector2, Vector4};
use passive_joint::{CycleValues, LimitCycle, PassiveError, PassiveJoint, Waveform};
use proptest::prelude::*;
use swimmer_model::{Gait as _, Model, Square, Swimmer, Tolerance, swim};

fn purcell() -> Model<f64> {
    Model::new(&Swimmer::purcell()).unwrap()
}

fn displacement(model: &Model<f64>, joint: Joint, kappa: f64, amplitude: f64) -> f64 {
    let passive = PassiveJoint::new(joint, kappa).unwrap();
    let drive = Waveform::sine(amplitude).driving(passive.driven());
    let cycle = LimitCycle::new(model, &drive, passive).unwrap();
    swim(model, &cycle, &Tolerance::default())
        .displacement
        .norm()
}

/// Steps of the reference integration, per cycle.
const REFERENCE_STEPS: u32 = 4000;

/// Displacement of one cycle and the passive angle at its start, after a number of cycles from rest: classical Runge–Kutta on
/// `(φ_p, x, y, θ)`, from A and W alone.
fn reference(
    model: &Model<f64>,
    joint: Joint,
    kappa: f64,
    waveform: &Waveform,
    cycles: u32,
) -> (f64, f64) {
    let p = usize::from(joint == Joint::Back);
    let d = 1 - p;
    let shape = |driven: f64, passive: f64| {
        let mut shape = Vector2::zeros();
        shape[d] = driven;
        shape[p] = passive;
        shape
    };
    let rate = |u: f64, state: Vector4<f64>| {
        let [driven, driven_rate] = waveform.at(u);
        let phi = shape(driven, state[0]);
        let power = model.power_matrix(&phi);
        let passive_rate = -(kappa * state[0] + power[(p, d)] * driven_rate) / power[(p, p)];
        let body = model.local_connection(&phi) * shape(driven_rate, passive_rate);
        let (sin, cos) = state[3].sin_cos();
        Vector4::new(
            passive_rate,
            cos * body.x - sin * body.y,
            sin * body.x + cos * body.y,
            body.z,
        )
    };
    let h = 1.0 / f64::from(REFERENCE_STEPS);
    let (mut state, mut start) = (Vector4::zeros(), Vector4::zeros());
    for _ in 0..cycles {
        start = state;
        for step in 0..REFERENCE_STEPS {
            let u = f64::from(step) * h;
            let one = rate(u, state);
            let two = rate(u + 0.5 * h, state + one * (0.5 * h));
            let three = rate(u + 0.5 * h, state + two * (0.5 * h));
            let four = rate(u + h, state + three * h);
            state += (one + two * 2.0 + three * 2.0 + four) * (h / 6.0);
        }
    }
    let moved = state - start;
    (moved.y.hypot(moved.z), start.x)
}

#[test]
fn limit_cycles_have_the_digits_of_an_independent_model() {
    let model = purcell();
    for (amplitude, kappa, over_length) in [
        (1.0, 1.0, 0.017_478_6),
        (1.0, 2.0, 0.017_004_6),
        (0.5, 1.2411, 0.005_280_0),
    ] {
        let found = displacement(&model, Joint::Back, kappa, amplitude) / 3.0;
        assert!(
            (found - over_length).abs() < 6e-8,
            "{amplitude} {kappa}: {found}"
        );
    }
    let drive = Waveform::sine(1.0).driving(Joint::Front);
    let passive = PassiveJoint::new(Joint::Back, 1.0).unwrap();
    let cycle = LimitCycle::new(&model, &drive, passive).unwrap();
    assert!(
        (cycle.start() + 0.372_584).abs() < 6e-7,
        "{}",
        cycle.start()
    );
}

/// Frequency ω = 2π/κ (in units of `k/(c_t l³)`) of greatest displacement per cycle, and that displacement: a root of the derivative
/// with respect to κ, by bisection.
fn best_frequency(model: &Model<f64>, amplitude: f64) -> (f64, f64) {
    let values = |omega: f64| {
        let passive = PassiveJoint::new(Joint::Back, TAU / omega).unwrap();
        CycleValues::new(model, &Waveform::sine(amplitude), &passive).unwrap()
    };
    let (mut low, mut high) = (2.0, 8.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        // The displacement still grows with κ where the frequency is above the best one.
        if values(middle).d_displacement[1] > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    (low, values(low).displacement)
}

/// The root of the adjoint derivative against the vertex of a parabola through three integrations in time.
#[test]
fn the_best_frequency_falls_with_the_stroke() {
    let model = purcell();
    for (amplitude, omega, over_square) in [
        (0.5, 4.9575, 0.021_124_5),
        (1.0, 4.6333, 0.018_275_7),
        (1.5, 4.1285, 0.014_680_0),
    ] {
        let (best, most) = best_frequency(&model, amplitude);
        let x = |omega: f64| {
            reference(
                &model,
                Joint::Back,
                TAU / omega,
                &Waveform::sine(amplitude),
                8,
            )
            .0
        };
        let step = 0.1;
        let [below, here, above] = [best - step, best, best + step].map(x);
        let vertex = best + 0.5 * step * (above - below) / (2.0 * here - above - below);
        // The parabola errs by the third derivative times step².
        assert!(
            (vertex - best).abs() < 1.5e-3,
            "{amplitude}: {best} and {vertex}"
        );
        assert!(
            (most / here - 1.0).abs() < 1e-8,
            "{amplitude}: {most} and {here}"
        );
        assert!((best - omega).abs() < 6e-5, "{amplitude}: {best}");
        let most = most / (3.0 * amplitude * amplitude);
        assert!((most - over_square).abs() < 6e-8, "{amplitude}: {most}");
    }
}

/// To leading order ω* = 81/16 and X* = 55π/2592 ε², with corrections of relative order ε².
#[test]
fn small_strokes_follow_the_asymptotics() {
    let model = purcell();
    let errors = [0.04, 0.02].map(|stroke: f64| {
        let (best, most) = best_frequency(&model, stroke);
        [
            best - 81.0 / 16.0,
            most / (55.0 * PI / 2592.0 * stroke * stroke) - 1.0,
        ]
    });
    for (coarse, fine) in errors[0].into_iter().zip(errors[1]) {
        assert!(coarse.abs() < 2e-3, "{errors:?}");
        assert!((coarse / fine - 4.0).abs() < 0.01, "{errors:?}");
    }
}

#[test]
fn an_integration_from_rest_arrives_at_the_limit_cycle() {
    let robot = Model::new(&Swimmer::robot()).unwrap();
    let scale = |model: &Model<f64>, joint: Joint| {
        model.power_matrix(&Vector2::zeros())[(joint.index(), joint.index())]
    };
    let wave = Waveform::new(vec![0.9, -0.15, 0.1]);
    for (model, joint, share, waveform) in [
        (&purcell(), Joint::Back, 1.0 / TAU, &Waveform::sine(1.0)),
        (&purcell(), Joint::Front, 0.4, &wave),
        (&robot, Joint::Back, 0.1, &Waveform::sine(1.4)),
        (&robot, Joint::Front, 0.3, &wave),
    ] {
        let kappa = scale(model, joint) / share;
        let passive = PassiveJoint::relaxing_in(model, joint, share).unwrap();
        let drive = waveform.driving(passive.driven());
        let cycle = LimitCycle::new(model, &drive, passive).unwrap();
        let stroke = swim(model, &cycle, &Tolerance::default());
        let (displacement, start) = reference(model, joint, kappa, waveform, 40);
        assert!((cycle.start() - start).abs() < 1e-10, "{joint:?} {share}");
        assert!((stroke.displacement.norm() / displacement - 1.0).abs() < 1e-8);
        assert!(stroke.rotation.abs() < 1e-10);
        let values = CycleValues::new(model, waveform, &passive).unwrap();
        assert!((values.displacement / displacement - 1.0).abs() < 1e-8);
        assert!((values.energy / stroke.energy - 1.0).abs() < 1e-8);
        // A small disturbance falls by the multiplier.
        let moved = reference(model, joint, kappa, waveform, 2).1;
        let from_rest = (moved - start) / (0.0 - start);
        let ratio = from_rest / cycle.multiplier();
        assert!(
            cycle.multiplier() < 1.0 && (0.5..2.0).contains(&ratio),
            "{ratio}"
        );
    }
}

#[test]
fn a_drive_with_corners_is_followed_piece_by_piece() {
    let model = purcell();
    let drive = Square { amplitude: 0.8 };
    let passive = PassiveJoint::new(Joint::Back, 1.0).unwrap();
    let cycle = LimitCycle::new(&model, &drive, passive).unwrap();
    let rate = |u: f64| (cycle.at(u + 1e-6).phi - cycle.at(u - 1e-6).phi) / 2e-6;
    for u in [0.05, 0.2, 0.33, 0.61, 0.97] {
        assert!((rate(u) - cycle.at(u).rate).norm() < 1e-6, "{u}");
        assert!((cycle.at(u).phi.x - drive.at(u).phi.x).abs() < 1e-15);
    }
    let [before, after] = [1.0 - 1e-12, 0.0].map(|u| cycle.at(u).phi);
    assert!((before - after).norm() < 1e-10);
}

#[test]
fn a_stiff_spring_keeps_the_joint_straight_and_a_soft_one_lets_it_drift() {
    let model = purcell();
    let drive = Waveform::sine(1.0).driving(Joint::Front);
    let swing = |kappa: f64| {
        let passive = PassiveJoint::new(Joint::Back, kappa).unwrap();
        let cycle = LimitCycle::new(&model, &drive, passive).unwrap();
        (0..100)
            .map(|k| cycle.at(f64::from(k) / 100.0).phi.y.abs())
            .fold(0.0, f64::max)
    };
    // φ_p → −W_pd φ_d′/κ.
    assert!(swing(1e6) < 2e-6);
    assert!((swing(1e6) / swing(2e6) - 2.0).abs() < 1e-3);
    assert!(swing(1e-3) > 0.3);
}

#[test]
fn nonsense_is_refused() {
    for kappa in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            PassiveJoint::new(Joint::Back, kappa),
            Err(PassiveError::Spring { .. })
        ));
    }
    let model = purcell();
    let drive = Waveform::sine(f64::NAN).driving(Joint::Front);
    let passive = PassiveJoint::new(Joint::Back, 1.0).unwrap();
    assert!(matches!(
        LimitCycle::new(&model, &drive, passive),
        Err(PassiveError::NotConverged { .. })
    ));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]
    /// Any stroke and spring end within a bounded number of steps, in a cycle that closes or in an error.
    #[test]
    fn every_stroke_ends(amplitude in 0.01_f64..6.0, log_kappa in -6.0_f64..6.0, front in any::<bool>()) {
        let model = purcell();
        let joint = if front { Joint::Front } else { Joint::Back };
        let passive = PassiveJoint::new(joint, log_kappa.exp()).unwrap();
        let drive = Waveform::sine(amplitude).driving(passive.driven());
        if let Ok(cycle) = LimitCycle::new(&model, &drive, passive) {
            let [end, start] = [1.0 - 1e-13, 0.0].map(|u| cycle.at(u).phi);
            prop_assert!((end - start).norm() < 1e-8);
            prop_assert!(cycle.multiplier().abs() < 1.0);
        }
    }
}
