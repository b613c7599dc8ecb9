//! Effect of the tank's walls on one cycle, to first order in the size of the body over its distance from them.
//!
//! The links are divided into segments; each segment, and the sphere, pushes the fluid with the force of its own resistance. A plane
//! wall answers with the image of that force (J. R. Blake, Proc. Camb. Phil. Soc. 70, 1971, 303), which moves all elements. For one
//! sphere alone the images give the corrections of the drag by 9/16 and 9/8 of radius over distance along and across the wall
//! (Happel and Brenner, Low Reynolds Number Hydrodynamics, chapter 7). The swimmer as a whole pushes with no force, so the images of its
//! parts nearly cancel: the effect falls off much faster than that of a towed body, and has no fixed sign. Walls of a box add up. A
//! round wall counts as its four tangent planes that face the body.

use nalgebra::{Matrix2, Matrix3, Matrix3x2, SMatrix, Vector2};
use swimmer_files::{AnyGait, TankWalls, WallPlane};
use swimmer_model::{Gait as _, Link, Model, Pose, Swimmer};

use crate::prediction::{PredictedCycle, View};

/// Segments of a link.
const SEGMENTS: usize = 6;
/// Steps of a cycle.
const STEPS: usize = 96;
/// Elements closer to a wall than this \[m\] are beyond first order.
const NEAREST: f64 = 5e-3;

/// Velocities of an element per (ẋ, ẏ, θ̇, φ̇₁, φ̇₂), in the frame of the middle link.
type Velocities = SMatrix<f64, 2, 5>;
type Resistance = SMatrix<f64, 5, 5>;

/// Part of the body, in the frame of the middle link.
struct Element {
    place: Vector2<f64>,
    /// Force on the fluid per unit rates, over the viscosity.
    force: Velocities,
}

/// Returns by how much the walls change the cycle of a run: with them less without them. `None` if a part of the body would reach a
/// wall.
pub(crate) fn change(
    swimmer: &Swimmer<f64>,
    gait: &AnyGait,
    walls: &TankWalls,
    view: &View,
) -> Option<PredictedCycle> {
    let model = Model::new(swimmer).ok()?;
    let free = swum(
        &model,
        gait,
        |_, _| Some(Matrix3x2::zeros()),
        Pose::identity(),
    )?;
    // The cycle's mean place is the view's.
    let count = free.len() as f64;
    let middle = free.iter().map(Pose::position).sum::<Vector2<f64>>() / count;
    let place = view.place - nalgebra::Rotation2::new(view.heading) * middle;
    let start = Pose::new(place.x, place.y, view.heading);
    let near = |phi: &Vector2<f64>, pose: &Pose<f64>| {
        let planes = walls.planes([pose.x, pose.y]);
        correction(swimmer, phi, pose, &planes)
    };
    let walled = swum(&model, gait, near, start)?;
    let (free, walled) = (cycle(&free), cycle(&walled));
    Some(PredictedCycle {
        x_m: walled.x_m - free.x_m,
        y_m: walled.y_m - free.y_m,
        rotation_rad: walled.rotation_rad - free.rotation_rad,
        delta_y_m: walled.delta_y_m - free.delta_y_m,
        delta_theta_rad: walled.delta_theta_rad - free.delta_theta_rad,
    })
}

/// Poses of one cycle, with a correction of the local connection.
fn swum(
    model: &Model<f64>,
    gait: &AnyGait,
    correction: impl Fn(&Vector2<f64>, &Pose<f64>) -> Option<Matrix3x2<f64>>,
    start: Pose<f64>,
) -> Option<Vec<Pose<f64>>> {
    let phi = |half_step: usize| gait.at(half_step as f64 / (2 * STEPS) as f64).phi;
    let mut pose = start;
    let mut poses = vec![pose];
    for step in 0..STEPS {
        let middle = phi(2 * step + 1);
        let change = phi(2 * step + 2) - phi(2 * step);
        let connection = model.local_connection(&middle) + correction(&middle, &pose)?;
        pose = pose * Pose::exp(&(connection * change));
        poses.push(pose);
    }
    Some(poses)
}

/// Values of a cycle in the frame of its start.
fn cycle(poses: &[Pose<f64>]) -> PredictedCycle {
    let (first, last) = (poses[0], poses[poses.len() - 1]);
    let seen = |pose: &Pose<f64>| {
        let along = nalgebra::Rotation2::new(-first.theta) * (pose.position() - first.position());
        (along, pose.theta - first.theta)
    };
    let half_range = |value: fn(&(Vector2<f64>, f64)) -> f64| {
        let values = poses.iter().map(|pose| value(&seen(pose)));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        0.5 * (high - low)
    };
    let (end, turn) = seen(&last);
    PredictedCycle {
        x_m: end.x,
        y_m: end.y,
        rotation_rad: turn,
        delta_y_m: half_range(|(along, _)| along.y),
        delta_theta_rad: half_range(|(_, turn)| *turn),
    }
}

/// Change of the local connection near walls.
fn correction(
    swimmer: &Swimmer<f64>,
    phi: &Vector2<f64>,
    pose: &Pose<f64>,
    planes: &[WallPlane],
) -> Option<Matrix3x2<f64>> {
    let (free, elements) = resistance(swimmer, phi);
    let mut walled = free;
    let turn = nalgebra::Rotation2::new(pose.theta);
    for plane in planes {
        let normal = Vector2::from(plane.normal);
        // Rows: along the wall, and away from it.
        let axes = Matrix2::new(normal.y, -normal.x, normal.x, normal.y) * turn.matrix();
        let distance = plane.distance([pose.x, pose.y]);
        if distance < swimmer.sphere_radius {
            return None;
        }
        let seen: Vec<(Vector2<f64>, Velocities)> = elements
            .iter()
            .map(|element| {
                let place = axes * element.place + Vector2::new(0.0, distance);
                (place, axes * element.force)
            })
            .collect();
        if seen.iter().any(|(place, _)| place.y < NEAREST) {
            return None;
        }
        for (at, force) in &seen {
            for (from, pushed) in &seen {
                walled -= force.transpose() * image(at, from) * pushed;
            }
        }
    }
    Some(connection(&walled)? - connection(&free)?)
}

/// −M⁻¹ N.
fn connection(resistance: &Resistance) -> Option<Matrix3x2<f64>> {
    let body: Matrix3<f64> = resistance.fixed_view::<3, 3>(0, 0).into_owned();
    let joints: Matrix3x2<f64> = resistance.fixed_view::<3, 2>(0, 3).into_owned();
    Some(-body.cholesky()?.solve(&joints))
}

/// Resistance in open fluid to (ẋ, ẏ, θ̇, φ̇₁, φ̇₂), over the viscosity, and its elements.
fn resistance(swimmer: &Swimmer<f64>, phi: &Vector2<f64>) -> (Resistance, Vec<Element>) {
    use std::f64::consts::PI;
    let radius = swimmer.sphere_radius;
    let mut sum = Resistance::zeros();
    sum[(2, 2)] = 8.0 * PI * radius.powi(3);
    let mut elements = Vec::with_capacity(3 * SEGMENTS + 1);
    let mut add = |place: Vector2<f64>, drag: Matrix2<f64>, moved: Velocities| {
        let force = drag * moved;
        sum += moved.transpose() * force;
        elements.push(Element { place, force });
    };
    let rigid = |place: Vector2<f64>| {
        let mut moved = Velocities::zeros();
        moved[(0, 0)] = 1.0;
        moved[(1, 1)] = 1.0;
        moved[(0, 2)] = -place.y;
        moved[(1, 2)] = place.x;
        moved
    };
    let sphere = Matrix2::identity() * (6.0 * PI * radius);
    add(Vector2::zeros(), sphere, rigid(Vector2::zeros()));
    let links = swimmer.links;
    let half = 0.5 * links.middle;
    // Length, hinge, direction, and the share of each joint's rate in the turn.
    let parts = [
        (Link::Middle, links.middle, -half, 0.0, [0.0, 0.0]),
        (Link::Front, links.front, half, phi.x, [1.0, 0.0]),
        (Link::Back, links.back, -half, PI - phi.y, [0.0, -1.0]),
    ];
    for (link, length, hinge, direction, shares) in parts {
        let (sin, cos) = direction.sin_cos();
        let (along, across) = (Vector2::new(cos, sin), Vector2::new(-sin, cos));
        let tangential = swimmer.tangential_drag_of(link);
        let share = length / SEGMENTS as f64;
        let drag = (along * along.transpose() + across * across.transpose() * swimmer.chi_of(link))
            * (tangential * share);
        for segment in 0..SEGMENTS {
            let arm = (segment as f64 + 0.5) * share;
            let place = Vector2::new(hinge, 0.0) + along * arm;
            let mut moved = rigid(place);
            for (joint, share) in shares.into_iter().enumerate() {
                moved.set_column(3 + joint, &(across * (arm * share)));
            }
            add(place, drag, moved);
        }
    }
    (sum, elements)
}

/// Velocity at a place next to a wall by the image of a force at another, over the viscosity: places and components along the wall and
/// away from it.
fn image(at: &Vector2<f64>, from: &Vector2<f64>) -> Matrix2<f64> {
    let (t, n, height) = (at.x - from.x, at.y + from.y, from.y);
    let square = t * t + n * n;
    let (one, three) = (square.sqrt().recip(), square.powf(-1.5));
    let five = three / square;
    let mixed = t * three;
    // Stokeslet of the opposite force at the image point.
    let stokeslet = Matrix2::new(
        one + t * t * three,
        t * n * three,
        t * n * three,
        one + n * n * three,
    );
    // Source doublet and Stokes doublet, the columns by the components of the force.
    let bend = 3.0 * t * n * (n - height) * five;
    let along = Vector2::new(
        (height - n) * three + 3.0 * t * t * (n - height) * five,
        mixed + bend,
    );
    let away = Vector2::new(
        bend - mixed,
        (height - n) * three + 3.0 * n * n * (n - height) * five,
    );
    let doublets = Matrix2::from_columns(&[along, -away]) * (2.0 * height);
    (doublets - stokeslet) / (8.0 * std::f64::consts::PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Faxén's corrections of a sphere's drag next to a plane wall.
    #[test]
    fn the_image_of_a_sphere_slows_it_by_nine_sixteenths_and_nine_eighths() {
        let (radius, height) = (0.01, 0.5);
        let at = Vector2::new(0.0, height);
        let slower = image(&at, &at) * (6.0 * std::f64::consts::PI * radius);
        let ratio = radius / height;
        assert!(
            (slower[(0, 0)] + 9.0 / 16.0 * ratio).abs() < 1e-15,
            "{slower}"
        );
        assert!(
            (slower[(1, 1)] + 9.0 / 8.0 * ratio).abs() < 1e-15,
            "{slower}"
        );
        assert!(slower[(0, 1)].abs() < 1e-18 && slower[(1, 0)].abs() < 1e-18);
    }

    /// Fluid at the wall rests: a force and its image cancel there.
    #[test]
    fn fluid_rests_at_the_wall() {
        let from = Vector2::new(0.1, 0.3);
        let at = Vector2::new(-0.25, 0.0);
        let apart = at - from;
        let distance: f64 = apart.norm();
        let free = (Matrix2::identity() / distance + apart * apart.transpose() / distance.powi(3))
            / (8.0 * std::f64::consts::PI);
        assert!((image(&at, &from) + free).amax() < 1e-15);
    }

    /// Segments give nearly the connection of the model, and no change far away.
    #[test]
    fn far_walls_change_nothing() {
        let swimmer = Swimmer::robot();
        let phi = Vector2::new(1.1, -0.4);
        let near = connection(&resistance(&swimmer, &phi).0).unwrap();
        let exact = Model::new(&swimmer).unwrap().local_connection(&phi);
        assert!(
            (near - exact).amax() < 0.03 * exact.amax(),
            "{near} {exact}"
        );
        let wall = |distance: f64| {
            let plane = WallPlane {
                normal: [0.0, 1.0],
                offset: -distance,
            };
            correction(&swimmer, &phi, &Pose::identity(), &[plane])
                .unwrap()
                .amax()
        };
        // The swimmer pushes with no net force: the effect falls faster than 1/h.
        assert!(wall(4.0) < 0.3 * wall(2.0), "{} {}", wall(4.0), wall(2.0));
        assert!(
            correction(
                &swimmer,
                &phi,
                &Pose::identity(),
                &[WallPlane {
                    normal: [0.0, 1.0],
                    offset: -0.05
                }]
            )
            .is_none()
        );
    }

    /// X, ΔY and Δθ of a circle of 85° next to one wall, over those in open fluid: values of an independent program with six pieces per
    /// link. At 20 cm the wall changes X by 0 to 4 %, at 30 cm by about a quarter of that.
    #[test]
    fn a_circle_next_to_a_wall() {
        let swimmer = Swimmer {
            sphere_radius: 0.0545,
            chi: 2.93,
            ..Swimmer::robot()
        };
        let gait = AnyGait::circle(85_f64.to_radians());
        let quarter = std::f64::consts::FRAC_PI_2;
        for (distance, heading, x, delta_y, delta_theta) in [
            (0.2, 0.0, 1.003_46, 0.974_42, 1.010_57),
            (0.2, quarter, 1.039_64, 1.006_26, 1.009_98),
            (0.2, 2.0 * quarter, 1.011_00, 0.974_61, 1.009_26),
            (0.2, -quarter, 1.039_93, 1.006_15, 1.010_09),
            (0.3, 0.0, 1.001_03, 0.990_61, 1.003_31),
        ] {
            let walls = TankWalls::Box {
                size: [200.0; 2],
                centre: [0.0, 100.0 - distance],
            };
            let view = View {
                heading,
                place: Vector2::zeros(),
            };
            let change = change(&swimmer, &gait, &walls, &view).unwrap();
            for (change, free, ratio) in [
                (change.x_m, 0.010_312_25, x),
                (change.delta_y_m, 0.028_271_31, delta_y),
                (change.delta_theta_rad, 0.595_232_95, delta_theta),
            ] {
                let off = change / free - (ratio - 1.0);
                assert!(off.abs() < 2e-3, "{distance} {heading}: {off}");
            }
        }
    }
}
