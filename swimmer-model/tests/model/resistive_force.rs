//! A second formulation of the physics, in the world's frame and straight from the paper's equation (1): velocities of
//! the links' centres, forces along tangents and normals, torques about the middle link's centre. It shares no matrix
//! with the crate. In a perfect fluid the same sums, with masses in place of drag coefficients, are minus the momenta.

use nalgebra::{Matrix3, Matrix3x2, Vector2, Vector3};
use std::f64::consts::PI;
use swimmer_model::{Link, Medium, Swimmer, TangentialDrag};

/// Load of the fluid on the swimmer.
pub(crate) struct Drag {
    /// Net force and torque about the middle link's centre.
    pub(crate) load: Vector3<f64>,
    /// Power spent against the fluid.
    pub(crate) power: f64,
    /// Sum of the magnitudes of all contributions to the load, to measure its vanishing against.
    pub(crate) magnitude: Vector3<f64>,
}

/// Coefficients of a link of this length against motion along it, across it, and against rotation.
fn coefficients(swimmer: &Swimmer<f64>, link: Link, length: f64) -> [f64; 3] {
    match swimmer.medium {
        Medium::Viscous => {
            let ct = match swimmer.tangential_drag {
                TangentialDrag::LogAspect(log_aspect) => 2.0 * PI / log_aspect,
                TangentialDrag::HalfThickness(half) => 2.0 * PI / (length / half).ln(),
                TangentialDrag::OverViscosity(value) => value,
                TangentialDrag::PerLink(values) => match link {
                    Link::Middle => values.middle,
                    Link::Front => values.front,
                    Link::Back => values.back,
                },
            };
            let chi = match (link, swimmer.side_chi) {
                (Link::Front, Some(own)) => own[0],
                (Link::Back, Some(own)) => own[1],
                _ => swimmer.chi,
            };
            [
                ct * length,
                chi * ct * length,
                chi * ct * length.powi(3) / 12.0,
            ]
        }
        Medium::Perfect { aspect, density } => {
            let (a, b) = (length / 2.0, aspect * length / 2.0);
            let mass = density * PI * a * b;
            [
                mass + density * PI * b.powi(2),
                mass + density * PI * a.powi(2),
                mass * (a.powi(2) + b.powi(2)) / 4.0
                    + density * PI * (a.powi(2) - b.powi(2)).powi(2) / 8.0,
            ]
        }
        Medium::Wheels => [0.0, 1.0, 0.0],
    }
}

/// Drag on a swimmer that moves at `velocity` = (ẋ, ẏ, θ̇) with joint rates `rate`.
pub(crate) fn drag(
    swimmer: &Swimmer<f64>,
    phi: &Vector2<f64>,
    theta: f64,
    velocity: &Vector3<f64>,
    rate: &Vector2<f64>,
) -> Drag {
    let direction = |alpha: f64| Vector2::new(alpha.cos(), alpha.sin());
    let turned = |v: Vector2<f64>| Vector2::new(-v.y, v.x);
    let links = &swimmer.links;
    let t0 = direction(theta);
    // Per link: length, angle, angular velocity, joint on the middle link (±l₀/2 along it).
    let places = [
        (Link::Middle, links.middle, theta, velocity.z, None),
        (
            Link::Front,
            links.front,
            theta + phi.x,
            velocity.z + rate.x,
            Some(links.middle / 2.0),
        ),
        (
            Link::Back,
            links.back,
            theta + PI - phi.y,
            velocity.z - rate.y,
            Some(-links.middle / 2.0),
        ),
    ];
    let mut sum = Drag {
        load: Vector3::zeros(),
        power: 0.0,
        magnitude: Vector3::zeros(),
    };
    let mut add =
        |arm: Vector2<f64>, force: Vector2<f64>, torque: f64, v: Vector2<f64>, omega: f64| {
            let lever = arm.x * force.y - arm.y * force.x;
            sum.load += Vector3::new(force.x, force.y, torque + lever);
            let size = force.norm();
            sum.magnitude += Vector3::new(size, size, torque.abs() + arm.norm() * size);
            sum.power -= force.dot(&v) + torque * omega;
        };
    let v0 = velocity.xy();
    for (link, length, alpha, omega, joint) in places {
        let t = direction(alpha);
        let n = turned(t);
        let (arm, v) = match joint {
            None => (Vector2::zeros(), v0),
            Some(along) => {
                let hinge = t0 * along;
                (
                    hinge + t * (length / 2.0),
                    v0 + turned(hinge) * velocity.z + n * (length / 2.0 * omega),
                )
            }
        };
        let [along, across, round] = coefficients(swimmer, link, length);
        let force = -t * (along * v.dot(&t)) - n * (across * v.dot(&n));
        add(arm, force, -round * omega, v, omega);
        if swimmer.sphere_on == link {
            let r = swimmer.sphere_radius;
            add(
                arm,
                -v * (6.0 * PI * r),
                -8.0 * PI * r.powi(3) * omega,
                v,
                omega,
            );
        }
    }
    sum
}

/// G(Φ, θ) from the velocity at which the load vanishes, one joint at a time.
pub(crate) fn connection(swimmer: &Swimmer<f64>, phi: &Vector2<f64>, theta: f64) -> Matrix3x2<f64> {
    let load = |v: Vector3<f64>, rate: Vector2<f64>| drag(swimmer, phi, theta, &v, &rate).load;
    let body =
        Matrix3::from_columns(&[0, 1, 2].map(|i| load(Vector3::ith(i, 1.0), Vector2::zeros())));
    let joints =
        Matrix3x2::from_columns(&[0, 1].map(|i| load(Vector3::zeros(), Vector2::ith(i, 1.0))));
    -body
        .lu()
        .solve(&joints)
        .expect("a swimmer that moves feels drag")
}
