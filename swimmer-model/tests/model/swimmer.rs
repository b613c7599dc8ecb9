//! Valid and invalid swimmers, and poses.

use crate::near;
use crate::random::{any_swimmer, cases};
use nalgebra::{Vector2, Vector3};
use proptest::prelude::*;
use swimmer_model::{InvalidSwimmer, Links, Medium, Model, Pose, Swimmer, TangentialDrag};

#[test]
fn presets_are_valid() {
    for swimmer in [
        Swimmer::<f64>::purcell(),
        Swimmer::robot(),
        Swimmer::robot_slender(),
        Swimmer::perfect_fluid(),
        Swimmer::kinematic_snake(),
    ] {
        assert_eq!(swimmer.validate(), Ok(()));
        assert_eq!(swimmer.cast::<f32>().validate(), Ok(()));
        assert_eq!(swimmer.cast::<f64>(), swimmer);
    }
    near("L", Swimmer::<f64>::robot().total_length(), 0.345, 1e-15);
    near("c_t", Swimmer::<f64>::robot().side_drag(), 1.383, 5e-4);
}

#[test]
fn parameters_out_of_range_are_refused_with_their_numbers() {
    let good = Swimmer::<f64>::robot();
    let with_links = |middle, front, back| Swimmer {
        links: Links {
            middle,
            front,
            back,
        },
        ..good
    };
    let with_drag = |tangential_drag| Swimmer {
        tangential_drag,
        ..good
    };
    let bad = [
        with_links(0.0, 1.0, 1.0),
        with_links(1.0, -1.0, 1.0),
        with_links(1.0, 1.0, f64::NAN),
        Swimmer { chi: 0.0, ..good },
        Swimmer {
            chi: f64::INFINITY,
            ..good
        },
        with_drag(TangentialDrag::LogAspect(0.0)),
        with_drag(TangentialDrag::OverViscosity(-1.0)),
        with_drag(TangentialDrag::HalfThickness(0.0)),
        with_drag(TangentialDrag::HalfThickness(0.071)),
        Swimmer {
            sphere_radius: -0.01,
            ..good
        },
        Swimmer {
            sphere_radius: f64::NAN,
            ..good
        },
        Swimmer {
            side_chi: Some([2.0, 0.0]),
            ..good
        },
        with_drag(TangentialDrag::PerLink(Links {
            middle: 1.0,
            front: -1.0,
            back: 1.0,
        })),
        Swimmer {
            medium: Medium::Wheels,
            ..good
        },
        Swimmer {
            medium: Medium::Perfect {
                aspect: 1.1,
                density: 1.0,
            },
            ..Swimmer::purcell()
        },
        Swimmer {
            medium: Medium::Perfect {
                aspect: 0.1,
                density: f64::NAN,
            },
            ..Swimmer::purcell()
        },
    ];
    for swimmer in bad {
        assert!(Model::new(&swimmer).is_err(), "{swimmer:?}");
    }
    let error = with_links(1.0, -2.5, 1.0).validate().unwrap_err();
    assert_eq!(
        error,
        InvalidSwimmer::NotPositive {
            name: "front link length [m]",
            value: -2.5
        }
    );
    assert!(error.to_string().contains("-2.5"));
    let error = with_drag(TangentialDrag::HalfThickness(0.08))
        .validate()
        .unwrap_err();
    assert_eq!(
        error,
        InvalidSwimmer::TooThick {
            half_thickness: 0.08,
            shortest: 0.071
        }
    );
}

fn pose() -> impl Strategy<Value = Pose<f64>> {
    (-3.0..3.0, -3.0..3.0, -7.0..7.0).prop_map(|(x, y, theta)| Pose::new(x, y, theta))
}

fn same(a: Pose<f64>, b: Pose<f64>, tolerance: f64) {
    near("x", a.x, b.x, tolerance);
    near("y", a.y, b.y, tolerance);
    near("theta", a.theta, b.theta, tolerance);
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn poses_are_a_group(a in pose(), b in pose(), c in pose(), x in -2.0..2.0, y in -2.0..2.0) {
        same((a * b) * c, a * (b * c), 1e-13);
        same(a * a.inverse(), Pose::identity(), 1e-14);
        same(a.inverse() * a, Pose::identity(), 1e-14);
        let point = Vector2::new(x, y);
        let (once, twice) = ((a * b).transform(&point), a.transform(&b.transform(&point)));
        prop_assert!((once - twice).amax() < 1e-13);
    }

    #[test]
    fn exp_is_many_small_steps(x in -2.0..2.0, y in -2.0..2.0, log_turn in -25.0..1.0) {
        let twist = Vector3::new(x, y, f64::exp(log_turn));
        // (1 + ε/2ⁿ)^(2ⁿ) by repeated squaring, from a step whose own error is below rounding.
        let mut step = Pose::new(twist.x, twist.y, 0.0);
        let parts = f64::from(2_u32.pow(26));
        step = Pose::new(step.x / parts, step.y / parts, twist.z / parts);
        for _ in 0..26 {
            step = step * step;
        }
        same(Pose::exp(&twist), step, 1e-6);
        same(Pose::exp(&twist) * Pose::exp(&-twist), Pose::identity(), 1e-14);
    }

    #[test]
    fn casting_keeps_the_swimmer(swimmer in any_swimmer()) {
        prop_assert_eq!(swimmer.cast::<f64>(), swimmer);
    }
}
