//! Closed-form derivatives against automatic differentiation.

use crate::hyper_dual::HyperDual;
use crate::random::{any_swimmer, cases, shape};
use nalgebra::{Matrix2, Matrix3x2, SMatrix, Vector2};
use proptest::prelude::*;
use swimmer_model::{Link, Medium, Model, Scalar, Swimmer};

/// Relative to the largest entry a derivative of this order can reasonably have.
const TOLERANCE: f64 = 1e-10;

fn compare<const R: usize>(
    what: &str,
    closed: &SMatrix<f64, R, 2>,
    dual: &SMatrix<HyperDual, R, 2>,
    part: impl Fn(&HyperDual) -> f64,
    units: [f64; R],
) -> Result<(), TestCaseError> {
    for row in 0..R {
        for column in 0..2 {
            let (value, expected) = (
                closed[(row, column)] / units[row],
                part(&dual[(row, column)]) / units[row],
            );
            prop_assert!(
                (value - expected).abs() <= TOLERANCE * expected.abs().max(1.0),
                "{what}, row {row}, column {column}: {value} is not {expected}"
            );
        }
    }
    Ok(())
}

struct Units {
    connection: [f64; 3],
    power: [f64; 2],
}

fn units(swimmer: &Swimmer<f64>) -> Units {
    let length = swimmer.total_length();
    let drag = if let Medium::Perfect { density, .. } = swimmer.medium {
        density * length.powi(4)
    } else {
        let links = [Link::Middle, Link::Front, Link::Back];
        let normal = links.map(|link| swimmer.chi_of(link) * swimmer.tangential_drag_of(link));
        normal.into_iter().fold(0.0, f64::max) * length.powi(3)
    };
    Units {
        connection: [length, length, 1.0],
        power: [drag, drag],
    }
}

/// An angle that is differentiated along ε₁ if `i` is its number, along ε₂ if `j` is.
fn seed(value: f64, number: usize, i: usize, j: usize) -> HyperDual {
    HyperDual::new(
        value,
        f64::from(u8::from(number == i)),
        f64::from(u8::from(number == j)),
    )
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn of_connection_and_power(swimmer in any_swimmer(), phi in shape()) {
        let closed = Model::new(&swimmer).unwrap().second_derivatives(&phi);
        let dual = Model::<HyperDual>::new(&swimmer.cast()).unwrap();
        let Units { connection, power } = units(&swimmer);
        for (n, (i, j)) in [(0, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            let (a, w): (Matrix3x2<HyperDual>, Matrix2<HyperDual>) =
                dual.connection_and_power(&Vector2::new(seed(phi.x, 0, i, j), seed(phi.y, 1, i, j)));
            compare("A", &closed.first.connection, &a, |d| d.value, connection)?;
            compare("W", &closed.first.power, &w, |d| d.value, power)?;
            compare("dA", &closed.first.d_connection[i], &a, |d| d.d1, connection)?;
            compare("dW", &closed.first.d_power[i], &w, |d| d.d1, power)?;
            compare("dA", &closed.first.d_connection[j], &a, |d| d.d2, connection)?;
            compare("dW", &closed.first.d_power[j], &w, |d| d.d2, power)?;
            compare("d2A", &closed.d2_connection[n], &a, |d| d.d12, connection)?;
            compare("d2W", &closed.d2_power[n], &w, |d| d.d12, power)?;
        }
    }

    #[test]
    fn of_the_full_connection_heading_included(swimmer in any_swimmer(), phi in shape(), theta in -4.0..4.0) {
        let model = Model::new(&swimmer).unwrap();
        let closed = model.second_derivatives(&phi).at_heading(theta);
        prop_assert_eq!(closed.first, model.first_derivatives(&phi).at_heading(theta));
        let dual = Model::<HyperDual>::new(&swimmer.cast()).unwrap();
        let units = units(&swimmer).connection;
        let first = [closed.first.d_phi[0], closed.first.d_phi[1], closed.first.d_theta];
        let second = [
            ((0, 0), closed.d2_phi[0]),
            ((0, 1), closed.d2_phi[1]),
            ((1, 1), closed.d2_phi[2]),
            ((0, 2), closed.d_phi_d_theta[0]),
            ((1, 2), closed.d_phi_d_theta[1]),
            ((2, 2), closed.d2_theta),
        ];
        for ((i, j), closed_second) in second {
            let phi = Vector2::new(seed(phi.x, 0, i, j), seed(phi.y, 1, i, j));
            let g = dual.full_connection(&phi, seed(theta, 2, i, j));
            compare("G", &closed.first.connection, &g, |d| d.value, units)?;
            compare("dG", &first[i], &g, |d| d.d1, units)?;
            compare("dG", &first[j], &g, |d| d.d2, units)?;
            compare("d2G", &closed_second, &g, |d| d.d12, units)?;
        }
    }

    #[test]
    fn of_the_curvature(swimmer in any_swimmer(), phi in shape()) {
        let closed = Model::new(&swimmer).unwrap().second_derivatives(&phi);
        let dual = Model::<HyperDual>::new(&swimmer.cast()).unwrap();
        let along = Vector2::new(seed(phi.x, 0, 0, 1), seed(phi.y, 1, 0, 1));
        let curvature = dual.first_derivatives(&along).curvature();
        let units = units(&swimmer).connection;
        let [d1, d2] = closed.d_curvature();
        for row in 0..3 {
            for (value, expected) in [
                (closed.first.curvature()[row], curvature[row].to_f64()),
                (d1[row], curvature[row].d1),
                (d2[row], curvature[row].d2),
            ] {
                let (value, expected) = (value / units[row], expected / units[row]);
                prop_assert!((value - expected).abs() <= TOLERANCE * expected.abs().max(1.0), "{value} {expected}");
            }
        }
    }
}

#[test]
fn the_cross_check_differentiates_known_functions() {
    let x = HyperDual::new(0.7, 1.0, 1.0);
    let (sin, cos) = Scalar::sin_cos(x);
    let check = |name: &str, f: HyperDual, value: f64, first: f64, second: f64| {
        crate::near(name, f.value, value, 1e-15);
        crate::near(name, f.d1, first, 1e-14);
        crate::near(name, f.d2, first, 1e-14);
        crate::near(name, f.d12, second, 1e-14);
    };
    let (s, c) = 0.7_f64.sin_cos();
    check("sin", sin, s, c, -s);
    check("cos", cos, c, -s, -c);
    check(
        "tan",
        sin / cos,
        s / c,
        1.0 / (c * c),
        2.0 * s / (c * c * c),
    );
    check(
        "sqrt",
        Scalar::sqrt(x),
        0.7_f64.sqrt(),
        0.5 / 0.7_f64.sqrt(),
        -0.25 / 0.7_f64.powf(1.5),
    );
    check("ln", Scalar::ln(x), 0.7_f64.ln(), 1.0 / 0.7, -1.0 / 0.49);
    check("atan2", Scalar::atan2(sin, cos), 0.7, 1.0, 0.0);
}
