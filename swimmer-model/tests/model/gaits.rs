//! Gaits: rates are derivatives, curves close, samples interpolate to fourth order and respect corners.

use crate::hyper_dual::HyperDual;
use crate::near;
use crate::random::{cases, harmonics, shape};
use nalgebra::Vector2;
use proptest::prelude::*;
use swimmer_model::{
    Circle, Fourier, Gait, Harmonic, InvalidSamples, Reversed, Sampled, Scalar, Square,
    SymmetricFourier,
};

/// Compares dΦ/du of the gait in hyper-dual numbers with its own rate.
fn rate_is_the_derivative(gait: &impl Gait<HyperDual>, u: f64) -> Result<(), TestCaseError> {
    let point = gait.at(HyperDual::new(u, 1.0, 0.0));
    for i in 0..2 {
        let (rate, expected) = (point.rate[i].value, point.phi[i].d1);
        prop_assert!(
            (rate - expected).abs() < 1e-11 * (1.0 + expected.abs()),
            "{rate} {expected}"
        );
    }
    Ok(())
}

fn dual(v: Vector2<f64>) -> Vector2<HyperDual> {
    v.map(HyperDual::from_f64)
}

/// A smooth test curve.
fn curve(u: f64) -> Vector2<f64> {
    let harmonics = [
        Harmonic {
            cos: Vector2::new(1.1, 0.2),
            sin: Vector2::new(-0.3, 0.9),
        },
        Harmonic {
            cos: Vector2::new(0.1, -0.2),
            sin: Vector2::new(0.2, 0.1),
        },
    ];
    Fourier {
        mean: Vector2::new(0.1, -0.2),
        harmonics,
    }
    .at(u)
    .phi
}

/// Unevenly spaced places in [0, 1).
fn uneven(count: u32) -> Vec<f64> {
    let place = |i: u32| f64::from(i) / f64::from(count);
    (0..count)
        .map(|i| place(i) + 0.06 * (1.0 - f64::cos(std::f64::consts::TAU * place(i))))
        .collect()
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn rates_are_derivatives(u in 0.0..1.0, amplitude in 0.1..4.0, mean in shape(), harmonics in harmonics()) {
        let amplitude = HyperDual::from_f64(amplitude);
        rate_is_the_derivative(&Circle { amplitude }, u)?;
        rate_is_the_derivative(&Square { amplitude }, u)?;
        rate_is_the_derivative(&Reversed(Circle { amplitude }), u)?;
        let harmonics = harmonics.map(|h| Harmonic { cos: dual(h.cos), sin: dual(h.sin) });
        rate_is_the_derivative(&Fourier { mean: dual(mean), harmonics }, u)?;
        let coefficients = harmonics.map(|h| [h.cos.x, h.sin.y]);
        rate_is_the_derivative(&SymmetricFourier { coefficients }, u)?;
        let knots: Vec<HyperDual> = uneven(9).into_iter().map(HyperDual::from_f64).collect();
        let phi: Vec<_> = uneven(9).into_iter().map(|u| dual(curve(u))).collect();
        rate_is_the_derivative(&Sampled::new(&knots, &phi, &[2, 5]).unwrap(), u)?;
    }

    #[test]
    fn any_u_is_taken_modulo_one(u in 0.0..1.0, turns in -3_i32..3, amplitude in 0.1..3.0) {
        let shifted = u + f64::from(turns);
        let (a, b) = (Circle { amplitude }.at(u), Circle { amplitude }.at(shifted));
        prop_assert!((a.phi - b.phi).amax() < 1e-13);
        let knots = uneven(7);
        let phi: Vec<_> = knots.iter().map(|&u| curve(u)).collect();
        let gait = Sampled::new(&knots, &phi, &[]).unwrap();
        prop_assert!((gait.at(u).phi - gait.at(shifted).phi).amax() < 1e-12);
    }

    #[test]
    fn samples_reproduce_quartics_slopes_between_corners(
        c in prop::array::uniform5(-1.0..1.0), corner in 6_usize..10, u in 0.0..1.0,
    ) {
        // One quartic to each side of a corner, meeting at both joints; slopes at knots must be exact, so that the
        // interpolant is the Hermite cubic of the quartic itself.
        let knots = uneven(14);
        let border = knots[corner];
        let quartic = |t: f64| t * (t - border) * (c[0] + c[1] * t + c[2] * t * t);
        let slope = |t: f64| {
            let (p, q) = (t * (t - border), c[0] + c[1] * t + c[2] * t * t);
            (2.0 * t - border) * q + p * (c[1] + 2.0 * c[2] * t)
        };
        let other = |t: f64| (t - border) * (1.0 - t) * (c[3] + c[4] * t);
        let phi: Vec<_> = knots
            .iter()
            .map(|&t| Vector2::new(if t <= border { quartic(t) } else { other(t) }, 0.0))
            .collect();
        let corners = [0, corner];
        let gait = Sampled::new(&knots, &phi, &corners).unwrap();
        for (i, &t) in knots.iter().enumerate().take(corner) {
            near("slope", gait.at(t).rate.x, slope(t), 1e-11);
            near("value", gait.at(t).phi.x, phi[i].x, 1e-15);
        }
        let left = knots.iter().rposition(|&knot| knot <= u).unwrap();
        prop_assert_eq!(gait.corner_at_end(left), left + 1 == corner || left + 1 == knots.len());
    }
}

#[test]
fn circles_and_squares_start_on_the_diagonal_and_run_counter_clockwise() {
    let (circle, square) = (Circle { amplitude: 1.3 }, Square { amplitude: 1.3 });
    let start = circle.at(0.0);
    near("phi1 = phi2", start.phi.x, start.phi.y, 0.0);
    near("radius", start.phi.norm(), 1.3, 1e-15);
    assert!(start.phi.x > 0.0 && start.rate.y > 0.0 && start.rate.x < 0.0);
    let corners = [(1.3, 1.3), (-1.3, 1.3), (-1.3, -1.3), (1.3, -1.3)];
    for (u, (x, y)) in [0.0, 0.25, 0.5, 0.75].into_iter().zip(corners) {
        assert_eq!(square.at(u).phi, Vector2::new(x, y));
        near("speed", square.at(u + 0.1).speed(), 8.0 * 1.3, 0.0);
    }
    // Twice the enclosed area is the integral of φ₁ dφ₂ − φ₂ dφ₁, positive counter-clockwise.
    for u in (0..100).map(|i| f64::from(i) / 100.0) {
        for point in [circle.at(u), square.at(u)] {
            assert!(point.phi.x * point.rate.y - point.phi.y * point.rate.x > 0.0);
        }
    }
}

#[test]
fn the_symmetric_series_holds_the_circle() {
    let series = SymmetricFourier {
        coefficients: [[0.9, 0.9]],
    };
    for u in (0..50).map(|i| f64::from(i) / 50.0) {
        let (a, b) = (series.at(u), Circle { amplitude: 0.9 }.at(u));
        assert!((a.phi - b.phi).amax() < 1e-15 && (a.rate - b.rate).amax() < 1e-14);
    }
}

#[test]
fn reversed_corners_are_mirrored() {
    let reversed = Reversed(Square { amplitude: 1.0_f64 });
    assert_eq!(
        [0, 1, 2, 3].map(|i| reversed.piece_end(i)),
        [0.25, 0.5, 0.75, 1.0]
    );
    let knots = [0.0, 0.1, 0.4, 0.8];
    let phi = knots.map(curve);
    let gait = Sampled::new(&knots, &phi, &[1]).unwrap();
    let reversed = Reversed(gait);
    let ends: Vec<f64> = (0..4).map(|i| reversed.piece_end(i)).collect();
    for (end, expected) in ends.iter().zip([0.2, 0.6, 0.9, 1.0]) {
        near("piece end", *end, expected, 1e-15);
    }
    assert_eq!(
        [0, 1, 2, 3].map(|i| gait.corner_at_end(i)),
        [true, false, false, false]
    );
    assert_eq!(
        [0, 1, 2, 3].map(|i| reversed.corner_at_end(i)),
        [false, false, true, false]
    );
}

#[test]
fn samples_converge_with_the_fourth_order() {
    let error = |count: u32| {
        let knots = uneven(count);
        let phi: Vec<_> = knots.iter().map(|&u| curve(u)).collect();
        let gait = Sampled::new(&knots, &phi, &[]).unwrap();
        (0..4001)
            .map(|i| f64::from(i) / 4001.0)
            .map(|u| (gait.at(u).phi - curve(u)).amax())
            .fold(0.0, f64::max)
    };
    let (coarse, fine) = (error(100), error(200));
    println!("error {coarse:.3e} with 100 samples, {fine:.3e} with 200");
    assert!(coarse / fine > 14.0 && fine < 1e-6, "{coarse:e} {fine:e}");
}

#[test]
fn samples_close_exactly_and_smoothly() {
    let knots = uneven(16);
    let phi: Vec<_> = knots.iter().map(|&u| curve(u)).collect();
    let gait = Sampled::new(&knots, &phi, &[]).unwrap();
    assert_eq!(gait.at(1.0), gait.at(0.0));
    assert_eq!(gait.at(0.0).phi, phi[0]);
    for &knot in &knots {
        let (left, right) = (gait.at(knot - 1e-12), gait.at(knot));
        assert!((left.phi - right.phi).amax() < 1e-10 && (left.rate - right.rate).amax() < 1e-9);
    }
}

#[test]
fn a_sampled_square_is_the_square() {
    let square = Square { amplitude: 1.2 };
    let knots: Vec<f64> = (0..16).map(|i| f64::from(i) / 16.0).collect();
    let phi: Vec<_> = knots.iter().map(|&u| square.at(u).phi).collect();
    let gait = Sampled::new(&knots, &phi, &[0, 4, 8, 12]).unwrap();
    for u in (0..997).map(|i| (f64::from(i) + 0.5) / 997.0) {
        let (a, b) = (gait.at(u), square.at(u));
        assert!(
            (a.phi - b.phi).amax() < 1e-14 && (a.rate - b.rate).amax() < 1e-12,
            "{u}: {a:?} {b:?}"
        );
    }
}

#[test]
fn a_repeated_last_knot_is_left_out() {
    let phi = [
        Vector2::new(1.0, 0.0),
        Vector2::new(0.0, 1.0),
        Vector2::new(-1.0, 0.0),
        Vector2::new(1.0, 0.0),
    ];
    let gait = Sampled::new(&[0.0, 0.3, 0.6, 1.0], &phi, &[]).unwrap();
    assert_eq!(gait.knots(), 3);
    assert_eq!(
        gait,
        Sampled::new(&[0.0, 0.3, 0.6], &phi[..3], &[]).unwrap()
    );
}

#[test]
fn samples_that_are_no_gait_are_refused() {
    let v = |x: f64| Vector2::new(x, 0.0);
    let three = [v(0.0), v(1.0), v(2.0)];
    let refused = |u: &[f64], phi: &[Vector2<f64>], corners: &[usize]| {
        Sampled::new(u, phi, corners).unwrap_err()
    };
    assert_eq!(refused(&[], &[], &[]), InvalidSamples::TooFew { knots: 0 });
    assert_eq!(
        refused(&[0.0], &three[..1], &[]),
        InvalidSamples::TooFew { knots: 1 }
    );
    assert_eq!(
        refused(&[0.0, 1.0], &[v(1.0), v(1.0)], &[]),
        InvalidSamples::TooFew { knots: 1 }
    );
    assert_eq!(
        refused(&[0.0, 0.5], &three, &[]),
        InvalidSamples::Lengths { u: 2, phi: 3 }
    );
    assert_eq!(
        refused(&[0.1, 0.5, 0.7], &three, &[]),
        InvalidSamples::Start { u: 0.1 }
    );
    assert_eq!(
        refused(&[0.0, 0.5, 0.5], &three, &[]),
        InvalidSamples::Order { knot: 2, u: 0.5 }
    );
    assert!(matches!(
        refused(&[0.0, f64::NAN, 0.5], &three, &[]),
        InvalidSamples::Order { knot: 1, .. }
    ));
    assert_eq!(
        refused(&[0.0, 0.5, 1.5], &three, &[]),
        InvalidSamples::Order { knot: 2, u: 1.5 }
    );
    assert_eq!(
        refused(&[0.0, 0.5, 1.0], &three, &[]),
        InvalidSamples::Open { gap: 2.0 }
    );
    let broken = [v(0.0), v(f64::INFINITY), v(2.0)];
    assert_eq!(
        refused(&[0.0, 0.5, 0.7], &broken, &[]),
        InvalidSamples::Angle { knot: 1 }
    );
    assert_eq!(
        refused(&[0.0, 0.5, 0.7], &three, &[3]),
        InvalidSamples::Corner { corner: 3 }
    );
    assert_eq!(
        refused(&[0.0, 0.5, 0.7], &three, &[1, 1]),
        InvalidSamples::Corner { corner: 1 }
    );
    let message = refused(&[0.0, 0.5, 0.5], &three, &[]).to_string();
    assert!(
        message.contains("knot 2") && message.contains("0.5"),
        "{message}"
    );
}
