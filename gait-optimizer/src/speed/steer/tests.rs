//! Gaits that join: what joining costs, and where.

use super::*;
use crate::Condition;
use swimmer_model::{Gait as _, Swimmer};

fn robot(shape: Option<[f64; 2]>) -> SteerProblem {
    let bounds = Bounds::within(2.8).apart(0.0025);
    SteerProblem {
        of: SpeedProblem {
            bounds,
            threads: 2,
            starts: 32,
            ..SpeedProblem::new(Swimmer::robot(), [1.0; 2])
        },
        shape,
    }
}

#[test]
fn three_gaits_join_where_they_are_told_to() {
    let shape = [1.4, 0.56];
    let steering = steer(&robot(Some(shape)), &|_| ()).unwrap();
    assert!((Vector2::from(steering.shape) - Vector2::from(shape)).norm() < 1e-12);
    let gaits = [&steering.forward, &steering.left, &steering.turn];
    for (joined, most) in gaits.into_iter().zip([0.1, 0.6, 0.1]) {
        // The same bounds and one condition more: never faster.
        assert!((-1e-9..most).contains(&joined.cost()), "{}", joined.cost());
        let certificate = &joined.gait.certificate;
        for condition in [
            Condition::PassesJoint,
            Condition::Closed,
            Condition::KeepsBounds,
        ] {
            assert!(
                certificate.value(condition).unwrap() < 1e-9,
                "{condition:?}"
            );
        }
        assert!(certificate.value(Condition::FullRate).unwrap() < 1e-6);
        for backwards in [false, true] {
            let gait = AnyGait::from_file(&joined.gait_file("robot", backwards)).unwrap();
            assert!((gait.at(0.0).phi - Vector2::from(shape)).norm() < 1e-9);
            // Nothing is lost there and back.
            let model = Model::new(&Swimmer::robot().of_unit_length()).unwrap();
            let stroke = swim(&model, &gait, &Tolerance::default());
            let sign = if backwards { -1.0 } else { 1.0 };
            assert!((stroke.rotation - sign * joined.net[2]).abs() < 1e-9);
        }
    }
    assert!(steering.forward.net[2].abs() < 1e-9 && steering.left.net[2].abs() < 1e-9);
    assert!(steering.turn.net[2] > 0.05);
}

/// Certified or not, a returned gait can be played: no joint jumps, and no rate exceeds its limit. A start that leads to another
/// chain gives no gait; with few starts there may be no other.
#[test]
fn gaits_that_join_straight_keep_their_rates() {
    let of_starts = |starts| {
        let mut problem = robot(Some([0.0; 2]));
        problem.of.starts = starts;
        steer(&problem, &|_| ())
    };
    let few = of_starts(32);
    assert!(
        few.is_ok() || matches!(few, Err(SpeedError::NoJoinedGait { .. })),
        "{few:?}"
    );
    let many = of_starts(SpeedProblem::STARTS).unwrap();
    for steering in [Some(many), few.ok()].iter().flatten() {
        for joined in [&steering.forward, &steering.left, &steering.turn] {
            let (u, phi) = (joined.gait.u(), joined.gait.phi());
            for (u, phi) in u.windows(2).zip(phi.windows(2)) {
                let rate = (phi[1] - phi[0]).amax() / ((u[1] - u[0]) * joined.period);
                assert!(rate < 1.0 + 1e-4, "{rate} at {}", u[0]);
            }
        }
    }
}

#[test]
fn a_shape_on_a_bound_is_refused() {
    let error = steer(&robot(Some([2.8, 0.0])), &|_| ()).unwrap_err();
    assert!(matches!(error, SpeedError::Shape { .. }), "{error}");
}

/// A certified gait passes as a file, also in reverse: among the gaits that begin at its first sample's shape, not among all. The
/// forward gait switches just before that shape, where the costate jumps.
#[test]
fn files_of_gaits_that_join_pass() {
    let swimmer = Swimmer::robot();
    let problem = SteerProblem {
        of: SpeedProblem {
            bounds: Bounds::within(2.8),
            threads: 2,
            ..SpeedProblem::new(swimmer, [1.0; 2])
        },
        shape: Some([2.2, -1.28]),
    };
    let steering = steer(&problem, &|_| ()).unwrap();
    let certified = |file: &GaitFile, objective| {
        let certificate = crate::certify(&swimmer, file, objective, &file.bounds).unwrap();
        certificate.pass()
    };
    // This one is slower than if it need not join.
    let forward = steering.forward.gait_file("robot", false);
    assert!(!certified(&forward, Objective::Speed));
    let elsewhere = forward.begun_at(forward.u.len() / 3);
    assert!(!certified(&elsewhere, forward.objective));
    for joined in [&steering.forward, &steering.left, &steering.turn] {
        for backwards in [false, true] {
            let file = joined.gait_file("robot", backwards);
            assert!(certified(&file, file.objective), "{}", file.objective);
            let mut pushed = file.clone();
            let middle = pushed.phi.len() / 2;
            pushed.phi[middle].x += 1e-4;
            assert!(!certified(&pushed, file.objective));
        }
    }
}

/// Checks that three certified gaits join at a shape, each at no more than its stated cost.
#[track_caller]
fn certified_within(swimmer: Swimmer<f64>, max_angle: f64, shape: [f64; 2], most: [f64; 3]) {
    let problem = SteerProblem {
        of: SpeedProblem {
            bounds: Bounds::within(max_angle),
            threads: 2,
            ..SpeedProblem::new(swimmer, [1.0; 2])
        },
        shape: Some(shape),
    };
    let steering = steer(&problem, &|_| ()).unwrap();
    let gaits = [&steering.forward, &steering.left, &steering.turn];
    for (joined, most) in gaits.into_iter().zip(most) {
        assert!((-1e-9..most).contains(&joined.cost()), "{}", joined.cost());
        assert!(joined.gait.certificate.pass());
    }
}

/// Purcell's fastest sideways gait stays far from where the other two swim: one that is 4 % slower joins them, though most starts lead
/// to the fastest.
#[test]
fn a_slower_gait_joins_where_the_fastest_lies_elsewhere() {
    certified_within(Swimmer::purcell(), 2.4, [1.68, 0.6], [0.01, 0.05, 0.01]);
}

/// Through this shape, far from those that starts lead to, the best sideways gait has a singular arc next to an extreme one that
/// begins at the shape; without the extreme one it is not optimal.
#[test]
fn a_singular_arc_begins_beside_the_shape() {
    certified_within(Swimmer::robot(), 1.5, [1.19, 0.525], [0.03, 0.02, 0.01]);
}

/// The bounds of `--playable`: the fastest rough polygons through the straight shape lead to no sideways gait, and slower ones do.
#[test]
fn gaits_join_straight_within_the_bounds_of_the_robot() {
    let mut problem = robot(Some([0.0; 2]));
    problem.of.bounds = Bounds::within(2.8).apart(0.002_517_375);
    problem.of.starts = SpeedProblem::STARTS;
    let steering = steer(&problem, &|_| ()).unwrap();
    assert!(steering.left.rate > 0.0 && steering.left.cost() < 0.95);
}
