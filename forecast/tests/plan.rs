//! Plans to random targets, swum again by an integrator of this test's own that shares the local connection alone.

use std::sync::OnceLock;

use forecast::{Errand, Family, PlanError, Tank, plan};
use gait_optimizer::{Bounds, SpeedProblem, SteerProblem, steer};
use nalgebra::{Vector2, Vector3};
use swimmer_files::AnyGait;
use swimmer_model::{Gait, Model, Pose, Swimmer};

const TANK: Tank = Tank {
    length: 1.0,
    width: 0.6,
};
const MARGIN: f64 = 0.005;

fn robot() -> &'static (Model<f64>, Family) {
    static ROBOT: OnceLock<(Model<f64>, Family)> = OnceLock::new();
    ROBOT.get_or_init(found)
}

fn found() -> (Model<f64>, Family) {
    let swimmer = Swimmer::robot();
    let bounds = Bounds {
        max_angle: Some(2.8),
        no_overlap: true,
        clearance: 0.0025,
        ..Bounds::default()
    };
    let problem = SteerProblem {
        of: SpeedProblem {
            bounds,
            threads: 2,
            starts: 32,
            ..SpeedProblem::new(swimmer, [3.5; 2])
        },
        shape: Some([1.4, 0.56]),
    };
    let steering = steer(&problem, &|_| ()).unwrap();
    let gaits = [&steering.forward, &steering.left, &steering.turn].map(|joined| {
        let gait = AnyGait::from_file(&joined.gait_file("robot", false)).unwrap();
        (gait, joined.period)
    });
    (Model::new(&swimmer).unwrap(), Family { gaits })
}

/// Of each piece.
const STEPS: u32 = 4;

/// Classical Runge–Kutta along straight or smooth pieces of shapes.
fn swum(model: &Model<f64>, mut pose: Vector3<f64>, gait: &impl Gait<f64>) -> Vector3<f64> {
    let mut from = 0.0;
    for piece in 0..gait.pieces() {
        let to = gait.piece_end(piece);
        let steps = if gait.pieces() > 1 { STEPS } else { 400 };
        let h = (to - from) / f64::from(steps);
        let slope = |u: f64, pose: &Vector3<f64>| {
            // Not across a corner.
            let point = gait.at(u.clamp(from + 1e-12, to - 1e-12));
            let body = model.local_connection(&point.phi) * point.rate;
            let (sin, cos) = pose.z.sin_cos();
            Vector3::new(
                cos * body.x - sin * body.y,
                sin * body.x + cos * body.y,
                body.z,
            )
        };
        let mut u = from;
        for _ in 0..steps {
            let k1 = slope(u, &pose);
            let k2 = slope(u + 0.5 * h, &(pose + k1 * (0.5 * h)));
            let k3 = slope(u + 0.5 * h, &(pose + k2 * (0.5 * h)));
            let k4 = slope(u + h, &(pose + k3 * h));
            pose += (k1 + 2.0 * k2 + 2.0 * k3 + k4) * (h / 6.0);
            u += h;
        }
        from = to;
    }
    pose
}

/// Straight lines from the straight shape to the common one and back.
struct Line([Vector2<f64>; 2]);

impl Gait<f64> for Line {
    fn at(&self, u: f64) -> swimmer_model::GaitPoint<f64> {
        let [from, to] = self.0;
        swimmer_model::GaitPoint {
            phi: from + (to - from) * u,
            rate: to - from,
        }
    }
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
    reached_all(5);
}

#[test]
#[ignore = "soak: a minute"]
fn fifty_random_targets_are_reached() {
    reached_all(50);
}

fn reached_all(targets: u32) {
    let (model, family) = robot();
    let shape = family.shape();
    let mut random = Random(1);
    let (mut reached, mut refused, mut no_way) = (0, 0, 0);
    let (mut worst_m, mut worst_rad, mut longest): (f64, f64, f64) = (0.0, 0.0, 0.0);
    let mut off_by_chi: [f64; 2] = [0.0; 2];
    while reached + no_way < targets {
        let to = Vector2::new(random.next() - 0.5, 0.6 * (random.next() - 0.5));
        let heading = std::f64::consts::TAU * (random.next() - 0.5);
        // Where links that swing right round have room: half the middle link and a side link.
        let links = &model.swimmer().links;
        let reach = 0.5 * links.middle + links.front + MARGIN;
        if to.x.abs() + reach > 0.5 * TANK.length || to.y.abs() + reach > 0.5 * TANK.width {
            refused += 1;
            continue;
        }
        let errand = Errand {
            from: Pose::identity(),
            to,
            heading: Some(heading),
            tank: Some(TANK),
            margin: MARGIN,
        };
        let found = match plan(model, family, &errand) {
            Ok(found) => found,
            Err(PlanError::NoWay { .. }) => {
                no_way += 1;
                println!("no way to {to:?} {heading}");
                continue;
            }
            Err(error) => panic!("{error}"),
        };
        let mut pose = swum(model, Vector3::zeros(), &Line([Vector2::zeros(), shape]));
        for step in &found.steps {
            let gait = step.member.of(family);
            for _ in 0..step.cycles {
                pose = swum(model, pose, &gait);
            }
        }
        pose = swum(model, pose, &Line([shape, Vector2::zeros()]));
        let (sin, cos) = (pose.z - heading).sin_cos();
        worst_m = worst_m.max((Vector2::new(pose.x, pose.y) - to).norm());
        worst_rad = worst_rad.max(sin.atan2(cos).abs());
        longest = longest.max(found.duration);
        for share in [0.95, 1.05] {
            let mut other = *model.swimmer();
            other.chi *= share;
            let other = Model::new(&other).unwrap();
            let there = family.reached(&other, &errand.from, &found.steps);
            let (sin, cos) = (there.theta - found.reached.theta).sin_cos();
            off_by_chi[0] = off_by_chi[0].max((there.position() - found.reached.position()).norm());
            off_by_chi[1] = off_by_chi[1].max(sin.atan2(cos).abs());
        }
        reached += 1;
    }
    println!(
        "{reached} reached, {no_way} without a way, {refused} draws without room; worst {worst_m:.1e} m {worst_rad:.1e} rad, \
         longest {longest:.0} s; off by {off_by_chi:?} where chi is 5 % wrong"
    );
    assert!(worst_m < 1e-6 && worst_rad < 1e-6, "{worst_m} {worst_rad}");
    assert_eq!(no_way, 0);
}

#[test]
fn a_target_outside_is_refused() {
    let (model, family) = robot();
    let errand = Errand {
        from: Pose::identity(),
        to: Vector2::new(0.6, 0.0),
        heading: None,
        tank: Some(TANK),
        margin: MARGIN,
    };
    let error = plan(model, family, &errand).unwrap_err();
    assert!(
        matches!(error, PlanError::NoWay { .. } | PlanError::Outside { .. }),
        "{error}"
    );
}
