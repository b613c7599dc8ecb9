//! A passive joint from the waveform to the water: the twin with a spring swims what the limit cycle says, driven by one pulse train.

use std::ops::ControlFlow;
use std::time::Duration;

use forecast::{Played, Servos, forecast_passive};
use gait_player::GaitTable;
use host_link::Robot;
use link_protocol::Joint;
use passive_joint::{LimitCycle, PassiveJoint, Waveform};
use swimmer_files::{AnyGait, GaitFile, JointName, PassiveFile, ServoFile, Spring, SwimmerFile};
use swimmer_model::{Gait as _, Model, Tolerance, swim};
use twin::{Twin, TwinConfig, TwinPort, WireSpeed};

const PERIOD_S: f64 = 20.0;
/// Largest relative difference of forecast and tank.
const FORECAST: f64 = 1e-3;

#[test]
fn the_twin_swims_the_limit_cycle() {
    for (joint, ideal) in [
        (Joint::Back, true),
        (Joint::Front, true),
        (Joint::Back, false),
    ] {
        let file = SwimmerFile {
            passive: Some(PassiveFile {
                joint: JointName(joint),
                spring: Spring::Relaxation(3.0),
            }),
            ..SwimmerFile::preset("robot").unwrap()
        };
        let model = Model::new(&file.swimmer).unwrap();
        let passive = PassiveJoint::relaxing_in(&model, joint, 3.0 / PERIOD_S).unwrap();
        let waveform = Waveform::new(vec![1.15, -0.12, 0.04]);
        let drive = waveform.driving(passive.driven());
        let cycle = LimitCycle::new(&model, &drive, passive).unwrap();
        let designed = swim(&model, &cycle, &Tolerance::default());

        // By way of the file, which names the passive joint.
        let text = cycle.gait_file(512).to_text();
        let read = GaitFile::parse(&text, "passive.gait".as_ref()).unwrap();
        assert_eq!(read.passive.unwrap().joint, JointName(joint));
        let gait = AnyGait::from_file(&read).unwrap();
        let table = GaitTable::from_fn(512, |u| gait.at(u).phi.into()).unwrap();

        let servo = ServoFile::default();
        let config = TwinConfig::new(&file, 1);
        let config = if ideal {
            config.with_ideal_servos()
        } else {
            config
        };
        let port = TwinPort::new(Twin::new(config).unwrap(), WireSpeed::robot());
        let mut robot = Robot::connect(port, 1).unwrap();
        robot
            .upload(table.bytes(), Duration::from_mins(1), |_| {
                ControlFlow::Continue(())
            })
            .unwrap();
        robot.arm(false).unwrap();
        robot
            .play(4, Duration::from_secs_f64(PERIOD_S), false)
            .unwrap();
        robot
            .wait_until_finished(|_| ControlFlow::Continue(()))
            .unwrap();
        let starts = robot.port().device().cycle_starts().to_vec();
        let step = starts[2].pose.inverse() * starts[3].pose;
        let share = step.position().norm() / designed.displacement.norm();
        println!(
            "{joint:?}, ideal {ideal}: limit cycle {:.6} m, tank {:.6} m",
            designed.displacement.norm(),
            step.position().norm()
        );
        // A dead band of one degree takes part of a stroke of 66°.
        let tolerance = if ideal { 5e-3 } else { 2e-2 };
        assert!((share - 1.0).abs() < tolerance, "{joint:?}: {share}");
        assert!(step.theta.abs() < 2e-3, "{}", step.theta);
        // The forecast of the played cycle knows table, ticks and dead band.
        let played = Played {
            servos: Servos {
                file: ServoFile {
                    dead_band: if ideal { 0.0 } else { servo.dead_band },
                    max_rate: if ideal { 1e3 } else { servo.max_rate },
                    ..servo
                },
                pulse_step_ns: 0,
            },
            period: PERIOD_S,
            knots: 512,
        };
        let predicted = forecast_passive(&model, &gait, &played, passive).unwrap();
        let (_, end) = predicted.ends().unwrap();
        let share = step.position().norm() / end.displacement.norm();
        println!("{joint:?}, ideal {ideal}: the tank swims {share:.6} of the forecast");
        assert!((share - 1.0).abs() < FORECAST, "{joint:?}: {share}");
        assert!((step.theta - end.rotation).abs() < 1e-4);
    }
}
