//! Match of the clocks of robot and cameras: robot, host and cameras have clocks of their own, the link's pings take their time
//! unevenly, and the robot is not quite the model's.

use std::time::Duration;

use crate::virtual_lab::{Lab, Notice, Truth, model, planner, servos};
use experiment::{CameraDelay, Course, Delays, Pose, match_clocks};
use forecast::Kind;
use host_link::session::ClockSamples;
use link_protocol::Pong;
use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const SEEDS: u64 = 40;

#[test]
fn clocks_match_within_20_ms_on_all_seeds() {
    let planner = planner();
    let mut worst: f64 = 0.0;
    for seed in 0..SEEDS {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let kind = Kind::ALL[rng.random_range(0..3)];
        let robot_start: f64 = rng.random_range(-50.0..50.0);
        let camera_start: f64 = rng.random_range(-5000.0..5000.0);
        // Crystals differ by tens of ppm.
        let robot = |host: f64| robot_start + host * 1.000_04;
        let camera = |host: f64| camera_start + host * 0.999_97;

        let mut samples = ClockSamples::default();
        for second in 0..20 {
            let sent = f64::from(second) * 0.5;
            let [there, back] = [0.05, 0.2].map(|most| 0.004 + most * rng.random::<f64>());
            let us =
                |seconds: f64| u64::try_from(Duration::from_secs_f64(seconds).as_micros()).unwrap();
            let clock = |host: f64| us(robot(host) + 100.0);
            let pong = Pong {
                host_us: us(sent),
                received_us: clock(sent + there),
                sent_us: clock(sent + there + 0.001),
            };
            samples.push(&pong, Duration::from_secs_f64(sent + there + 0.001 + back));
        }
        let link = samples.fit().unwrap();
        let robot_of_host = |host: f64| link.robot_time(Duration::from_secs_f64(host)) - 100.0;

        let step = planner.step(planner.member(kind, 1.0), 1);
        let table = planner.checked_table(&step).unwrap();
        let course = Course::of_play(&model(), &table, &servos(), Vector2::zeros());
        let mut lab = Lab::new(
            Truth::hard(seed),
            swimmer_model::Pose::new(0.0, 0.0, 3.0),
            seed,
        );
        lab.start(planner.gait(&step.member), step);
        let (mut poses, mut began, mut delays) = (Vec::new(), None, Delays::default());
        while lab.now < 9.0 {
            lab.advance();
            for pose in lab.arrived() {
                let time_s = camera(pose.time_s);
                delays.push(time_s, robot_of_host(lab.now), 0.0);
                poses.push(Pose { time_s, ..pose });
            }
            for notice in std::mem::take(&mut lab.notices) {
                if let Notice::Began(host) = notice {
                    began = Some(robot(host));
                }
            }
        }
        let bounds = delays.bounds(0.3, link.uncertainty).unwrap();
        let found = match_clocks(&poses, &course, began.unwrap(), bounds)
            .unwrap_or_else(|| panic!("seed {seed}, {kind:?}: no match within {bounds:?}"));
        let truth = robot(5.0) - camera(5.0);
        let error = found.offset_s - truth;
        println!(
            "seed {seed} {kind:?}: {:.1} ms off, uncertainty {:.1} ms",
            error * 1e3,
            found.uncertainty_s * 1e3
        );
        worst = worst.max(error.abs());
        assert!(error.abs() <= 0.02, "seed {seed}: {error} s off");
    }
    println!(
        "clock match: {SEEDS} of {SEEDS} within 20 ms, worst {:.1} ms",
        worst * 1e3
    );
}

#[test]
fn a_robot_at_rest_matches_nothing() {
    let planner = planner();
    let step = planner.step(planner.member(Kind::Forward, 1.0), 1);
    let table = planner.checked_table(&step).unwrap();
    let course = Course::of_play(&model(), &table, &servos(), Vector2::zeros());
    let start = swimmer_model::Pose::new(0.0, 0.0, 0.0);
    let mut lab = Lab::new(Truth::faultless(), start, 1);
    let mut poses = Vec::new();
    while lab.now < 5.0 {
        lab.advance();
        poses.extend(lab.arrived());
    }
    assert_eq!(match_clocks(&poses, &course, 1.0, [-0.2, 0.2]), None);
}

/// Frames that state no latency date all poses late. Three plays show by how much.
#[test]
fn the_delay_of_the_cameras_is_measured_play_by_play() {
    let planner = planner();
    for seed in 0..8 {
        let mut rng = ChaCha8Rng::seed_from_u64(100 + seed);
        let late_s: f64 = rng.random_range(0.0..0.2);
        let start = swimmer_model::Pose::new(0.0, 0.0, 1.0);
        let mut lab = Lab::new(Truth::hard(seed), start, seed);
        let mut delay = CameraDelay::default();
        for kind in Kind::ALL {
            let step = planner.step(planner.member(kind, 1.0), 1);
            let table = planner.checked_table(&step).unwrap();
            let course = Course::of_play(&model(), &table, &servos(), Vector2::zeros());
            lab.start(planner.gait(&step.member), step);
            let until = lab.now + course.duration_s() + 4.0;
            while lab.now < until {
                lab.advance();
                for pose in lab.arrived() {
                    let time_s = pose.time_s + late_s;
                    delay.dated(&Pose { time_s, ..pose });
                }
                for notice in std::mem::take(&mut lab.notices) {
                    if let Notice::Began(host) = notice {
                        let link_error: f64 = rng.random_range(-0.01..0.01);
                        delay.began(course.clone(), host + link_error);
                    }
                }
            }
            let error = delay.delay_s().unwrap_or(f64::NAN) - late_s;
            println!("seed {seed} after {kind:?}: {:.1} ms off", error * 1e3);
            assert!(error.abs() <= 0.02, "seed {seed}, {kind:?}: {error} s off");
        }
        let pose = Pose {
            time_s: 7.0,
            x_m: 0.0,
            y_m: 0.0,
            heading_rad: 0.0,
            sigma_position_m: 1e-4,
            sigma_heading_rad: 1e-3,
        };
        assert!((delay.dated(&pose).time_s - 7.0 + late_s).abs() <= 0.02);
    }
}
