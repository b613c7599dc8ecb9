//! Swimmer file → gait → table → link with faults → brain → servos → tank → cameras → track → cycles: the numbers that
//! come out at the far end are those that went in.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

use calibrate::{TrackOptions, calibrate_run, load_run, predict, usual_reflectors};
use gait_player::GaitTable;
use host_link::testing::{FaultPlan, FaultyPort};
use host_link::{Port, Robot};
use link_protocol::StateName;
use swimmer_files::{AnyGait, GaitSpec, ServoFile, SwimmerFile};
use swimmer_model::{Gait as _, Model, Pose, Tolerance, swim};
use twin::{Tank, Twin, TwinConfig, TwinPort, WireSpeed, configuration};

const PERIOD_S: f64 = 20.0;

fn robot_file(servo: ServoFile) -> SwimmerFile {
    SwimmerFile {
        servo: Some(servo),
        ..SwimmerFile::preset("robot").unwrap()
    }
}

fn table(gait: &AnyGait) -> GaitTable {
    GaitTable::from_fn(512, |u| gait.at(u).phi.into()).unwrap()
}

fn twin_port(file: &SwimmerFile, seed: u64) -> TwinPort {
    TwinPort::new(
        Twin::new(TwinConfig::new(file, seed)).unwrap(),
        WireSpeed::robot(),
    )
}

/// Uploads and plays; returns what the robot says of its table.
fn play<P: Port>(robot: &mut Robot<P>, gait: &AnyGait, cycles: u32) -> link_protocol::TableInfo {
    let info = robot
        .upload(table(gait).bytes(), Duration::from_mins(2), |_| {
            ControlFlow::Continue(())
        })
        .unwrap();
    robot.arm(false).unwrap();
    robot
        .play(cycles, Duration::from_secs_f64(PERIOD_S), false)
        .unwrap();
    robot
        .wait_until_finished(|_| ControlFlow::Continue(()))
        .unwrap();
    info
}

fn tracked_x(track: &Path, gait: &str, file: &SwimmerFile) -> f64 {
    let spec: GaitSpec = gait.parse().unwrap();
    let run = load_run(track, &spec, PERIOD_S, &TrackOptions::default()).unwrap();
    let reflectors = usual_reflectors(&run.track, &file.swimmer);
    calibrate_run(&run, &reflectors, file)
        .unwrap()
        .cycles
        .x
        .mean
}

/// A bad link changes when things happen, never what happens: the track is the same prediction's.
#[test]
fn a_gait_survives_a_bad_link_and_is_tracked_as_predicted() {
    let folder = tempfile::tempdir().unwrap();
    for (seed, faults) in [
        (1, ""),
        (2, "drop=10%,flip=1%,delay=200,clump=230"),
        (3, "drop=5%,duplicate=5%"),
    ] {
        let file = robot_file(ServoFile::default());
        let gait = AnyGait::circle(70_f64.to_radians());
        let track = folder.path().join(format!("run-{seed}.csv"));
        let port = FaultyPort::new(
            twin_port(&file, seed),
            FaultPlan::at_host(faults.parse().unwrap()),
            seed,
        );
        let mut robot = Robot::connect(port, seed).unwrap();
        robot
            .port_mut()
            .inner_mut()
            .device_mut()
            .start_recording(&track)
            .unwrap();
        let info = play(&mut robot, &gait, 5);
        robot
            .port_mut()
            .inner_mut()
            .device_mut()
            .finish_recording()
            .unwrap();
        assert_eq!(
            info.crc32,
            table(&gait).crc32(),
            "the robot holds what was sent"
        );

        let predicted = predict(&file, &gait, PERIOD_S).unwrap().x_m;
        let tracked = tracked_x(&track, "circle:70deg", &file);
        println!("faults `{faults}`: predicted {predicted:.6} m, tracked {tracked:.6} m");
        assert!(
            (tracked / predicted - 1.0).abs() < 0.01,
            "{faults}: predicted {predicted}, tracked {tracked}"
        );
    }
}

/// The dead band takes several per cent off X at small amplitudes; a prediction without it is visibly wrong.
#[test]
fn predictions_need_the_servos() {
    let folder = tempfile::tempdir().unwrap();
    let file = robot_file(ServoFile {
        dead_band: 0.05,
        ..ServoFile::default()
    });
    let gait = AnyGait::circle(40_f64.to_radians());
    let track = folder.path().join("run.csv");
    let mut robot = Robot::connect(twin_port(&file, 4), 4).unwrap();
    robot
        .port_mut()
        .device_mut()
        .start_recording(&track)
        .unwrap();
    play(&mut robot, &gait, 6);
    robot.port_mut().device_mut().finish_recording().unwrap();
    let tracked = tracked_x(&track, "circle:40deg", &file);
    let knowing = predict(&file, &gait, PERIOD_S).unwrap().x_m;
    let ideal = predict(
        &SwimmerFile {
            servo: None,
            ..file
        },
        &gait,
        PERIOD_S,
    )
    .unwrap()
    .x_m;
    println!("tracked {tracked:.6} m, predicted with servos {knowing:.6} m, without {ideal:.6} m");
    assert!(
        (knowing / tracked - 1.0).abs() < 0.02,
        "{knowing} predicted, {tracked} tracked"
    );
    assert!(
        ideal / tracked - 1.0 > 0.05,
        "{ideal} without servos, {tracked} tracked"
    );
}

/// The model's quadrature, the tank's steps and the chip's f32 integration swim the same stroke.
#[test]
fn model_tank_and_brain_agree_on_a_stroke() {
    let file = robot_file(ServoFile::default());
    let gait = AnyGait::circle(1.2);
    let stroke = swim(
        &Model::new(&file.swimmer).unwrap(),
        &gait,
        &Tolerance::default(),
    );

    let mut tank = Tank::new(&file.swimmer, Pose::identity()).unwrap();
    tank.move_joints(gait.at(0.0).phi);
    let start = tank.pose();
    for step in 1..=20_000 {
        tank.move_joints(gait.at(f64::from(step) / 20_000.0).phi);
    }
    let in_tank = start.inverse() * tank.pose();
    assert!(
        (in_tank.x / stroke.displacement.x - 1.0).abs() < 1e-6,
        "{} in the tank, {:?}",
        in_tank.x,
        stroke.displacement
    );

    // The brain knows the truth here, and its pose follows the commanded angles: no servo comes between.
    let mut robot = Robot::connect(twin_port(&file, 5), 5).unwrap();
    robot
        .configure(configuration(&file.swimmer, &ServoFile::default()).unwrap())
        .unwrap();
    play(&mut robot, &gait, 1);
    let on_board = robot.telemetry().unwrap().pose;
    println!(
        "X: model {:.8} m, tank {:.8} m, brain {:.8} m",
        stroke.displacement.x, in_tank.x, on_board.x
    );
    assert!(
        (f64::from(on_board.x) / stroke.displacement.x - 1.0).abs() < 2e-3,
        "{on_board:?}, {:?}",
        stroke.displacement
    );
}

/// Whatever the operator's program does, the robot comes to rest: here it simply vanishes.
#[test]
fn a_robot_left_alone_comes_to_rest() {
    let file = robot_file(ServoFile::default());
    let mut robot = Robot::connect(twin_port(&file, 6), 6).unwrap();
    let gait = AnyGait::circle(1.0);
    robot
        .upload(table(&gait).bytes(), Duration::from_mins(1), |_| {
            ControlFlow::Continue(())
        })
        .unwrap();
    robot.arm(false).unwrap();
    robot
        .play(0, Duration::from_secs_f64(PERIOD_S), false)
        .unwrap();
    robot
        .listen(Duration::from_secs(5), |_| ControlFlow::Continue(()))
        .unwrap();
    let mut port = robot.into_port();
    assert_eq!(port.device().state(), StateName::Playing);
    // Lease 0.5 s, ramp at most 1 s, pulses off 0.5 s later.
    port.pass(Duration::from_secs_f64(2.1));
    assert_eq!(port.device().state(), StateName::Stopped);
    assert!(port.device().output().unwrap().pulses_ns.is_none());
}
