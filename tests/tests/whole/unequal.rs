//! A robot whose side links differ: the player's check, the odometer, the twin's tank and the walls of a tank, each against geometry
//! or integration of this test's own.

use std::ops::ControlFlow;
use std::time::Duration;

use forecast::{Part, Played, Servos, forecast, until_wall};
use gait_player::GaitTable;
use host_link::{LinkError, Robot};
use link_protocol::{Refusal, StateName};
use nalgebra::Vector2;
use swimmer_files::{AnyGait, ServoFile, SwimmerFile};
use swimmer_model::{Gait as _, Links, Model, Pose, Tolerance, swim};
use twin::{Twin, TwinConfig, TwinPort, WireSpeed};

const PERIOD_S: f64 = 20.0;

fn robot(front: f64, back: f64) -> SwimmerFile {
    let mut file = SwimmerFile::preset("robot").unwrap();
    file.swimmer.links = Links {
        front,
        back,
        ..file.swimmer.links
    };
    file
}

fn connect(file: &SwimmerFile) -> Robot<TwinPort> {
    let twin = Twin::new(TwinConfig::new(file, 1).with_ideal_servos()).unwrap();
    Robot::connect(TwinPort::new(twin, WireSpeed::robot()), 1).unwrap()
}

fn upload(robot: &mut Robot<TwinPort>, gait: &AnyGait) -> Result<(), LinkError> {
    let table = GaitTable::from_fn(512, |u| gait.at(u).phi.into()).unwrap();
    let sent = robot.upload(table.bytes(), Duration::from_mins(1), |_| {
        ControlFlow::Continue(())
    });
    sent.map(|_| ())
}

/// Tips and joints in the frame of the middle link: back tip, back joint, front joint, front tip.
fn body(links: &Links<f64>, phi: Vector2<f64>) -> [Vector2<f64>; 4] {
    let half = 0.5 * links.middle;
    let front = Vector2::new(half, 0.0);
    let (s1, c1) = phi.x.sin_cos();
    let (s2, c2) = phi.y.sin_cos();
    [
        Vector2::new(-c2, s2) * links.back - front,
        -front,
        front,
        front + Vector2::new(c1, s1) * links.front,
    ]
}

/// Distance of a point from a segment.
fn from_segment(point: Vector2<f64>, from: Vector2<f64>, to: Vector2<f64>) -> f64 {
    let way = to - from;
    let share = ((point - from).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
    (point - from - way * share).norm()
}

/// Distance of the side links; 0 if they cross.
fn apart(links: &Links<f64>, phi: Vector2<f64>) -> f64 {
    let [back_tip, back, front, front_tip] = body(links, phi);
    let side = |a: Vector2<f64>, b: Vector2<f64>, c: Vector2<f64>| (b - a).perp(&(c - a));
    let crossed = side(back, back_tip, front) * side(back, back_tip, front_tip) < 0.0
        && side(front, front_tip, back) * side(front, front_tip, back_tip) < 0.0;
    if crossed {
        return 0.0;
    }
    [
        from_segment(back_tip, front, front_tip),
        from_segment(back, front, front_tip),
        from_segment(front_tip, back, back_tip),
        from_segment(front, back, back_tip),
    ]
    .into_iter()
    .fold(f64::INFINITY, f64::min)
}

/// The robot refuses a gait by its own lengths, and so does the forecast.
#[test]
fn links_cross_by_the_lengths_of_both_sides() {
    let (mut refused, mut accepted) = (0, 0);
    for (front, back) in [(0.137, 0.137), (0.137, 0.05), (0.05, 0.137), (0.137, 0.1)] {
        let file = robot(front, back);
        let model = Model::new(&file.swimmer).unwrap();
        let mut robot = connect(&file);
        for amplitude in [2.2, 2.5, 2.8] {
            let gait = AnyGait::circle(amplitude);
            let least = (0..4096).fold(f64::INFINITY, |least: f64, k| {
                least.min(apart(
                    &file.swimmer.links,
                    gait.at(f64::from(k) / 4096.0).phi,
                ))
            });
            let sent = upload(&mut robot, &gait);
            println!(
                "{front} m, {back} m, {amplitude} rad: {:.2} mm, {sent:?}",
                least * 1e3
            );
            let played = Played {
                servos: Servos::on_the_robot(ServoFile::default()),
                period: PERIOD_S,
                knots: 512,
            };
            let predicted = forecast(&model, &gait, &played).unwrap();
            // The robot counts a link that folds onto the middle one, too.
            let gap = predicted.designed_gap.distance;
            assert!(gap <= least + 2e-5, "{gap}");
            assert_eq!(gap == 0.0, least == 0.0);
            // The margin is one degree at the tip of the longer link, 2.4 mm.
            if least == 0.0 {
                refused += 1;
                assert!(
                    matches!(
                        sent,
                        Err(LinkError::Refused {
                            refusal: Refusal::LinksCross { .. },
                            ..
                        })
                    ),
                    "{sent:?}"
                );
                assert!(predicted.refusal().is_some());
            } else if least > 5e-3 {
                accepted += 1;
                sent.unwrap();
                assert_eq!(predicted.refusal(), None);
            }
        }
    }
    assert!(refused >= 2 && accepted >= 8, "{refused}, {accepted}");
}

/// The tank moves the robot as the model swims, and the robot's own pose agrees.
#[test]
fn the_twin_and_the_odometer_swim_with_both_lengths() {
    for (front, back) in [(0.137, 0.09), (0.1, 0.14)] {
        let file = robot(front, back);
        let gait = AnyGait::circle(1.2);
        let model = Model::new(&file.swimmer).unwrap();
        let stroke = swim(&model, &gait, &Tolerance::default());
        let mut robot = connect(&file);
        upload(&mut robot, &gait).unwrap();
        robot.arm(false).unwrap();
        let period = Duration::from_secs_f64(PERIOD_S);
        robot.play(3, period, false).unwrap();
        let mut own = [None; 3];
        robot
            .wait_until_finished(|telemetry| {
                if let Some(telemetry) = telemetry
                    && telemetry.state == StateName::Playing
                    && let Some(begun) = own.get_mut(telemetry.cycle as usize)
                {
                    let link_protocol::Pose { x, y, theta } = telemetry.pose;
                    let [x, y, theta] = [x, y, theta].map(f64::from);
                    begun.get_or_insert(Pose::new(x, y, theta));
                }
                ControlFlow::Continue(())
            })
            .unwrap();
        let starts = robot.port().device().cycle_starts().to_vec();
        let step = starts[1].pose.inverse() * starts[2].pose;
        let share = step.position().norm() / stroke.displacement.norm();
        println!("{front} m, {back} m: the tank swims {share:.5} of the model's displacement");
        assert!((share - 1.0).abs() < 2e-3 && (step.theta - stroke.rotation).abs() < 1e-3);
        let own = own[1].unwrap().inverse() * own[2].unwrap();
        let share = own.position().norm() / stroke.displacement.norm();
        println!("  the odometer {share:.5}");
        assert!((share - 1.0).abs() < 2e-2 && own.theta.abs() < 5e-3);
        // A robot with equal links of the same total length swims another way.
        let equal = self::robot(0.5 * (front + back), 0.5 * (front + back));
        let other = swim(
            &Model::new(&equal.swimmer).unwrap(),
            &gait,
            &Tolerance::default(),
        );
        assert!(
            (other.displacement - stroke.displacement).norm() > 0.02 * stroke.displacement.norm()
        );
    }
}

/// The part that meets a wall first, and when, as the geometry of the whole path says; often the tip of the longer link.
#[test]
fn walls_are_met_where_the_links_reach() {
    let mut tips = [0, 0];
    for (front, back) in [(0.16, 0.08), (0.08, 0.16)] {
        let mut file = robot(front, back);
        file.swimmer.sphere_radius = 0.0;
        let links = file.swimmer.links;
        let model = Model::new(&file.swimmer).unwrap();
        let gait = AnyGait::circle(1.0);
        let tank = forecast::Tank {
            length: 2.0,
            width: 0.24,
        };
        let mut cycle = Vec::new();
        swimmer_model::trajectory(&model, &gait, &Tolerance::default(), 360, |point| {
            cycle.push(point);
        });
        let net = cycle.last().unwrap().pose;
        for heading in [0.0, 0.4, -0.4, 2.7, 3.5] {
            let start = Pose::new(0.0, 0.0, heading);
            let meeting = until_wall(&model, &gait, &tank, &start).unwrap();
            let mut began = start;
            let outside = |pose: &Pose<f64>, phi| {
                body(&links, phi).map(|point| {
                    let place = pose.position() + nalgebra::Rotation2::new(pose.theta) * point;
                    place.x.abs() >= 1.0 || place.y.abs() >= 0.12
                })
            };
            let parts = [
                Part::BackTip,
                Part::BackJoint,
                Part::FrontJoint,
                Part::FrontTip,
            ];
            let expected = (0..2000).find_map(|number| {
                let touched = cycle.iter().find_map(|point| {
                    let outside = outside(&(began * point.pose), point.phi);
                    let first = outside.iter().position(|outside| *outside)?;
                    Some((f64::from(number) + point.u, parts[first]))
                });
                began = began * net;
                touched
            });
            let (cycles, first) = expected.unwrap();
            println!("{front} m, {back} m at {heading} rad: {first:?} after {cycles:.3} cycles");
            assert_eq!(meeting.part, first);
            assert!(
                (meeting.cycles - cycles).abs() < 1.5 / 360.0,
                "{}",
                meeting.cycles
            );
            let longer = if front > back {
                Part::FrontTip
            } else {
                Part::BackTip
            };
            tips[usize::from(front > back)] += usize::from(first == longer);
        }
    }
    assert!(tips.iter().all(|tips| *tips >= 2), "{tips:?}");
}
