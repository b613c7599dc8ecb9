//! A plan to a target in a tank, its tables sent one while the other plays, the brain, servos, tank: where the swimmer truly
//! ends up. The end is checked against an integration of this test's own, of the pulses that the servos really got.

use std::ops::ControlFlow;
use std::sync::OnceLock;
use std::time::Duration;

use forecast::path::Polyline;
use forecast::playlist::{Repeated, leads_to, tables};
use forecast::{Family, PlanError, PlanRequest, PlaylistTable, Servos, Tank, plan};
use gait_optimizer::{Bounds, SpeedProblem, SteerProblem, steer};
use gait_player::GaitTable;
use host_link::port::{Device, VirtualPort};
use host_link::robot::{Leg, Sequence};
use host_link::testing::{FaultPlan, FaultyPort};
use host_link::{LinkError, Port, Robot};
use link_protocol::{StateName, StopCause};
use nalgebra::{Vector2, Vector3};
use swimmer_files::{AnyGait, ServoFile};
use swimmer_model::{Model, Pose, Swimmer, wrapped_angle};
use twin::{Twin, TwinConfig, WireSpeed};

const TANK: Tank = Tank {
    length: 1.0,
    width: 0.6,
};
const MARGIN: f64 = 0.005;
const TICK: Duration = Duration::from_millis(20);

/// A twin with a witness of every pulse.
struct Watched {
    twin: Twin,
    next: Duration,
    pulses: Vec<Option<[u32; 2]>>,
}

impl Device for Watched {
    fn advance(&mut self, to: Duration) {
        while self.next <= to {
            self.twin.advance(self.next);
            self.pulses
                .push(self.twin.output().and_then(|output| output.pulses_ns));
            self.next += TICK;
        }
        self.twin.advance(to);
    }

    fn receive(&mut self, bytes: &[u8]) {
        Device::receive(&mut self.twin, bytes);
    }

    fn transmit(&mut self, room: usize, out: &mut Vec<u8>) {
        Device::transmit(&mut self.twin, room, out);
    }
}

fn watched(swimmer: Swimmer<f64>, seed: u64) -> VirtualPort<Watched> {
    let twin = Twin::new(TwinConfig::from_parts(swimmer, &ServoFile::default(), seed));
    let device = Watched {
        twin: twin.unwrap(),
        next: Duration::ZERO,
        pulses: Vec::new(),
    };
    VirtualPort::new(device, WireSpeed::robot())
}

/// Gaits joined at the shape with the least cost, and gaits joined at the straight shape, for places too narrow to bend.
fn robot() -> &'static (Model<f64>, [Family; 2]) {
    static ROBOT: OnceLock<(Model<f64>, [Family; 2])> = OnceLock::new();
    ROBOT.get_or_init(|| {
        let model = Model::new(&Swimmer::robot()).unwrap();
        (model, [[1.4, 0.56], [0.0, 0.0]].map(joined_at))
    })
}

fn joined_at(shape: [f64; 2]) -> Family {
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

/// Plan with the first gaits if it succeeds, else with those that join at the straight shape.
fn planned<'a>(
    model: &Model<f64>,
    [bent, straight]: &'a [Family; 2],
    request: &PlanRequest,
) -> Result<(&'a Family, forecast::Plan), PlanError> {
    match plan(model, bent, request, &|_| ()) {
        Ok(found) => Ok((bent, found)),
        Err(PlanError::Bent { .. } | PlanError::NoWay { .. }) => {
            plan(model, straight, request, &|_| ()).map(|found| (straight, found))
        }
        Err(error) => Err(error),
    }
}

fn request(to: Vector2<f64>, heading: f64) -> PlanRequest {
    PlanRequest {
        from: Pose::identity(),
        to,
        heading: Some(heading),
        tank: Some(TANK),
        margin: MARGIN,
        // The twin's own: no timer rounds its pulses.
        servos: Servos {
            file: ServoFile::default(),
            pulse_step_ns: 0,
        },
    }
}

fn tables_of(family: &Family, plan: &forecast::Plan) -> Vec<PlaylistTable> {
    let steps: Vec<_> = plan
        .steps
        .iter()
        .zip(plan.gaits(family))
        .map(|(step, gait)| Repeated {
            gait,
            cycles: step.cycles,
            period: step.period,
        })
        .collect();
    tables(&steps).unwrap()
}

fn legs(tables: &[PlaylistTable]) -> Vec<Leg> {
    let leg = |table: &PlaylistTable| Leg {
        table: table.table.bytes().to_vec(),
        cycles: table.cycles,
        period: Duration::from_micros(table.period_us.into()),
    };
    tables.iter().map(leg).collect()
}

/// Uploads, arms, plays, and waits until the pulses are off.
fn play<P: Port>(robot: &mut Robot<P>, legs: Vec<Leg>) -> Result<(), LinkError> {
    robot
        .upload(&legs[0].table, Duration::from_mins(2), |_| {
            ControlFlow::Continue(())
        })
        .unwrap();
    robot.arm(false).unwrap();
    let settings_crc32 = robot.status().unwrap().settings_crc32;
    robot.play(legs[0].cycles, legs[0].period, false).unwrap();
    let mut order = Vec::new();
    let played = Sequence::playing_first(legs, settings_crc32).go_on(robot, |now| {
        order.push(now.leg);
        ControlFlow::Continue(())
    });
    robot
        .listen(Duration::from_secs(4), |_| ControlFlow::Continue(()))
        .unwrap();
    assert!(order.is_sorted(), "legs are told in their order");
    played.map(|status| assert_eq!(status.unwrap().cause, StopCause::Finished))
}

/// True final pose, relative to the start.
fn swum_by(swimmer: Swimmer<f64>, tables: &[PlaylistTable], seed: u64) -> (Pose<f64>, Watched) {
    let mut robot = Robot::connect(watched(swimmer, seed), seed).unwrap();
    let start = robot.port().device().twin.pose();
    play(&mut robot, legs(tables)).unwrap();
    let device = robot.into_port().into_device();
    assert_eq!(device.twin.state(), StateName::Stopped);
    (start.inverse() * device.twin.pose(), device)
}

/// Servos of 3.5 rad/s and a dead band of 0.017 rad at the far end of these pulses, in steps of a millisecond, and the swimmer
/// with them by classical Runge–Kutta: shares the local connection and nothing else.
fn witness(model: &Model<f64>, pulses: &[Option<[u32; 2]>]) -> Pose<f64> {
    let (mut joints, mut pose) = (Vector2::zeros(), Vector3::zeros());
    for pulses in pulses.iter().flatten() {
        let command = pulses.map(|ns| (f64::from(ns) - 1.5e6) * 0.0274e-3);
        for _ in 0..20 {
            let turn = Vector2::from_fn(|joint, _| {
                let away: f64 = command[joint] - joints[joint];
                away.signum() * (away.abs() - 0.017).clamp(0.0, 3.5e-3)
            });
            let slope = |u: f64, pose: Vector3<f64>| {
                let body = model.local_connection(&(joints + turn * u)) * turn;
                let (sin, cos) = pose.z.sin_cos();
                Vector3::new(
                    cos * body.x - sin * body.y,
                    sin * body.x + cos * body.y,
                    body.z,
                )
            };
            let k1 = slope(0.0, pose);
            let k2 = slope(0.5, pose + 0.5 * k1);
            let k3 = slope(0.5, pose + 0.5 * k2);
            let k4 = slope(1.0, pose + k3);
            pose += (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
            joints += turn;
        }
    }
    Pose::new(pose.x, pose.y, pose.z)
}

fn apart(one: &Pose<f64>, other: &Pose<f64>) -> [f64; 2] {
    [
        (one.position() - other.position()).norm() * 1e3,
        wrapped_angle(one.theta - other.theta).to_degrees().abs(),
    ]
}

/// `true` if the swimmer fits at its final pose, in the shape that it arrives with: bent to one side or the other.
fn has_room(model: &Model<f64>, family: &Family, target: &Pose<f64>) -> bool {
    [family.shape(), -family.shape()].iter().any(|shape| {
        let way = Polyline::new([*shape, Vector2::zeros()]);
        let bent = *target * leads_to(model, &way).inverse();
        let outline = model.swimmer().links.outline(shape);
        let inside = |point: &Vector2<f64>| {
            let at = bent.transform(point);
            at.x.abs() + MARGIN <= 0.5 * TANK.length && at.y.abs() + MARGIN <= 0.5 * TANK.width
        };
        outline.iter().all(inside)
    })
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

fn larger(of: &mut [f64; 2], than: [f64; 2]) {
    *of = [of[0].max(than[0]), of[1].max(than[1])];
}

#[test]
fn random_targets_are_reached_on_the_twin() {
    reached_all(4, 1);
}

#[test]
#[ignore = "soak: minutes"]
fn fifty_random_targets_are_reached_on_the_twin() {
    reached_all(50, 1);
}

/// Targets where the swimmer fits into the tank, at rest and in the shape that it comes with.
fn reached_all(targets: usize, seed: u64) {
    let (model, families) = robot();
    let mut random = Random(seed);
    let (mut off, mut beside, mut foretold) = ([0.0; 2], [0.0; 2], [0.0; 2]);
    let mut wrong = [[0.0; 2]; 2];
    let (mut no_way, mut refused, mut reached, mut most_tables) = (Vec::new(), 0, 0, 0);
    let mut straight = 0;
    while reached + no_way.len() < targets {
        let to = Vector2::new(random.next() - 0.5, 0.6 * (random.next() - 0.5));
        let heading = std::f64::consts::TAU * (random.next() - 0.5);
        if !has_room(model, &families[0], &Pose::new(to.x, to.y, heading)) {
            refused += 1;
            continue;
        }
        let (family, found) = match planned(model, families, &request(to, heading)) {
            Ok(found) => found,
            Err(PlanError::Outside { .. }) => {
                refused += 1;
                continue;
            }
            Err(PlanError::NoWay { met, .. }) => {
                no_way.push((to, heading, met));
                continue;
            }
            Err(error) => panic!("{error}"),
        };
        straight += usize::from(family.shape().norm() < 1e-9);
        let tables = tables_of(family, &found);
        most_tables = most_tables.max(tables.len());
        let target = Pose::new(to.x, to.y, heading);
        let (there, device) = swum_by(*model.swimmer(), &tables, 7 + reached as u64);
        let missed = apart(&there, &target);
        assert!(missed[0] < 2.0 && missed[1] < 2.0, "{target:?}: {missed:?}");
        larger(&mut off, missed);
        larger(&mut foretold, apart(&there, &found.reached));
        let mine = witness(model, &device.pulses);
        larger(&mut beside, apart(&there, &mine));
        assert!(apart(&mine, &target)[0] < 2.0 && apart(&mine, &target)[1] < 2.0);
        for (worst, share) in wrong.iter_mut().zip([0.95, 1.05]) {
            let mut other = *model.swimmer();
            other.chi *= share;
            larger(worst, apart(&swum_by(other, &tables, 7).0, &target));
        }
        reached += 1;
    }
    println!(
        "{reached} targets reached on the twin, {straight} of them by gaits that join straight, {} without a plan, {refused} draws where the swimmer does not fit; at most \
         {most_tables} tables\n  worst: {:.4} mm and {:.4}° off the target, {:.1e} mm and {:.1e}° off the plan's word, {:.1e} mm \
         and {:.1e}° off the witness\n  χ 5 % lower than planned with: up to {:.1} mm and {:.2}° off; 5 % higher: {:.1} mm and {:.2}°",
        no_way.len(),
        off[0],
        off[1],
        foretold[0],
        foretold[1],
        beside[0],
        beside[1],
        wrong[0][0],
        wrong[0][1],
        wrong[1][0],
        wrong[1][1]
    );
    for (to, heading, met) in &no_way {
        println!(
            "  no plan to ({:.3}, {:.3}), {:.0}°, of {met} chains",
            to.x,
            to.y,
            heading.to_degrees()
        );
    }
    // The plan plays the robot's own arithmetic, and the witness sees the same pulses.
    assert!(foretold[0] < 0.01 && foretold[1] < 0.01, "{foretold:?}");
    assert!(beside[0] < 0.1 && beside[1] < 0.1, "{beside:?}");
    assert!(no_way.is_empty(), "{no_way:?}");
}

/// A bad link changes when tables come, never what is played.
#[test]
fn a_bad_link_changes_nothing() {
    let (model, [family, _]) = robot();
    let found = plan(
        model,
        family,
        &request(Vector2::new(0.2, 0.1), 1.5),
        &|_| (),
    )
    .unwrap();
    let tables = tables_of(family, &found);
    let (clean, _) = swum_by(*model.swimmer(), &tables, 3);
    let faults = "drop=2%,flip=0.2%,delay=20";
    let port = FaultyPort::new(
        watched(*model.swimmer(), 3),
        FaultPlan::at_host(faults.parse().unwrap()),
        3,
    );
    let mut robot = Robot::connect(port, 3).unwrap();
    let start = robot.port().inner().device().twin.pose();
    play(&mut robot, legs(&tables)).unwrap();
    let there = start.inverse() * robot.port().inner().device().twin.pose();
    // The tank moves from event to event, and bytes come at other times: the last digits differ.
    assert!(apart(&clean, &there)[0] < 1e-6, "{clean:?} {there:?}");
}

/// A table that arrives too late: the robot comes to rest by itself after the gait before, and reports it.
#[test]
fn a_table_that_is_late_ends_the_play() {
    let table = |radius: f64| {
        let table = GaitTable::from_fn(512, |u| {
            let (sin, cos) = (std::f64::consts::TAU * u).sin_cos();
            [0.5 - radius * (1.0 - cos), radius * sin]
        });
        table.unwrap().bytes().to_vec()
    };
    let leg = |radius, cycles| Leg {
        table: table(radius),
        cycles,
        period: Duration::from_secs(2),
    };
    let mut robot = Robot::connect(watched(Swimmer::robot(), 9), 9).unwrap();
    let late = play(&mut robot, vec![leg(0.5, 1), leg(0.4, 5), leg(0.3, 5)]).unwrap_err();
    assert!(
        matches!(late, LinkError::OutOfStep { played: 1, legs: 3 }),
        "{late}"
    );
    let device = robot.into_port().into_device();
    assert_eq!(device.twin.state(), StateName::Stopped);
    // Two seconds of play, and no more.
    let on = device.pulses.iter().flatten().count();
    assert!((100..250).contains(&on), "{on} ticks with pulses");
}
