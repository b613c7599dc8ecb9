//! What the chip computes in f32 is within 1e-4 of f64.

use crate::random::{cases, harmonics, shape, swimmer};
use nalgebra::Vector2;
use proptest::prelude::*;
use swimmer_model::{
    Circle, Fourier, Harmonic, Model, Scalar, Square, Stroke, Swimmer, Tolerance, swim,
};

const ALLOWED: f64 = 1e-4;

fn narrow(v: Vector2<f64>) -> Vector2<f32> {
    v.map(Scalar::from_f64)
}

fn compare(wide: &Stroke<f64>, narrow: &Stroke<f32>) -> Result<(), TestCaseError> {
    let length = wide.total_length;
    let pairs = [
        (
            "X/L",
            wide.displacement.x / length,
            f64::from(narrow.displacement.x) / length,
        ),
        (
            "Y/L",
            wide.displacement.y / length,
            f64::from(narrow.displacement.y) / length,
        ),
        ("rotation", wide.rotation, f64::from(narrow.rotation)),
        (
            "delta y",
            wide.delta_y / length,
            f64::from(narrow.delta_y) / length,
        ),
        (
            "delta theta",
            wide.delta_theta,
            f64::from(narrow.delta_theta),
        ),
        ("energy", 1.0, f64::from(narrow.energy) / wide.energy),
        (
            "power length",
            1.0,
            f64::from(narrow.power_length) / wide.power_length,
        ),
        (
            "efficiency",
            wide.efficiency(),
            f64::from(narrow.efficiency()),
        ),
    ];
    for (what, wide, narrow) in pairs {
        prop_assert!(
            (wide - narrow).abs() < ALLOWED,
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
                let error = (w[(row, column)] - f64::from(w32[(row, column)])).abs() / w.trace();
                prop_assert!(error < ALLOWED, "W{row}{column}: {error:e}");
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(100))]

    #[test]
    fn strokes_in_f32(swimmer in swimmer(), amplitude in 0.2..3.5, harmonics in harmonics()) {
        let (wide, tolerance) = (Model::new(&swimmer).unwrap(), Tolerance::default());
        let single = Model::new(&swimmer.cast::<f32>()).unwrap();
        let amplitude32 = f32::from_f64(amplitude);
        compare(
            &swim(&wide, &Circle { amplitude }, &tolerance),
            &swim(&single, &Circle { amplitude: amplitude32 }, &tolerance),
        )?;
        compare(
            &swim(&wide, &Square { amplitude }, &tolerance),
            &swim(&single, &Square { amplitude: amplitude32 }, &tolerance),
        )?;
        let harmonics32 = harmonics.map(|h| Harmonic { cos: narrow(h.cos), sin: narrow(h.sin) });
        compare(
            &swim(&wide, &Fourier { mean: Vector2::zeros(), harmonics }, &tolerance),
            &swim(&single, &Fourier { mean: Vector2::zeros(), harmonics: harmonics32 }, &tolerance),
        )?;
    }
}

#[test]
fn the_robots_circle_in_f32() {
    let wide = Model::<f64>::new(&Swimmer::robot()).unwrap();
    let single = Model::<f32>::new(&Swimmer::robot()).unwrap();
    let tolerance = Tolerance::default();
    for amplitude in [0.5_f32, 1.2, 1.9] {
        let stroke = swim(
            &wide,
            &Circle {
                amplitude: f64::from(amplitude),
            },
            &tolerance,
        );
        compare(&stroke, &swim(&single, &Circle { amplitude }, &tolerance)).unwrap();
    }
}
