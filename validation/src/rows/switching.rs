//! Rows of section IV.A: the switching function F = F₁ λ₃ + F₂ λ₄ and its rate of change Ḟ = (A u₁ + B u₂) λ₃, as printed.

use nalgebra::{Matrix3x2, Vector2, Vector3};
use swimmer_model::{FirstDerivatives, Model, SecondDerivatives};

use super::computed::Computed;
use crate::study::Study;

/// Values of F₁, F₂, A and B.
type Forms = [f64; 4];

/// Largest deviations of the printed formulas from the curvature of the connection and its derivatives, over the largest value.
pub(super) fn switching_function(study: &Study) -> Vec<Computed> {
    let shapes = || {
        let angles = || (-12..=12).map(|i| 0.21 * f64::from(i));
        let pairs = angles().flat_map(move |a| angles().map(move |b| Vector2::new(a, b)));
        // F₂ vanishes on φ₁ = −φ₂, and A and B divide by it.
        pairs.filter(|phi| (phi.x + phi.y).abs() > 0.1)
    };
    let mut deviations = [0.0_f64; 4];
    for model in [&study.purcell, &study.robot] {
        let (mut largest, mut off) = ([0.0_f64; 4], [0.0_f64; 4]);
        for phi in shapes() {
            for theta in [-1.1, 0.0, 0.7] {
                let (printed, computed) = both(model, &phi, theta);
                for form in 0..4 {
                    largest[form] = largest[form].max(computed[form].abs());
                    // NaN must not pass.
                    let deviation = (printed[form] - computed[form]).abs();
                    off[form] = if deviation > off[form] || deviation.is_nan() {
                        deviation
                    } else {
                        off[form]
                    };
                }
            }
        }
        for form in 0..4 {
            deviations[form] = deviations[form].max(off[form] / largest[form]);
        }
    }
    let [f1, f2, a, b] = deviations;
    vec![
        ("switching.f1", f1),
        ("switching.f2", f2),
        ("switching.a", a),
        ("switching.b", b),
    ]
}

/// The printed and the computed forms at a shape and heading.
fn both(model: &Model<f64>, phi: &Vector2<f64>, theta: f64) -> (Forms, Forms) {
    // The model has its swimmer's size; lengths scale both sides alike.
    let second = model.second_derivatives(phi);
    (printed(&second, theta), computed(&second, theta))
}

/// The paper's formulas: ẋ = g u₁ + h u₂, θ̇ = f u₁ + q u₂; `g_12` is ∂²g/∂φ₁∂φ₂, and `t` stands for θ.
fn printed(second: &SecondDerivatives<f64>, theta: f64) -> Forms {
    let (sin, cos) = theta.sin_cos();
    let row = |m: &Matrix3x2<f64>, column: usize| cos * m[(0, column)] - sin * m[(1, column)];
    let turned = |m: &Matrix3x2<f64>, column: usize| -sin * m[(0, column)] - cos * m[(1, column)];
    let SecondDerivatives {
        first:
            FirstDerivatives {
                connection,
                d_connection: [d1, d2],
                ..
            },
        d2_connection: [d11, d12, d22],
        ..
    } = second;
    let (f, q) = (connection[(2, 0)], connection[(2, 1)]);
    let (f_1, f_2, q_1, q_2) = (d1[(2, 0)], d2[(2, 0)], d1[(2, 1)], d2[(2, 1)]);
    let (q_11, q_12) = (d11[(2, 1)], d12[(2, 1)]);
    let (f_12, f_22) = (d12[(2, 0)], d22[(2, 0)]);
    let (g_t, h_t) = (turned(connection, 0), turned(connection, 1));
    let (g_tt, h_tt) = (-row(connection, 0), -row(connection, 1));
    let (g_2, h_1) = (row(d2, 0), row(d1, 1));
    let (g_1t, g_2t) = (turned(d1, 0), turned(d2, 0));
    let (h_1t, h_2t) = (turned(d1, 1), turned(d2, 1));
    let (g_12, g_22) = (row(d12, 0), row(d22, 0));
    let (h_11, h_12) = (row(d11, 1), row(d12, 1));
    let f1 = g_2 + g_t * q - h_1 - h_t * f;
    let f2 = f_2 - q_1;
    let ratio = f1 / f2;
    let a = (q_11 - f_12) * ratio
        + (2.0 * q_1 - f_2) * g_t
        + (g_2t + g_tt * q - h_1t - h_1t) * f
        + g_12
        + g_1t * q
        - h_tt * f * f
        - h_t * f_1
        - h_11;
    let b = (q_12 - f_22) * ratio
        + (q_1 - 2.0 * f_2) * h_t
        + (g_2t - h_tt * f + g_2t - h_1t) * q
        + g_22
        - h_2t * f
        + g_tt * q * q
        + g_t * q_2
        - h_12;
    [f1, f2, a, b]
}

/// From the curvature C = dA + \[A₁, A₂\] in the frame of the middle link: F is −μ · C with the momentum μ = (λ₃ cos θ, −λ₃ sin θ, λ₄), and
/// its rate follows the shape, the heading and λ̇₄ = λ₃ ẏ.
fn computed(second: &SecondDerivatives<f64>, theta: f64) -> Forms {
    let (sin, cos) = theta.sin_cos();
    let curvature = second.first.curvature();
    let along = |c: &Vector3<f64>| -(cos * c.x - sin * c.y);
    let (f1, f2) = (along(&curvature), -curvature.z);
    let lambda_4 = -f1 / f2;
    let of_heading = sin * curvature.x + cos * curvature.y;
    let rate = |joint: usize| {
        let slope = second.d_curvature()[joint];
        let velocity = second.first.connection.column(joint);
        let y_rate = sin * velocity.x + cos * velocity.y;
        along(&slope) + of_heading * velocity.z - lambda_4 * slope.z + f2 * y_rate
    };
    [f1, f2, rate(0), rate(1)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_model::Swimmer;

    /// The computed forms by differences of the connection alone.
    #[test]
    fn forms_follow_from_the_connection() {
        let model = Model::new(&Swimmer::robot()).unwrap();
        let (phi, theta, step) = (Vector2::new(1.1, 0.4), 0.3_f64, 1e-5);
        let x_row = |phi: Vector2<f64>, theta: f64| {
            let a = model.local_connection(&phi);
            let (sin, cos) = theta.sin_cos();
            [0, 1].map(|j| cos * a[(0, j)] - sin * a[(1, j)])
        };
        let slope = |toward: Vector2<f64>, turn: f64, column: usize| {
            let at = |s: f64| x_row(phi + toward * s, theta + turn * s)[column];
            (at(step) - at(-step)) / (2.0 * step)
        };
        let a = model.local_connection(&phi);
        let f1 = slope(Vector2::y(), a[(2, 1)], 0) - slope(Vector2::x(), a[(2, 0)], 1);
        let forms = computed(&model.second_derivatives(&phi), theta);
        assert!((forms[0] - f1).abs() < 1e-9, "{forms:?} {f1}");
    }
}
