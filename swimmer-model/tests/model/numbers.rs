//! The numbers of the paper's conventions, to their last digit.

use crate::near;
use nalgebra::Vector2;
use swimmer_model::reference::{
    BEST_CIRCLE, BEST_SQUARE, BestAmplitude, SECOND_CIRCLE, SHAPES, SHAPES_TOLERANCE,
};
use swimmer_model::{Circle, Gait, Model, Square, Swimmer, Tolerance, swim};

fn purcell() -> Model<f64> {
    Model::new(&Swimmer::purcell()).unwrap()
}

#[test]
fn connection_and_power_of_purcells_swimmer() {
    let model = purcell();
    for case in &SHAPES {
        let (a, w) = model.connection_and_power(&Vector2::from(case.phi));
        for row in 0..3 {
            for column in 0..2 {
                near(
                    "A",
                    a[(row, column)],
                    case.connection[row][column],
                    SHAPES_TOLERANCE,
                );
            }
        }
        near("W11", w.m11, case.power[0], SHAPES_TOLERANCE);
        near("W12", w.m12, case.power[1], SHAPES_TOLERANCE);
        near("W21", w.m21, case.power[1], SHAPES_TOLERANCE);
        near("W22", w.m22, case.power[2], SHAPES_TOLERANCE);
    }
}

fn displacement<G: Gait<f64>>(gait: impl Fn(f64) -> G, amplitude: f64) -> f64 {
    let stroke = swim(&purcell(), &gait(amplitude), &Tolerance::default());
    stroke.displacement_over_length().x
}

/// The amplitude near `guess` where X/L is stationary, by bisection of a central difference.
fn stationary<G: Gait<f64>>(gait: impl Fn(f64) -> G + Copy, guess: f64) -> f64 {
    let step = 1e-4;
    let slope = |a: f64| displacement(gait, a + step) - displacement(gait, a - step);
    let (mut low, mut high) = (guess - 0.05, guess + 0.05);
    let sign = slope(low);
    while high - low > 1e-10 {
        let middle = f64::midpoint(low, high);
        if slope(middle) * sign > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    f64::midpoint(low, high)
}

fn check<G: Gait<f64>>(name: &str, gait: impl Fn(f64) -> G + Copy, best: &BestAmplitude) {
    let x = displacement(gait, best.amplitude);
    println!("{name}: X/L({}) = {x:.13}", best.amplitude);
    near(
        name,
        x,
        best.displacement_over_length,
        best.displacement_tolerance,
    );
    let amplitude = stationary(gait, best.amplitude);
    println!("{name}: stationary at {amplitude:.9}");
    near(name, amplitude, best.amplitude, best.amplitude_tolerance);
}

#[test]
fn best_circles_and_square_of_purcells_swimmer() {
    check(
        "best circle",
        |amplitude| Circle { amplitude },
        &BEST_CIRCLE,
    );
    check(
        "second circle",
        |amplitude| Circle { amplitude },
        &SECOND_CIRCLE,
    );
    check(
        "best square",
        |amplitude| Square { amplitude },
        &BEST_SQUARE,
    );
}
