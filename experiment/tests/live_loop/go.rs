//! The whole loop in virtual time: a robot that the model does not describe exactly is driven to poses by what bad cameras see.

use crate::cameras::Faults;
use crate::virtual_lab::{DriveByFrames, FarPose, Lab, Truth, drive, drive_by_frames, planner};
use experiment::{Controller, Ending, Goal, Likeness, Options, Target};
use forecast::Kind;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_model::{Pose, wrapped_angle};

const WITHIN: [f64; 2] = [3e-3, 0.017_453_292_519_943_295];

/// Start and target of a seed: most of the tank's length apart.
fn trip(seed: u64) -> (Pose<f64>, Pose<f64>) {
    let mut rng = ChaCha8Rng::seed_from_u64(500 + seed);
    let mut pose = |x: f64| {
        Pose::new(
            x + rng.random_range(-0.05..0.05),
            rng.random_range(-0.08..0.08),
            rng.random_range(-0.8..0.8),
        )
    };
    (pose(-0.2), pose(0.2))
}

fn target(pose: &Pose<f64>) -> Target {
    Target {
        x_m: pose.x,
        y_m: pose.y,
        heading_rad: Some(pose.theta),
    }
}

/// Distance \[m\] and angle \[rad\].
fn off(one: &Pose<f64>, other: &Pose<f64>) -> [f64; 2] {
    [
        (one.position() - other.position()).norm(),
        wrapped_angle(one.theta - other.theta).abs(),
    ]
}

fn controller(goal: Goal) -> Controller {
    Controller::new(planner(), goal, Options::default(), 0.0)
}

/// End of the planned chain without feedback: the cycles follow each other without a rest.
fn open_loop(seed: u64) -> [f64; 2] {
    let (start, to) = trip(seed);
    let planner = planner();
    let chain = planner.chain(&start, &to, 0.005, 0.0).unwrap();
    let truth = Truth {
        upload_s: 0.02,
        ..Truth::hard(seed)
    };
    let mut lab = Lab::new(truth, start, seed);
    for step in chain {
        lab.start(planner.gait(&step.member), step);
        while !lab.is_at_rest() {
            lab.advance();
        }
    }
    off(&lab.pose, &to)
}

/// Origin of the poses.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Tracking {
    /// Poses with noise.
    Poses,
    /// Frames of cameras with all faults, through the pose filter.
    Frames,
}

/// Drives to the target of each seed; at most `missing` may end elsewhere, with a reason.
fn reached(tracking: Tracking, seeds: std::ops::Range<u64>, missing: usize) {
    let (mut reached, mut others, mut far) = (0, Vec::new(), 0);
    let count = seeds.end - seeds.start;
    for seed in seeds {
        let (start, to) = trip(seed);
        let mut lab = Lab::new(Truth::hard(seed), start, seed);
        let goal = Goal::Reach(vec![target(&to)]);
        let controller = match tracking {
            Tracking::Poses => {
                let mut controller = controller(goal);
                drive(&mut lab, &mut controller, 3600.0, |_, _| ());
                controller
            }
            Tracking::Frames => {
                let DriveByFrames {
                    controller,
                    counts,
                    far,
                    poses,
                } = drive_by_frames(&mut lab, &goal, Faults::ALL, seed, 3600.0);
                let worst = |of: fn(&FarPose) -> f64| far.iter().map(of).fold(0.0, f64::max);
                println!(
                    "seed {seed}: {counts:?}; {} of {poses} poses far off the truth, at most {:.1} mm and {:.1}°",
                    far.len(),
                    1e3 * worst(|pose| pose.off_m),
                    worst(|pose| pose.turned_rad).to_degrees()
                );
                assert!(counts.both < counts.frames * 4 / 5 && counts.swapped > 0);
                controller
            }
        };
        let [distance, angle] = off(&lab.pose, &to);
        let open = open_loop(seed);
        far += usize::from(open[0] >= 0.015);
        assert!(
            open[0] > WITHIN[0] || open[1] > WITHIN[1],
            "seed {seed}: open loop reaches it too"
        );
        println!(
            "seed {seed}: {:.2} mm and {:.2}° off after {} cycles, {:.0} s: {}; open loop {:.1} mm and {:.1}° off; learned {:?}",
            distance * 1e3,
            angle.to_degrees(),
            controller.cycles(),
            lab.now,
            controller
                .ending()
                .map(ToString::to_string)
                .unwrap_or_default(),
            open[0] * 1e3,
            open[1].to_degrees(),
            controller.learned()
        );
        assert!(!lab.touched_wall, "seed {seed} touched a wall");
        if controller.ending() == Some(&Ending::Reached)
            && distance <= WITHIN[0]
            && angle <= WITHIN[1]
        {
            reached += 1;
        } else {
            others.push((seed, controller.ending().cloned()));
        }
    }
    println!(
        "{reached} of {count} within 3 mm and 1°; open loop misses by 15 mm or more in {far}; others {others:?}"
    );
    assert!(others.len() <= missing, "{others:?}");
    assert!(
        others.iter().all(|(_, ending)| ending.is_some()),
        "{others:?}"
    );
    // A few seeds may be lucky.
    let most = count < 10 || far * 2 > usize::try_from(count).unwrap();
    assert!(most, "open loop misses by 15 mm in {far} of {count} only");
}

#[test]
fn targets_are_reached() {
    reached(Tracking::Poses, 0..2, 0);
}

#[test]
fn targets_are_reached_by_frames() {
    reached(Tracking::Frames, 0..2, 0);
}

#[test]
#[ignore = "soak: minutes"]
fn forty_targets_are_reached_by_frames() {
    reached(Tracking::Frames, 0..40, 2);
}

#[test]
#[ignore = "soak: minutes"]
fn forty_targets_are_reached() {
    reached(Tracking::Poses, 0..40, 2);
}

#[test]
#[ignore = "soak: a minute"]
fn a_square_of_way_points_is_driven() {
    for seed in 0..4 {
        let corners = [[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [-0.1, 0.05]];
        let targets = corners.map(|[x_m, y_m]| Target {
            x_m,
            y_m,
            heading_rad: Some(0.0),
        });
        let mut lab = Lab::new(Truth::hard(seed), Pose::new(0.0, 0.0, 0.2), seed);
        let mut controller = controller(Goal::Reach(targets.to_vec()));
        let mut nearest = [f64::INFINITY; 4];
        drive(&mut lab, &mut controller, 7200.0, |lab, _| {
            for (nearest, corner) in nearest.iter_mut().zip(corners) {
                if lab.is_at_rest() {
                    let distance = (lab.pose.x - corner[0]).hypot(lab.pose.y - corner[1]);
                    *nearest = nearest.min(distance);
                }
            }
        });
        println!(
            "square, seed {seed}: {} cycles, {:.0} s, corners within {:.2?} mm",
            controller.cycles(),
            lab.now,
            nearest.map(|distance| distance * 1e3)
        );
        assert_eq!(controller.ending(), Some(&Ending::Reached));
        assert!(
            nearest.iter().all(|distance| *distance <= WITHIN[0]),
            "{nearest:?}"
        );
        assert!(!lab.touched_wall);
    }
}

/// Joints of unequal gain and a turning drift: forward cycles alone would turn the robot.
#[test]
fn a_heading_is_held_over_twenty_cycles() {
    let truth = Truth {
        gain: [0.97, 1.0],
        drift: [2e-4, 0.0, 5e-4],
        ..Truth::hard(1)
    };
    // Without correction.
    let planner = planner();
    let start = Pose::new(-0.25, 0.0, 0.0);
    let mut free = Lab::new(truth, start, 1);
    let step = planner.step(planner.member(Kind::Forward, 1.0), 1);
    for _ in 0..20 {
        free.start(planner.gait(&step.member), step);
        while !free.is_at_rest() {
            free.advance();
        }
    }
    let mut lab = Lab::new(truth, start, 1);
    let mut controller = controller(Goal::Hold {
        heading_rad: 0.0,
        cycles: 20,
    });
    let mut worst: f64 = 0.0;
    drive(&mut lab, &mut controller, 3600.0, |lab, controller| {
        if lab.is_at_rest() && controller.cycles() > 0 {
            worst = worst.max(lab.pose.theta.abs());
        }
    });
    println!(
        "held: {:?}; heading within {:.2}° at rests over {} cycles; not held it ends at {:.1}°",
        controller.ending().map(ToString::to_string),
        worst.to_degrees(),
        controller.cycles(),
        free.pose.theta.to_degrees()
    );
    assert!(
        matches!(controller.ending(), Some(Ending::Held { .. })),
        "{:?}",
        controller.ending()
    );
    assert!(worst < 1.5 * WITHIN[1], "{}°", worst.to_degrees());
    assert!(
        free.pose.theta.abs() > 3.0 * worst,
        "{}°",
        free.pose.theta.to_degrees()
    );
}

/// The cameras go dark: the robot is at rest within the age of a pose, an upload and a cycle, and touches no wall.
#[test]
fn a_lost_track_ends_in_rest() {
    let planner = planner();
    let longest = Kind::ALL
        .map(|kind| planner.step(planner.member(kind, 1.0), 1).period)
        .into_iter()
        .fold(0.0, f64::max);
    let bound = Options::default().longest_age_s + 2.0 + longest + 0.5;
    let mut worst: f64 = 0.0;
    for moment in 0..10_u32 {
        let cut = 4.0 + 2.7 * f64::from(moment);
        // Along a wall, which the drift pushes it to.
        let truth = Truth {
            drift: [0.0, 2e-4, 0.0],
            cut_s: Some(cut),
            ..Truth::hard(moment.into())
        };
        let start = Pose::new(-0.2, 0.12, 0.0);
        let to = Target {
            x_m: 0.2,
            y_m: 0.12,
            heading_rad: Some(0.0),
        };
        let mut lab = Lab::new(truth, start, moment.into());
        let mut controller = controller(Goal::Reach(vec![to]));
        drive(&mut lab, &mut controller, 600.0, |_, _| ());
        assert!(
            matches!(controller.ending(), Some(Ending::TrackingLost { .. })),
            "cut at {cut} s: {:?}",
            controller.ending()
        );
        assert!(lab.is_at_rest() && !lab.touched_wall, "cut at {cut} s");
        worst = worst.max(lab.moved_last - cut);
    }
    println!("track cut at ten moments: at rest within {worst:.2} s, bound {bound:.2} s");
    assert!(worst <= bound, "{worst} s");
}

/// The same with frames: the filter reports no pose of a robot that it does not see.
#[test]
fn a_lost_stream_ends_in_rest() {
    let truth = Truth {
        cut_s: Some(16.0),
        ..Truth::hard(3)
    };
    let mut lab = Lab::new(truth, Pose::new(-0.2, 0.12, 0.0), 3);
    let to = target(&Pose::new(0.2, 0.12, 0.0));
    let goal = Goal::Reach(vec![to]);
    let controller = drive_by_frames(&mut lab, &goal, Faults::ALL, 3, 600.0).controller;
    assert!(matches!(
        controller.ending(),
        Some(Ending::TrackingLost { .. })
    ));
    assert!(lab.is_at_rest() && !lab.touched_wall);
}

#[test]
fn an_operators_stop_wins() {
    let mut lab = Lab::new(Truth::faultless(), Pose::new(-0.1, 0.0, 0.0), 3);
    let to = target(&Pose::new(0.2, 0.0, 0.0));
    let mut controller = controller(Goal::Reach(vec![to]));
    let mut stopped = None;
    drive(&mut lab, &mut controller, 60.0, |lab, controller| {
        let moving = lab.now - lab.moved_last < 0.02;
        if lab.now > 6.0 && moving && stopped.is_none() {
            controller.operator_stop();
            stopped = Some(lab.now);
        }
    });
    assert_eq!(controller.ending(), Some(&Ending::StoppedByOperator));
    assert!(
        lab.is_at_rest() && lab.now - stopped.unwrap() < 2.5,
        "{}",
        lab.now
    );
}

#[test]
fn a_blocked_joint_ends_the_run() {
    let truth = Truth {
        blocked: Some((1, 9.0)),
        ..Truth::faultless()
    };
    let mut lab = Lab::new(truth, Pose::new(-0.15, 0.0, 0.0), 4);
    let to = target(&Pose::new(0.2, 0.0, 0.0));
    let mut controller = controller(Goal::Reach(vec![to]));
    drive(&mut lab, &mut controller, 600.0, |_, _| ());
    let expected = Ending::Departed(Likeness::BlockedJoint(2));
    assert_eq!(controller.ending(), Some(&expected));
}

#[test]
fn a_target_outside_the_walls_has_no_way() {
    let mut lab = Lab::new(Truth::faultless(), Pose::new(0.0, 0.0, 0.0), 5);
    let to = target(&Pose::new(0.45, 0.0, 0.0));
    let mut controller = controller(Goal::Reach(vec![to]));
    drive(&mut lab, &mut controller, 60.0, |_, _| ());
    assert_eq!(controller.ending(), Some(&Ending::NoWay));
    assert_eq!(controller.cycles(), 0);
}
