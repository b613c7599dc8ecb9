//! Tests of the height against finite differences and against the paper's switching function.

use super::arc::pose_rates;
use super::*;
use swimmer_model::Swimmer;

fn height(model: &Model<f64>, momentum: Momentum, phi: &Vector2<f64>, pose: &[f64; 3]) -> f64 {
    let curvature = model.first_derivatives(phi).curvature();
    momentum.at(pose).dot(&curvature)
}

/// The gradient is the change of the height along a short interval of the dynamics.
#[test]
fn the_gradient_is_the_derivative_along_each_joint() {
    let model = Model::new(&Swimmer::<f64>::purcell()).unwrap();
    let momentum = Momentum::of_quarter(-1.0, 0.13);
    let (phi, pose) = (Vector2::new(0.7, 1.9), [0.2, -0.1, 0.4]);
    let (there, ..) = momentum.evaluate(&model, &phi, &pose);
    assert!((there.value - height(&model, momentum, &phi, &pose)).abs() < 1e-15);
    for joint in 0..2 {
        let mut direction = Vector2::zeros();
        direction[joint] = 1.0;
        let moved = |h: f64| {
            // The midpoint rule and the central difference are both of second order.
            let half = |phi: &Vector2<f64>, pose: &[f64; 3], from: &[f64; 3], h: f64| {
                let (a, w) = model.connection_and_power(phi);
                let rates = pose_rates(&a, &w, pose[2], &direction);
                [
                    from[0] + h * rates[0],
                    from[1] + h * rates[1],
                    from[2] + h * rates[2],
                ]
            };
            let middle = half(&phi, &pose, &pose, h / 2.0);
            let end = half(&(phi + direction * (h / 2.0)), &middle, &pose, h);
            height(&model, momentum, &(phi + direction * h), &end)
        };
        let h = 1e-4;
        let numeric = (moved(h) - moved(-h)) / (2.0 * h);
        assert!(
            (numeric - there.gradient[joint]).abs() < 1e-7,
            "{numeric} {}",
            there.gradient[joint]
        );
    }
}

/// The height is minus the paper's F, expressed there in g, h, f, q with λ₃ = 1.
#[test]
fn the_height_is_minus_the_papers_switching_function() {
    let model = Model::new(&Swimmer::<f64>::robot()).unwrap();
    let momentum = Momentum::of_quarter(1.0, 0.03);
    let (phi, pose) = (Vector2::new(-0.4, 2.1), [0.0, 0.05, -0.6]);
    let d = model.first_derivatives(&phi);
    let (sin, cos) = f64::sin_cos(-0.6);
    let (a, [a1, a2]) = (d.connection, d.d_connection);
    let (f, q) = (a[(2, 0)], a[(2, 1)]);
    let g_theta = -sin * a[(0, 0)] - cos * a[(1, 0)];
    let h_theta = -sin * a[(0, 1)] - cos * a[(1, 1)];
    let g_2 = cos * a2[(0, 0)] - sin * a2[(1, 0)];
    let h_1 = cos * a1[(0, 1)] - sin * a1[(1, 1)];
    let f1 = g_2 + g_theta * q - h_1 - h_theta * f;
    let f2 = a2[(2, 0)] - a1[(2, 1)];
    let printed = f1 + f2 * (0.05 - 0.03);
    assert!(
        (height(&model, momentum, &phi, &pose) + printed).abs() < 1e-15 * (1.0 + printed.abs())
    );
}
