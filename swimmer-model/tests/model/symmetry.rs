//! Symmetries and scaling laws of connection and power.

use crate::random::{any_swimmer, cases, shape, swimmer};
use nalgebra::{Matrix2, Matrix3x2, Vector2};
use proptest::prelude::*;
use swimmer_model::{Links, Model, Swimmer, TangentialDrag};

fn close<const R: usize>(
    a: &nalgebra::SMatrix<f64, R, 2>,
    b: &nalgebra::SMatrix<f64, R, 2>,
    tolerance: f64,
) -> Result<(), TestCaseError> {
    for row in 0..R {
        let scale = b.row(row).amax().max(a.row(row).amax());
        let error = (a.row(row) - b.row(row)).amax();
        prop_assert!(error <= tolerance * scale, "row {row}: {a} is not {b}");
    }
    Ok(())
}

/// Rows x, y, θ times the given signs.
fn signed(a: &Matrix3x2<f64>, signs: [f64; 3]) -> Matrix3x2<f64> {
    Matrix3x2::from_fn(|row, column| signs[row] * a[(row, column)])
}

fn both(swimmer: &Swimmer<f64>, phi: Vector2<f64>) -> (Matrix3x2<f64>, Matrix2<f64>) {
    Model::new(swimmer).unwrap().connection_and_power(&phi)
}

const TOLERANCE: f64 = 1e-10;

proptest! {
    #![proptest_config(cases(1000))]

    /// Mirror in the middle link's axis: φ → −φ, y → −y, θ → −θ.
    #[test]
    fn mirrored_shapes_move_in_the_mirror(swimmer in any_swimmer(), phi in shape()) {
        let ((a, w), (mirrored_a, mirrored_w)) = (both(&swimmer, phi), both(&swimmer, -phi));
        close(&mirrored_a, &signed(&a, [-1.0, 1.0, 1.0]), 1e-12)?;
        close(&mirrored_w, &w, 1e-12)?;
    }

    /// Mirror across the middle link: the side links change places, x → −x, θ → −θ.
    #[test]
    fn swapped_links_move_backwards(swimmer in any_swimmer(), phi in shape()) {
        let swapped = swimmer.exchanged();
        let ((a, w), (swapped_a, swapped_w)) = (both(&swimmer, phi), both(&swapped, phi.yx()));
        let columns = Matrix2::new(0.0, 1.0, 1.0, 0.0);
        close(&(swapped_a * columns), &signed(&a, [-1.0, 1.0, -1.0]), TOLERANCE)?;
        close(&(columns * swapped_w * columns), &w, TOLERANCE)?;
    }

    /// Half a turn: side links swapped and bent the other way, x → −x, y → −y.
    #[test]
    fn half_a_turn_swaps_the_links(swimmer in any_swimmer(), phi in shape()) {
        let turned = swimmer.exchanged();
        let ((a, w), (turned_a, turned_w)) = (both(&swimmer, phi), both(&turned, -phi.yx()));
        let columns = Matrix2::new(0.0, -1.0, -1.0, 0.0);
        close(&(turned_a * columns), &signed(&a, [-1.0, -1.0, 1.0]), TOLERANCE)?;
        close(&(columns * turned_w * columns), &w, TOLERANCE)?;
    }

    #[test]
    fn full_turns_of_a_joint_change_nothing(swimmer in swimmer(), phi in shape()) {
        let turn = Vector2::new(std::f64::consts::TAU, -std::f64::consts::TAU);
        let ((a, w), (turned_a, turned_w)) = (both(&swimmer, phi), both(&swimmer, phi + turn));
        close(&turned_a, &a, TOLERANCE)?;
        close(&turned_w, &w, TOLERANCE)?;
    }

    /// All lengths times k: displacements times k, rotations unchanged, power times k³.
    #[test]
    fn lengths_scale(swimmer in swimmer(), phi in shape(), log_k in -3.0..3.0) {
        let k = f64::exp(log_k);
        let Links { middle, front, back } = swimmer.links;
        let tangential_drag = match swimmer.tangential_drag {
            TangentialDrag::HalfThickness(half) => TangentialDrag::HalfThickness(k * half),
            other => other,
        };
        let scaled = Swimmer {
            links: Links { middle: k * middle, front: k * front, back: k * back },
            tangential_drag,
            sphere_radius: k * swimmer.sphere_radius,
            ..swimmer
        };
        let ((a, w), (scaled_a, scaled_w)) = (both(&swimmer, phi), both(&scaled, phi));
        close(&scaled_a, &signed(&a, [k, k, 1.0]), TOLERANCE)?;
        close(&scaled_w, &(w * k.powi(3)), TOLERANCE)?;
    }

    /// Without a sphere c_t only scales the power.
    #[test]
    fn tangential_drag_scales(swimmer in swimmer(), phi in shape(), ct in 0.1..10.0, log_aspect in 1.0..8.0) {
        let with = |tangential_drag| Swimmer { tangential_drag, sphere_radius: 0.0, ..swimmer };
        let (a, w) = both(&with(TangentialDrag::OverViscosity(1.0)), phi);
        for (form, factor) in [
            (TangentialDrag::OverViscosity(ct), ct),
            (TangentialDrag::LogAspect(log_aspect), std::f64::consts::TAU / log_aspect),
        ] {
            let (scaled_a, scaled_w) = both(&with(form), phi);
            close(&scaled_a, &a, TOLERANCE)?;
            close(&scaled_w, &(w * factor), TOLERANCE)?;
        }
    }

    /// For links of one length the half thickness and the common ln(l/a) say the same.
    #[test]
    fn half_thickness_and_log_aspect_agree_on_equal_links(swimmer in swimmer(), phi in shape(), log_aspect in 1.0..8.0) {
        let length = swimmer.links.middle;
        let links = Links { middle: length, front: length, back: length };
        let by_log = Swimmer { links, tangential_drag: TangentialDrag::LogAspect(log_aspect), ..swimmer };
        let half = length * f64::exp(-log_aspect);
        let by_half = Swimmer { tangential_drag: TangentialDrag::HalfThickness(half), ..by_log };
        let ((a, w), (half_a, half_w)) = (both(&by_log, phi), both(&by_half, phi));
        close(&half_a, &a, TOLERANCE)?;
        close(&half_w, &w, TOLERANCE)?;
    }
}
