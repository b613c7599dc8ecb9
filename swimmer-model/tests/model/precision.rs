//! Results in f32, as on the chip, are within 1e-4 of f64.

use crate::random::{cases, harmonics, shape, swimmer};
use nalgebra::Vector2;
use proptest::prelude::*;
use swimmer_model::{
    Circle, Fourier, Gait, Harmonic, Model, Scalar, Square, Swimmer, Tolerance, swim,
};

const ALLOWED: f64 = 1e-4;

fn narrow(v: Vector2<f64>) -> Vector2<f32> {
    v.map(Scalar::from_f64)
}

/// Swims in both precisions and compares.
fn compare(
    swimmer: &Swimmer<f64>,
    gait: &impl Gait<f64>,
    gait32: &impl Gait<f32>,
) -> Result<(), TestCaseError> {
    let tolerance = Tolerance::default();
    let wide = swim(&Model::new(swimmer).unwrap(), gait, &tolerance);
    let narrow = swim(
        &Model::new(&swimmer.cast::<f32>()).unwrap(),
        gait32,
        &tolerance,
    );
    let length = wide.total_length;
    let pairs = [
        (
            "X/L",
            wide.displacement.x,
            f64::from(narrow.displacement.x),
            length,
        ),
        (
            "Y/L",
            wide.displacement.y,
            f64::from(narrow.displacement.y),
            length,
        ),
        ("rotation", wide.rotation, f64::from(narrow.rotation), 1.0),
        ("delta y", wide.delta_y, f64::from(narrow.delta_y), length),
        (
            "delta theta",
            wide.delta_theta,
            f64::from(narrow.delta_theta),
            1.0,
        ),
        (
            "power length",
            wide.power_length,
            f64::from(narrow.power_length),
            wide.power_length,
        ),
        ("energy", wide.energy, f64::from(narrow.energy), wide.energy),
        (
            "efficiency",
            wide.efficiency(),
            f64::from(narrow.efficiency()),
            1.0,
        ),
    ];
    for (what, wide, narrow, scale) in pairs {
        prop_assert!(
            (wide - narrow).abs() < ALLOWED * scale,
            "{what}: {wide} in f64, {narrow} in f32"
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn shapes_in_f32(swimmer in swimmer(), phi in shape()) {
        let (a, w) = Model::new(&swimmer).unwrap().connection_and_power(&phi);
        let (a32, w32) = Model::new(&swimmer.cast::<f32>()).unwrap().connection_and_power(&narrow(phi));
        let length = swimmer.total_length();
        for column in 0..2 {
            for (row, unit) in [length, length, 1.0].into_iter().enumerate() {
                let error = (a[(row, column)] - f64::from(a32[(row, column)])).abs() / unit;
                prop_assert!(error < ALLOWED, "A, row {row}, column {column}: {error:e}");
            }
        }
        for row in 0..2 {
            for column in 0..2 {
                let error = (w[(row, column)] - f64::from(w32[(row, column)])).abs() / (w[(row, row)] * w[(column, column)]).sqrt();
                prop_assert!(error < ALLOWED, "W{row}{column}: {error:e}");
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(100))]

    #[test]
    fn strokes_in_f32(swimmer in swimmer(), amplitude in 0.2..3.5, harmonics in harmonics()) {
        let amplitude32 = f32::from_f64(amplitude);
        compare(&swimmer, &Circle { amplitude }, &Circle { amplitude: amplitude32 })?;
        compare(&swimmer, &Square { amplitude }, &Square { amplitude: amplitude32 })?;
        let harmonics32 = harmonics.map(|h| Harmonic { cos: narrow(h.cos), sin: narrow(h.sin) });
        let still = Vector2::zeros();
        compare(
            &swimmer,
            &Fourier { mean: still, harmonics },
            &Fourier { mean: narrow(still), harmonics: harmonics32 },
        )?;
    }
}

#[test]
fn the_robots_circle_in_f32() {
    for amplitude in [0.5_f32, 1.2, 1.9] {
        let circle = Circle {
            amplitude: f64::from(amplitude),
        };
        compare(&Swimmer::robot(), &circle, &Circle { amplitude }).unwrap();
    }
}
