//! Other media: numbers of an independent model, closed forms of the kinematic snake, singular shapes.

use crate::near;
use crate::random::{cases, rate, shape};
use crate::resistive_force::connection;
use nalgebra::{Vector2, Vector3};
use proptest::prelude::*;
use swimmer_model::{
    Circle, Fourier, Gait, Harmonic, InvalidSwimmer, Link, Links, Medium, Model, Swimmer,
    Tolerance, UncommonDrag, swim,
};

/// Amplitude of a circle in a perfect fluid (equal links, aspect 0.1) and |X|/L, half a unit in the last digit.
const CIRCLES: [(f64, f64); 5] = [
    (0.25, 0.032_471_0),
    (0.5, 0.111_715_4),
    (1.0, 0.274_261_1),
    (1.5, 0.314_432_4),
    (2.0, 0.194_680_4),
];

/// Net motion (x, y, θ) of one cycle by the second formulation: the world's frame, a dense solve at each step, the classical
/// Runge–Kutta method.
fn net_motion(swimmer: &Swimmer<f64>, gait: &impl Gait<f64>, steps: usize) -> Vector3<f64> {
    let slope = |u: f64, pose: &Vector3<f64>| {
        let point = gait.at(u);
        connection(swimmer, &point.phi, pose.z) * point.rate
    };
    let h = 1.0 / steps as f64;
    let mut pose = Vector3::zeros();
    for step in 0..steps {
        let u = step as f64 * h;
        let k1 = slope(u, &pose);
        let k2 = slope(u + h / 2.0, &(pose + k1 * (h / 2.0)));
        let k3 = slope(u + h / 2.0, &(pose + k2 * (h / 2.0)));
        let k4 = slope(u + h, &(pose + k3 * h));
        pose += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
    }
    pose
}

#[test]
fn circles_in_a_perfect_fluid() {
    let swimmer = Swimmer::<f64>::perfect_fluid();
    let model = Model::new(&swimmer).unwrap();
    for (amplitude, expected) in CIRCLES {
        let circle = Circle { amplitude };
        let stroke = swim(&model, &circle, &Tolerance::default());
        let x = stroke.displacement_over_length().x;
        near("X/L", x, expected, 5.1e-8);
        near("turn", stroke.rotation, 0.0, 1e-12);
        let second = net_motion(&swimmer, &circle, 2000);
        near("X/L by the second formulation", second.x / 3.0, x, 1e-9);
        near("turn by the second formulation", second.z, 0.0, 1e-9);
        assert!(stroke.efficiency().is_nan(), "no viscosity, no efficiency");
    }
}

/// ρ scales the kinetic energy and nothing else.
#[test]
fn density_does_not_matter_for_the_motion() {
    let at = |density| {
        let medium = Medium::Perfect {
            aspect: 0.3,
            density,
        };
        let swimmer = Swimmer {
            medium,
            ..Swimmer::<f64>::robot_slender()
        };
        let phi = Vector2::new(1.1, -0.4);
        Model::new(&swimmer).unwrap().connection_and_power(&phi)
    };
    let ((a, w), (other_a, other_w)) = (at(1.0), at(1000.0));
    assert!((a - other_a).amax() < 1e-14);
    assert!((w * 1000.0 - other_w).amax() < 1e-12 * other_w.amax());
}

fn snake() -> impl Strategy<Value = Swimmer<f64>> {
    (0.3..2.0, 0.3..2.0, 0.3..2.0).prop_map(|(middle, front, back)| Swimmer {
        links: Links {
            middle,
            front,
            back,
        },
        ..Swimmer::kinematic_snake()
    })
}

/// A circle about a centre, which stays on one side of the singular shapes.
fn circle_about(centre: [f64; 2], radius: f64) -> Fourier<f64, [Harmonic<f64>; 1]> {
    Fourier {
        mean: centre.into(),
        harmonics: [Harmonic {
            cos: Vector2::new(radius, 0.0),
            sin: Vector2::new(0.0, radius),
        }],
    }
}

proptest! {
    #![proptest_config(cases(1000))]

    /// A of the kinematic snake in closed form (Shammas, Choset, Rizzi 2007, with this project's signs), for links of any length:
    /// ẋ = l (g₂ φ̇₁ + g₁ φ̇₂)/D and θ̇ = (b₁ sin φ₂ φ̇₁ + b₂ sin φ₁ φ̇₂)/D, gᵢ = h cos φᵢ + bᵢ, no ẏ.
    #[test]
    fn the_snakes_connection_is_its_closed_form(swimmer in snake(), phi in shape(), rate in rate()) {
        let model = Model::new(&swimmer).unwrap();
        let (h, b1, b2) = (swimmer.links.middle / 2.0, swimmer.links.front / 2.0, swimmer.links.back / 2.0);
        let (g1, g2) = (h * phi.x.cos() + b1, h * phi.y.cos() + b2);
        let d = g2 * phi.x.sin() - g1 * phi.y.sin();
        let determinant = swimmer.wheel_determinant(&phi).unwrap() * swimmer.total_length() / 2.0;
        prop_assert!((determinant - d).abs() < 1e-13);
        prop_assume!(d.abs() > 0.05);
        let expected = Vector3::new(
            (b1 * g2 * rate.x + b2 * g1 * rate.y) / d,
            0.0,
            (b1 * phi.y.sin() * rate.x + b2 * phi.x.sin() * rate.y) / d,
        );
        let body = model.local_connection(&phi) * rate;
        // M is the square of the constraints: its solution has twice their digits lost.
        let scale = (1.0 + expected.amax()) / (d * d);
        prop_assert!((body - expected).amax() < 1e-13 * scale, "{body} {expected} {d}");
        let power = rate.dot(&(model.power_matrix(&phi) * rate));
        prop_assert!(power.abs() < 1e-24 * scale * scale, "{power:e}");
    }

    /// The wheels' centres do not move across their links, in the world's frame.
    #[test]
    fn no_wheel_slips(swimmer in snake(), phi in shape(), rate in rate()) {
        let d = swimmer.wheel_determinant(&phi).unwrap();
        prop_assume!(d.abs() > 0.05);
        let body = Model::new(&swimmer).unwrap().local_connection(&phi) * rate;
        let drag = crate::resistive_force::drag(&swimmer, &phi, 0.0, &body, &rate);
        // The sum of squared slips, by the second formulation.
        prop_assert!(drag.power.abs() < 1e-22 / d.powi(4), "{:e}", drag.power);
    }
}

/// Gaits on one side of the singular line swim as by the constraints alone.
#[test]
fn the_snake_between_singular_shapes() {
    let swimmer = Swimmer::<f64>::kinematic_snake();
    let model = Model::new(&swimmer).unwrap();
    let by_constraints = |gait: &Fourier<f64, [Harmonic<f64>; 1]>| {
        let slope = |u: f64, theta: f64| {
            let point = gait.at(u);
            let (s1, c1) = point.phi.x.sin_cos();
            let (s2, c2) = point.phi.y.sin_cos();
            // Equal links of length 1, h = b = 1/2.
            let d = s1 - s2 + (s1 * c2 - c1 * s2);
            let speed = 0.5 * ((1.0 + c2) * point.rate.x + (1.0 + c1) * point.rate.y) / d;
            let turn = (s2 * point.rate.x + s1 * point.rate.y) / d;
            Vector3::new(speed * theta.cos(), speed * theta.sin(), turn)
        };
        let steps = 4000;
        let h = 1.0 / f64::from(steps);
        let mut pose = Vector3::zeros();
        for step in 0..steps {
            let u = f64::from(step) * h;
            let k1 = slope(u, pose.z);
            let k2 = slope(u + h / 2.0, pose.z + k1.z * h / 2.0);
            let k3 = slope(u + h / 2.0, pose.z + k2.z * h / 2.0);
            let k4 = slope(u + h, pose.z + k3.z * h);
            pose += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
        }
        pose
    };
    for (centre, radius) in [([1.0, -1.0], 0.8), ([-0.9, 0.6], 0.5), ([1.5, -0.4], 0.7)] {
        let gait = circle_about(centre, radius);
        assert_eq!(swimmer.singular_shape(&gait), None);
        let stroke = swim(&model, &gait, &Tolerance::default());
        let expected = by_constraints(&gait);
        near("x", stroke.displacement.x, expected.x, 1e-9);
        near("y", stroke.displacement.y, expected.y, 1e-9);
        near("theta", stroke.rotation, expected.z, 1e-9);
        assert!(stroke.displacement.norm() > 1e-3, "it goes somewhere");
    }
}

#[test]
fn singular_shapes_are_found() {
    let equal = Swimmer::<f64>::kinematic_snake();
    assert!(
        Swimmer::<f64>::purcell()
            .singular_shape(&Circle { amplitude: 1.0 })
            .is_none()
    );
    // Through the line, just touching it, and just beyond it.
    let distance = std::f64::consts::SQRT_2;
    for (radius, singular) in [
        (distance + 0.1, true),
        (distance, true),
        (distance - 1e-3, false),
    ] {
        let shape = equal.singular_shape(&circle_about([1.0, -1.0], radius));
        assert_eq!(shape.is_some(), singular, "{radius}: {shape:?}");
        if let Some(shape) = shape {
            assert!((shape.x - shape.y).abs() < 1e-5, "{shape}");
        }
    }
    // Unequal links: where the axles of the three wheels meet in one point, by lines in the plane.
    let uneven = Swimmer {
        links: Links {
            middle: 1.0,
            front: 0.6,
            back: 1.3,
        },
        ..equal
    };
    let shape = uneven.singular_shape(&Circle { amplitude: 1.2 }).unwrap();
    let outline = uneven.links.outline(&shape);
    let axle = |tip: Vector2<f64>, joint: Vector2<f64>| {
        let (centre, along) = ((tip + joint) / 2.0, tip - joint);
        // The axle's height over the middle of the middle link, whose own axle is x = 0.
        centre.y + centre.x * along.x / along.y
    };
    let [front, back] = [axle(outline[3], outline[2]), axle(outline[0], outline[1])];
    near("the axles' meeting point", front, back, 1e-6);
}

#[test]
fn alike_side_links_and_the_papers_parameters() {
    let robot = Swimmer::<f64>::robot();
    assert!(robot.is_symmetric() && robot.common_drag().is_ok());
    let own_chi = Swimmer {
        side_chi: Some([2.8, 2.8]),
        ..robot
    };
    assert!(own_chi.is_symmetric());
    assert_eq!(own_chi.common_drag(), Err(UncommonDrag::Chi));
    let behind = Swimmer {
        sphere_on: Link::Back,
        ..robot
    };
    assert!(!behind.is_symmetric());
    assert_eq!(behind.common_drag(), Err(UncommonDrag::Sphere));
    let bare = Swimmer {
        sphere_radius: 0.0,
        ..behind
    };
    assert!(bare.is_symmetric() && bare.common_drag().is_ok());
    let perfect = Swimmer::<f64>::perfect_fluid();
    assert!(perfect.is_symmetric());
    assert_eq!(perfect.common_drag(), Err(UncommonDrag::Medium));
    assert!(perfect.check_regular().is_ok() && robot.check_regular().is_ok());
    assert_eq!(
        perfect.check_efficiency(),
        Err(InvalidSwimmer::NoEfficiency)
    );
    let snake = Swimmer {
        links: Links {
            front: 0.4,
            ..robot.links
        },
        ..Swimmer::kinematic_snake()
    };
    let phi = [0.0; 2];
    assert_eq!(snake.check_regular(), Err(InvalidSwimmer::Singular { phi }));
}
