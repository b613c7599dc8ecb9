//! Plans to random targets, as the servos play them, swum again by an integrator of this test's own that shares the local
//! connection alone. (`tests/tests/whole/playlist.rs` plays them on the twin.)

use std::sync::OnceLock;

use forecast::{Family, PlanError, PlanRequest, Servos, Tank, check_ends, plan};
use gait_optimizer::{Bounds, SpeedProblem, SteerProblem, steer};
use nalgebra::{Vector2, Vector3};
use swimmer_files::{AnyGait, ServoFile};
use swimmer_model::{Model, Pose, Swimmer};

const TANK: Tank = Tank {
    length: 1.0,
    width: 0.6,
};
const MARGIN: f64 = 0.005;
/// Clearance of the plates \[m\].
const CLEARANCE: f64 = 0.0025;
/// A target less than 2 mm from the wall, beyond the margin, that only the smallest cycles can reach.
const AT_A_WALL: ([f64; 2], f64) = ([-0.424_193_4, -0.099_542_5], 1.307_874_5);

fn servos() -> Servos {
    Servos::on_the_robot(ServoFile::default())
}

/// Gaits joined at the shape with the least cost, and gaits joined at the straight shape, for places too narrow to bend.
fn robot() -> &'static (Model<f64>, [Family; 2]) {
    static ROBOT: OnceLock<(Model<f64>, [Family; 2])> = OnceLock::new();
    ROBOT.get_or_init(|| {
        let model = Model::new(&Swimmer::robot()).unwrap();
        let joined_at = |shape| joined_at(shape, CLEARANCE);
        (model, [[1.4, 0.56], [0.0, 0.0]].map(joined_at))
    })
}

fn joined_at(shape: [f64; 2], clearance: f64) -> Family {
    let bounds = Bounds::within(2.8).apart(clearance);
    let problem = SteerProblem {
        of: SpeedProblem {
            bounds,
            threads: 2,
            ..SpeedProblem::new(Swimmer::robot(), [3.5; 2])
        },
        shape: Some(shape),
    };
    let steering = steer(&problem, &|_| ()).unwrap();
    let gaits = [&steering.forward, &steering.left, &steering.turn].map(|joined| {
        let gait = AnyGait::from_file(&joined.gait_file("robot", false)).unwrap();
        (gait, joined.period)
    });
    let mirrored = false;
    Family { gaits, mirrored }
}

/// Classical Runge–Kutta along straight ways of the joints.
fn swum(model: &Model<f64>, mut pose: Vector3<f64>, way: &[Vector2<f64>]) -> Vector3<f64> {
    for [from, to] in way.array_windows() {
        let turn = to - from;
        let slope = |u: f64, pose: &Vector3<f64>| {
            let body = model.local_connection(&(from + turn * u)) * turn;
            let (sin, cos) = pose.z.sin_cos();
            Vector3::new(
                cos * body.x - sin * body.y,
                sin * body.x + cos * body.y,
                body.z,
            )
        };
        let k1 = slope(0.0, &pose);
        let k2 = slope(0.5, &(pose + k1 * 0.5));
        let k3 = slope(0.5, &(pose + k2 * 0.5));
        let k4 = slope(1.0, &(pose + k3));
        pose += (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
    }
    pose
}

/// Numbers in [0, 1) from a seed (`SplitMix64`).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[test]
fn random_targets_are_reached() {
    reached_all(5, 1);
}

#[test]
#[ignore = "soak: minutes"]
fn two_hundred_random_targets_are_reached() {
    for seed in 1..=4 {
        reached_all(50, seed);
    }
}

/// Wherever the straight swimmer fits into the tank.
fn reached_all(targets: u32, seed: u64) {
    let (model, [bent, straight]) = robot();
    let mut random = Random(seed);
    let (mut reached, mut refused, mut unbent) = (0, 0, 0);
    let mut no_way = Vec::new();
    let (mut worst_m, mut worst_rad, mut longest, mut most_steps): (f64, f64, f64, usize) =
        (0.0, 0.0, 0.0, 0);
    let mut off_by_chi: [f64; 2] = [0.0; 2];
    while reached + no_way.len() < targets as usize {
        let to = Vector2::new(random.next() - 0.5, 0.6 * (random.next() - 0.5));
        let heading = std::f64::consts::TAU * (random.next() - 0.5);
        let request = PlanRequest {
            from: Pose::identity(),
            to,
            heading: Some(heading),
            tank: Some(TANK),
            margin: MARGIN,
            servos: servos(),
        };
        let found = match plan(model, bent, &request, &|_| ()) {
            Err(PlanError::Bent { .. } | PlanError::NoWay { .. }) => {
                unbent += 1;
                plan(model, straight, &request, &|_| ())
            }
            found => found,
        };
        let found = match found {
            Ok(found) => found,
            Err(PlanError::Outside { .. }) => {
                refused += 1;
                continue;
            }
            Err(error) => {
                no_way.push((to, heading, error.to_string()));
                continue;
            }
        };
        let pose = swum(model, Vector3::zeros(), found.way.vertices());
        let (sin, cos) = (pose.z - heading).sin_cos();
        worst_m = worst_m.max((Vector2::new(pose.x, pose.y) - to).norm());
        worst_rad = worst_rad.max(sin.atan2(cos).abs());
        longest = longest.max(found.duration);
        most_steps = most_steps.max(found.steps.len());
        for share in [0.95, 1.05] {
            let mut other = *model.swimmer();
            other.chi *= share;
            let other = Model::new(&other).unwrap();
            let there = found.reached_by(&other, &request.from);
            let (sin, cos) = (there.theta - found.reached.theta).sin_cos();
            off_by_chi[0] = off_by_chi[0].max((there.position() - found.reached.position()).norm());
            off_by_chi[1] = off_by_chi[1].max(sin.atan2(cos).abs());
        }
        reached += 1;
    }
    println!(
        "seed {seed}: {reached} reached, {unbent} by gaits that join straight, {} without a way, {refused} draws without room; worst \
         {worst_m:.1e} m {worst_rad:.1e} rad, longest {longest:.0} s, at most {most_steps} steps; off by {off_by_chi:?} where chi is \
         5 % wrong",
        no_way.len()
    );
    assert!(worst_m < 5e-4 && worst_rad < 5e-3, "{worst_m} {worst_rad}");
    assert!(no_way.is_empty(), "{no_way:?}");
}

/// Bent to either side the sphere would touch the wall: that is said, and gaits that join at the straight shape get there.
#[track_caller]
fn reached_straight(to: [f64; 2], heading: f64) {
    let (model, [bent, straight]) = robot();
    let request = PlanRequest {
        from: Pose::identity(),
        to: to.into(),
        heading: Some(heading),
        tank: Some(TANK),
        margin: MARGIN,
        servos: servos(),
    };
    let error = plan(model, bent, &request, &|_| ()).unwrap_err();
    assert!(matches!(error, PlanError::Bent { .. }), "{error}");
    let found = plan(model, straight, &request, &|_| ()).unwrap();
    let pose = swum(model, Vector3::zeros(), found.way.vertices());
    assert!((Vector2::new(pose.x, pose.y) - request.to).norm() < 5e-4);
    assert!((pose.z - heading).abs() < 5e-3);
}

#[test]
fn a_target_without_room_to_bend_is_reached_straight() {
    reached_straight([-0.147, 0.215], -0.39);
}

/// Less than 2 mm from the wall only the smallest cycles fit, and a hundred of them hardly move away from it.
#[test]
fn a_target_at_a_wall_is_reached_by_many_small_cycles() {
    let (to, heading) = AT_A_WALL;
    reached_straight(to, heading);
}

/// Nor does it hang on the last digits of the gaits: these are of plates 60 µm farther apart.
#[test]
fn a_target_at_a_wall_is_reached_by_slightly_other_gaits() {
    let (model, _) = robot();
    let ([x, y], heading) = AT_A_WALL;
    let request = PlanRequest {
        from: Pose::identity(),
        to: Vector2::new(x, y),
        heading: Some(heading),
        tank: Some(TANK),
        margin: MARGIN,
        servos: servos(),
    };
    let found = plan(
        model,
        &joined_at([0.0; 2], CLEARANCE + 6e-5),
        &request,
        &|_| (),
    )
    .unwrap();
    let pose = swum(model, Vector3::zeros(), found.way.vertices());
    assert!((Vector2::new(pose.x, pose.y) - request.to).norm() < 5e-4);
    assert!((pose.z - heading).abs() < 5e-3);
}

#[test]
fn a_target_outside_is_refused() {
    let (model, [family, _]) = robot();
    let request = PlanRequest {
        from: Pose::identity(),
        to: Vector2::new(0.6, 0.0),
        heading: None,
        tank: Some(TANK),
        margin: MARGIN,
        servos: servos(),
    };
    let error = plan(model, family, &request, &|_| ()).unwrap_err();
    assert!(
        matches!(error, PlanError::TargetOutside { to: [0.6, 0.0], .. }),
        "{error}"
    );
    // The refusal needs no gaits.
    assert_eq!(check_ends(model, &request), Err(error));
}

/// CPU time of this thread \[s\], which other programs on the machine do not lengthen. Returns `None` if the system does not count it.
fn cpu_seconds() -> Option<f64> {
    let counted = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = counted.split_whitespace().next()?.parse().ok()?;
    Some(nanoseconds * 1e-9)
}

/// Prints the time and the share of the bounded work of each of 30 targets. Nothing is asserted.
#[test]
#[ignore = "soak: timing"]
fn how_long_it_takes() {
    let (model, [bent, straight]) = robot();
    let mut random = Random(7);
    let mut all = Vec::new();
    while all.len() < 30 {
        let to = Vector2::new(random.next() - 0.5, 0.6 * (random.next() - 0.5));
        let heading = std::f64::consts::TAU * (random.next() - 0.5);
        let request = PlanRequest {
            from: Pose::identity(),
            to,
            heading: (all.len() % 3 > 0).then_some(heading),
            tank: Some(TANK),
            margin: MARGIN,
            servos: servos(),
        };
        if check_ends(model, &request).is_err() {
            continue;
        }
        let share = std::cell::Cell::new(0.0);
        let begun = (cpu_seconds(), std::time::Instant::now());
        let mut found = plan(model, bent, &request, &|done| share.set(done));
        let mut shares = vec![share.get()];
        if matches!(found, Err(PlanError::Bent { .. } | PlanError::NoWay { .. })) {
            share.set(0.0);
            found = plan(model, straight, &request, &|done| share.set(done));
            shares.push(share.get());
        }
        let seconds = match (begun.0, cpu_seconds()) {
            (Some(before), Some(after)) => after - before,
            _ => begun.1.elapsed().as_secs_f64(),
        };
        println!(
            "{seconds:.2} s, work {shares:.3?}: ({:.3}, {:.3}), {:?}: {:?}",
            to.x,
            to.y,
            request.heading,
            found.map(|found| (found.duration, found.steps.len()))
        );
        all.push(seconds);
    }
    all.sort_by(f64::total_cmp);
    println!("median {:.2} s, longest {:.2} s", all[15], all[29]);
}
