//! One fault at a time, with what the filter must say of it.

use experiment::{FilterEvent, FilterOptions, PoseFilter};
use pose_source::{Frame, RigidBody};
use swimmer_files::Reflectors;
use swimmer_model::{Pose, wrapped_angle};

use crate::cameras::{Faults, REACH_M, reflector};
use crate::seeds::filter;
use crate::swum::{filmed, side_markers, swum};

/// Filters frames; returns the events and the last pose.
fn filtered(frames: &[Frame]) -> (Vec<FilterEvent>, Option<experiment::Pose>) {
    let mut filter = filter(0.08);
    let events = frames
        .iter()
        .filter_map(|frame| filter.push(frame))
        .collect();
    (events, filter.pose())
}

#[track_caller]
fn assert_at(pose: Option<experiment::Pose>, truth: &Pose<f64>) {
    let pose = pose.expect("the robot is found");
    let off = (pose.x_m - truth.x).hypot(pose.y_m - truth.y);
    let turned = wrapped_angle(pose.heading_rad - truth.theta).abs();
    assert!(off < 1e-3 && turned < 0.02, "{off} m, {turned} rad");
}

/// The cameras are moved: what lies before and after is good, and the jump is reported as large as it is.
#[test]
fn a_jump_is_believed_after_a_few_frames_and_reported() {
    let mut poses = swum(600, 6.0, 3);
    for pose in &mut poses[300..] {
        *pose = Pose::new(0.2, 0.1, 0.4) * *pose;
    }
    let frames = filmed(&poses, Faults::NONE, 3);
    let (events, pose) = filtered(&frames);
    let [
        FilterEvent::Found,
        FilterEvent::Jumped {
            moved_m,
            turned_rad,
        },
    ] = events.as_slice()
    else {
        panic!("{events:?}");
    };
    let (before, after) = (poses[299], poses[300]);
    let moved = (after.position() - before.position()).norm();
    assert!((moved_m - moved).abs() < 5e-3, "{moved_m} for {moved}");
    assert!((turned_rad - 0.4).abs() < 0.05, "{turned_rad}");
    assert_at(pose, &poses[599]);
}

/// A few frames elsewhere are no jump.
#[test]
fn a_short_excursion_changes_nothing() {
    let poses = swum(600, 6.0, 4);
    let mut seen = poses.clone();
    for pose in &mut seen[300..303] {
        pose.x += 0.2;
    }
    let (events, pose) = filtered(&filmed(&seen, Faults::NONE, 4));
    assert_eq!(events, [FilterEvent::Found]);
    assert_at(pose, &poses[599]);
}

#[test]
fn a_robot_that_is_covered_is_lost_and_found_again() {
    let poses = swum(900, 6.0, 5);
    let mut frames = filmed(&poses, Faults::NONE, 5);
    for frame in &mut frames[300..500] {
        frame.markers.clear();
    }
    let (events, pose) = filtered(&frames);
    assert_eq!(
        events,
        [FilterEvent::Found, FilterEvent::Lost, FilterEvent::Found]
    );
    assert_at(pose, &poses[899]);
}

/// Labels that are exchanged for good in the middle change nothing; labels that were wrong at first are put right.
#[test]
fn exchanged_labels() {
    let poses = swum(900, 6.0, 6);
    let exchange = |frame: &mut Frame| {
        for marker in &mut frame.markers {
            marker.name = marker.name.take().map(|name| match name.as_str() {
                "Front" => "Back".to_owned(),
                _ => "Front".to_owned(),
            });
        }
    };
    let mut frames = filmed(&poses, Faults::NONE, 6);
    frames[400..].iter_mut().for_each(exchange);
    let (events, pose) = filtered(&frames);
    assert_eq!(events, [FilterEvent::Found]);
    assert_at(pose, &poses[899]);

    let mut frames = filmed(&poses, Faults::NONE, 6);
    frames[..20].iter_mut().for_each(exchange);
    let (events, pose) = filtered(&frames);
    assert_eq!(events, [FilterEvent::Found, FilterEvent::TurnedRound]);
    assert_at(pose, &poses[899]);
}

/// One reflector hidden for longer than any burst: the other holds the position.
#[test]
fn one_reflector_alone_holds_the_position() {
    let poses = swum(700, 6.0, 7);
    let mut frames = filmed(&poses, Faults::NONE, 7);
    for frame in &mut frames[400..440] {
        frame
            .markers
            .retain(|marker| marker.name.as_deref() == Some("Front"));
    }
    let mut filter = filter(0.08);
    for (frame, truth) in frames[..440].iter().zip(&poses) {
        filter.push(frame);
        if frame.stamp_s > 1004.0 {
            let pose = filter.pose().unwrap();
            assert!((pose.x_m - truth.x).hypot(pose.y_m - truth.y) < 3e-3);
        }
    }
    assert_eq!(filter.counts().one, 40);
    let age_s = filter.age_s(frames[439].received_s).unwrap();
    assert!((age_s - 0.08).abs() < 1e-6, "{age_s}");
}

#[test]
fn a_clock_that_was_set_begins_anew() {
    let poses = swum(600, 6.0, 8);
    let mut frames = filmed(&poses, Faults::NONE, 8);
    for frame in &mut frames[300..] {
        frame.stamp_s -= 900.0;
    }
    // One that was overtaken is left out.
    frames.swap(100, 101);
    let (events, pose) = filtered(&frames);
    assert_eq!(
        events,
        [
            FilterEvent::Found,
            FilterEvent::ClockSet,
            FilterEvent::Found
        ]
    );
    assert_at(pose, &poses[599]);
}

/// Reflectors on the side links show the joint angles.
#[test]
fn side_reflectors_show_the_joints() {
    let poses = swum(800, 6.0, 9);
    let mut frames = filmed(&poses, Faults::NONE, 9);
    let angles = |frame: f64| [0.8 * (0.01 * frame).sin(), -1.1 * (0.012 * frame).cos()];
    for (number, (frame, pose)) in frames.iter_mut().zip(&poses).enumerate() {
        frame
            .markers
            .extend(side_markers(pose, angles(number as f64)));
    }
    let mut filter = filter(0.08);
    let mut compared = 0;
    for (number, frame) in frames.iter().enumerate() {
        filter.push(frame);
        if let [Some(front), Some(back)] = filter.joints() {
            let truth = angles(number as f64);
            assert!(
                (front.angle_rad - truth[0]).abs() < 0.05,
                "{front:?} {truth:?}"
            );
            assert!(
                (back.angle_rad - truth[1]).abs() < 0.05,
                "{back:?} {truth:?}"
            );
            compared += 1;
        }
    }
    assert!(compared > 700, "{compared}");
}

/// A rigid body is the pose; markers are not needed. A few frames in which it is solved wrongly change nothing.
#[test]
fn a_rigid_body_is_the_pose() {
    let poses = swum(800, 6.0, 10);
    let mut frames = filmed(&poses, Faults::NONE, 10);
    for (number, (frame, pose)) in frames.iter_mut().zip(&poses).enumerate() {
        frame.markers.clear();
        let wrong = if (400..403).contains(&number) {
            2.0
        } else {
            0.0
        };
        let half = 0.5 * (pose.theta + wrong);
        frame.bodies.push(RigidBody {
            id: 7,
            name: Some("robot".to_owned()),
            position: [pose.x, pose.y, 0.05],
            quaternion: [0.0, 0.0, half.sin(), half.cos()],
        });
    }
    let reflectors = Reflectors {
        front: reflector("Front", REACH_M),
        back: reflector("Back", -REACH_M),
        sides: None,
        body: Some(swimmer_files::RigidBody::named("robot".to_owned())),
    };
    let mut filter = PoseFilter::new(FilterOptions::new(reflectors, 2.0 * REACH_M)).unwrap();
    let events: Vec<_> = frames
        .iter()
        .filter_map(|frame| filter.push(frame))
        .collect();
    assert_eq!(events, [FilterEvent::Found]);
    assert!(filter.knows_front());
    assert_at(filter.pose(), poses.last().unwrap());
    // A frame gives its pose once.
    let received_s = frames.last().unwrap().received_s;
    assert!(filter.take_pose(received_s).is_some() && filter.take_pose(received_s).is_none());
}

/// Points without names: the caller knows roughly where the robot heads, and either order of the points comes out right.
#[test]
fn a_heading_settles_the_front_of_points_without_names() {
    let poses = swum(600, 6.0, 5);
    let mut frames = filmed(&poses, Faults::NONE, 5);
    for marker in frames.iter_mut().flat_map(|frame| &mut frame.markers) {
        marker.name = None;
    }
    for opposite in [false, true] {
        let mut filter = filter(0.08);
        for (frame, truth) in frames.iter().zip(&poses) {
            filter.push(frame);
            if filter.is_tracked() && !filter.knows_front() {
                let turn = if opposite { std::f64::consts::PI } else { 0.0 };
                assert!(filter.face(truth.theta + turn + 1.0));
            }
        }
        assert!(filter.knows_front());
        let turn = if opposite { std::f64::consts::PI } else { 0.0 };
        let last = poses[599];
        assert_at(filter.pose(), &Pose::new(last.x, last.y, last.theta + turn));
    }
}
