//! Force and power balance, checked through the second formulation.

use crate::near;
use crate::random::{any_swimmer, cases, rate, shape, symmetric_swimmer};
use crate::resistive_force::{connection, drag};
use nalgebra::Vector2;
use proptest::prelude::*;
use std::f64::consts::PI;
use swimmer_model::{Model, Swimmer, TangentialDrag};

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn net_force_and_torque_vanish_and_power_is_the_quadratic_form(
        swimmer in any_swimmer(), phi in shape(), theta in -7.0..7.0, rate in rate(),
    ) {
        let model = Model::new(&swimmer).unwrap();
        let velocity = model.full_connection(&phi, theta) * rate;
        let drag = drag(&swimmer, &phi, theta, &velocity, &rate);
        for i in 0..3 {
            prop_assert!(drag.load[i].abs() <= 1e-12 * drag.magnitude[i], "{} of {}", drag.load, drag.magnitude);
        }
        let power = rate.dot(&(model.power_matrix(&phi) * rate));
        // Power without the body's relief: what W is a small rest of, at worst.
        let scale = drag.magnitude.z * rate.norm();
        prop_assert!((power - drag.power).abs() <= 1e-13 * scale, "{power} {}", drag.power);
    }

    #[test]
    fn power_matrix_is_symmetric_and_positive_definite(swimmer in any_swimmer(), phi in shape()) {
        let w = Model::new(&swimmer).unwrap().power_matrix(&phi);
        prop_assert!(w.m12 == w.m21);
        prop_assert!(w.m11 > 0.0 && w.m22 > 0.0 && w.determinant() > 0.0, "{w}");
    }

    #[test]
    fn the_connection_solves_the_balance_of_the_second_formulation(
        swimmer in any_swimmer(), phi in shape(), theta in -7.0..7.0,
    ) {
        let g = Model::new(&swimmer).unwrap().full_connection(&phi, theta);
        let expected = connection(&swimmer, &phi, theta);
        let length = swimmer.total_length();
        for column in 0..2 {
            for (row, unit) in [length, length, 1.0].into_iter().enumerate() {
                let error = (g[(row, column)] - expected[(row, column)]).abs() / unit;
                prop_assert!(error < 1e-11, "row {row} column {column}: {error:e}");
            }
        }
    }

    /// Appendix B: 2a ± b in closed form on the two diagonals, with the misprints of D₂ corrected (8r³, and χ before its last
    /// bracket). Common c_t only.
    #[test]
    fn appendix_b(symmetric in symmetric_swimmer(), over_viscosity in 0.2..8.0, phi in -3.2..3.2) {
        let swimmer = Swimmer { tangential_drag: TangentialDrag::OverViscosity(over_viscosity), ..symmetric };
        let model = Model::new(&swimmer).unwrap();
        let (l0, l1, chi) = (swimmer.links.middle, swimmer.links.front, swimmer.chi);
        let cn = chi * over_viscosity;
        let sin2 = f64::sin(phi).powi(2);

        let w = model.power_matrix(&Vector2::new(phi, phi));
        let nu1 = PI * swimmer.sphere_radius / over_viscosity;
        let n1 = 4.0 * l1 * sin2 + 12.0 * nu1 + 2.0 * chi * l0 + (1.0 - sin2) * chi * l1;
        let d1 = 6.0 * l1 * sin2 + 18.0 * nu1 + 3.0 * chi * l0 + (1.0 - sin2) * 6.0 * chi * l1;
        let sum = cn * l1.powi(3) * n1 / d1;
        near("2a + b", 2.0 * w.m11 + 2.0 * w.m12, sum, 1e-11 * cn * l1.powi(3));
        near("a - c", w.m11, w.m22, 1e-12 * cn * l1.powi(3));

        let w = model.power_matrix(&Vector2::new(phi, -phi));
        let (z, r) = (phi.cos(), l1 / l0);
        let nu2 = PI * swimmer.sphere_radius.powi(3) / (over_viscosity * l0.powi(3));
        let n2 = 192.0 * nu2 + 2.0 * chi + (1.0 - z * z) * 12.0 * r + 3.0 * chi * r * z * z;
        let last = 6.0 * r * z * z + 12.0 * r * r * z + 8.0 * r.powi(3) + 1.0;
        let d2 = 96.0 * nu2 + (1.0 - z * z) * 6.0 * r + chi * last;
        let difference = cn * l1.powi(3) / 3.0 * n2 / d2;
        near("2a - b", 2.0 * w.m11 - 2.0 * w.m12, difference, 1e-11 * cn * l1.powi(3));
    }
}
