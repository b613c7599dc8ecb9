//! From the optimiser through the gait file and the robot's table to the water: what the certificate promises is swum.

use std::ops::ControlFlow;
use std::time::Duration;

use calibrate::predict;
use gait_optimizer::{DisplacementProblem, displacement};
use gait_player::GaitTable;
use host_link::Robot;
use swimmer_files::{AnyGait, GaitFile, SwimmerFile};
use swimmer_model::{Gait as _, Model, Tolerance, swim};
use twin::{Twin, TwinConfig, TwinPort, WireSpeed};

#[test]
fn file_table_and_tank_keep_the_displacement() {
    let folder = tempfile::tempdir().unwrap();
    let file = SwimmerFile::preset("robot").unwrap();
    let best = displacement(&DisplacementProblem::new(file.swimmer).with_max_angle(2.0)).unwrap();

    let path = folder.path().join("best.gait");
    best.gait_file(&file.name).save(&path).unwrap();
    let read = AnyGait::from_file(&GaitFile::load(&path).unwrap()).unwrap();
    let stroke = swim(
        &Model::new(&file.swimmer).unwrap(),
        &read,
        &Tolerance::default(),
    );
    assert!(
        (stroke.displacement.x / best.displacement - 1.0).abs() < 1e-7,
        "{} {}",
        stroke.displacement.x,
        best.displacement
    );

    // Optimal is more than any circle within the same bound.
    let circle = swim(
        &Model::new(&file.swimmer).unwrap(),
        &AnyGait::circle(2.0),
        &Tolerance::default(),
    );
    assert!(
        best.displacement > 1.2 * circle.displacement.x,
        "{} against {}",
        best.displacement,
        circle.displacement.x
    );

    // On a robot with ideal servos only the table's 512 knots and the 50 Hz steps come between.
    let twin = Twin::new(TwinConfig::new(&file, 1).with_ideal_servos()).unwrap();
    let mut robot = Robot::connect(TwinPort::new(twin, WireSpeed::robot()), 1).unwrap();
    let table = GaitTable::from_fn(512, |u| read.at(u).phi.into()).unwrap();
    robot
        .upload(table.bytes(), Duration::from_mins(1), |_| {
            ControlFlow::Continue(())
        })
        .unwrap();
    robot.arm(false).unwrap();
    robot.play(3, Duration::from_secs(30), false).unwrap();
    robot
        .wait_until_finished(|_| ControlFlow::Continue(()))
        .unwrap();
    let starts = robot.port().device().cycle_starts().to_vec();
    let step = starts[1].pose.inverse() * starts[2].pose;
    println!(
        "X: certificate {:.6} m, tank {:.6} m",
        best.displacement, step.x
    );
    assert!(
        (step.x / best.displacement - 1.0).abs() < 5e-3,
        "{} in the tank, {} promised",
        step.x,
        best.displacement
    );

    // The estimator of tracks draws the heading as a few harmonics, which a gait with corners is not: its frame is turned a
    // little, in prediction and track alike, and the length of the step is what both keep.
    let ideal = predict(&file, &read, 30.0).unwrap();
    let step = ideal.x_m.hypot(ideal.y_m);
    assert!((step / best.displacement - 1.0).abs() < 1e-5, "{ideal:?}");
}
