//! The monitor over simulated plays: false alarms, and faults within two cycles.

use std::sync::OnceLock;

use crate::virtual_lab::{Lab, MARGIN, Notice, TANK, Truth, model, planner, servos};
use experiment::{
    Course, CycleReport, GaitOnRobot, Likeness, Monitor, Pose, TankWalls, TrackedPlay,
};
use forecast::{Kind, Member};
use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_model::Gait as _;

const WALLS: TankWalls = TankWalls {
    tank: TANK,
    margin_m: MARGIN,
};

/// All members of full size, from rest with straight joints.
fn others() -> &'static [(Member, Course)] {
    static OTHERS: OnceLock<Vec<(Member, Course)>> = OnceLock::new();
    OTHERS.get_or_init(|| {
        let planner = planner();
        let members = Kind::ALL
            .into_iter()
            .flat_map(|kind| [1.0, -1.0].map(|amount| planner.member(kind, amount)));
        let course = |member: Member| {
            let table = planner.checked_table(&planner.step(member, 1)).unwrap();
            let rest = Vector2::zeros();
            (member, Course::of_play(&model(), &table, &servos(), rest))
        };
        members.map(course).collect()
    })
}

/// Reports of a few single cycles in a row; the robot plays `played` while `expected` is commanded. The monitor knows the other
/// members by name.
fn reports(
    truth: Truth,
    expected: Member,
    played: Member,
    cycles: u32,
    seed: u64,
) -> Vec<CycleReport> {
    let names = |other: &Member| *other != expected;
    reports_with(names, truth, expected, played, cycles, seed)
}

/// The same with a monitor that knows the members that `names` selects.
fn reports_with(
    names: impl Fn(&Member) -> bool,
    truth: Truth,
    expected: Member,
    played: Member,
    cycles: u32,
    seed: u64,
) -> Vec<CycleReport> {
    let planner = planner();
    let step = planner.step(expected, 1);
    let table = planner.checked_table(&step).unwrap();
    let mut rest = Vector2::zeros();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let heading = rng.random_range(-3.0..3.0);
    let mut lab = Lab::new(truth, swimmer_model::Pose::new(0.0, 0.0, heading), seed);
    let mut monitor = Monitor::new(model(), Some(WALLS));
    for (other, course) in others() {
        if names(other) {
            monitor.know(other.word(false), course.clone());
        }
    }
    // Played at the commanded period.
    let mut reports = Vec::new();
    for _ in 0..cycles {
        lab.start(planner.gait(&played), step);
        let mut resting = None;
        while resting.is_none_or(|since| lab.now < since + 0.5) {
            lab.advance();
            for pose in lab.arrived() {
                monitor.pose(&pose);
            }
            for notice in std::mem::take(&mut lab.notices) {
                match notice {
                    Notice::Began(time) => {
                        let course = Course::of_play(&model(), &table, &servos(), rest);
                        rest = course.last_shape();
                        monitor.begin(course, time + rng.random_range(-0.01..0.01));
                    }
                    Notice::AtRest => resting = Some(lab.now),
                }
            }
        }
        reports.extend(monitor.end());
    }
    reports
}

fn member(kind: Kind) -> Member {
    planner().member(kind, 1.0)
}

/// Robots that are as calibrated as a campaign leaves them: χ within 1 %, gains within 0.5 %.
fn calibrated(seed: u64) -> Truth {
    let mut rng = ChaCha8Rng::seed_from_u64(7000 + seed);
    let mut draw = |most: f64| 1.0 + rng.random_range(-most..most);
    Truth {
        chi_factor: draw(0.01),
        gain: [draw(0.005), draw(0.005)],
        blanks: 0.1,
        ..Truth::faultless()
    }
}

#[test]
fn a_hundred_faultless_runs_raise_at_most_one_alarm() {
    let mut alarms = Vec::new();
    let mut outside = [0, 0];
    let mut measured = 0;
    for (seed, kind) in (0..100).zip(Kind::ALL.into_iter().cycle()) {
        for report in reports(calibrated(seed), member(kind), member(kind), 5, seed) {
            if let Some(departure) = report.departure {
                alarms.push((seed, kind, departure));
            }
            if let Some(motion) = report.measured {
                measured += 1;
                // By 1 % of error in χ the prediction itself is off.
                let by_model = 0.02 * report.predicted.position().norm();
                let off = (motion.x_m - report.predicted.x).hypot(motion.y_m - report.predicted.y);
                outside[0] += u32::from(off > 1.25 * motion.interval_m + by_model);
                let turn_off = (motion.turn_rad - report.predicted.theta).abs();
                let by_model = 0.02 * report.predicted.theta.abs() + 0.002;
                outside[1] += u32::from(turn_off > motion.interval_rad + by_model);
            }
        }
    }
    println!(
        "100 faultless runs of 5 cycles: {} alarms {alarms:?}; of {measured} net motions {} and {} turns outside",
        alarms.len(),
        outside[0],
        outside[1]
    );
    assert!(alarms.len() <= 1, "{alarms:?}");
    assert!(
        outside.iter().all(|count| *count * 20 < measured),
        "{outside:?} of {measured}"
    );
}

/// Seeds of 20 in which two cycles are enough to name the fault.
fn flagged(
    name: &str,
    truth: impl Fn(Truth) -> Truth,
    kind: Kind,
    played: Member,
    is: impl Fn(&Likeness) -> bool,
) {
    let mut seen = 0;
    let mut other = Vec::new();
    for seed in 0..20 {
        let reports = reports(truth(calibrated(seed)), member(kind), played, 2, seed);
        let departure = reports.into_iter().find_map(|report| report.departure);
        match departure {
            Some(departure) if is(&departure.likeness) => seen += 1,
            found => other.push((seed, found)),
        }
    }
    println!("{name}, {kind:?}: flagged within two cycles in {seen} of 20 {other:?}");
    assert_eq!(seen, 20, "{name}: {other:?}");
}

#[test]
fn a_gain_five_percent_low_is_flagged() {
    for kind in Kind::ALL {
        let low = |truth: Truth| Truth {
            gain: truth.gain.map(|gain| gain * 0.95),
            ..truth
        };
        let is = |likeness: &Likeness| matches!(likeness, Likeness::Gain(gain) if (gain - 0.95).abs() < 0.015);
        flagged("gain -5 %", low, kind, member(kind), is);
    }
}

/// A turn is over after 1.5 s: what drifts less than 2 mm meanwhile is within the errors of its prediction.
#[test]
fn a_drift_is_flagged() {
    for (kind, speed) in [
        (Kind::Forward, 4e-4),
        (Kind::Left, 4e-4),
        (Kind::Turn, 15e-4),
    ] {
        let drifts = |truth: Truth| Truth {
            drift: [speed * 0.6, -speed * 0.8, 0.0],
            ..truth
        };
        let is = |likeness: &Likeness| {
            matches!(likeness, Likeness::Drift([x, y])
                if (x - speed * 0.6).hypot(y + speed * 0.8) < 0.4 * speed)
        };
        let name = format!("drift of {:.1} mm/s", speed * 1e3);
        flagged(&name, drifts, kind, member(kind), is);
    }
}

#[test]
fn a_blocked_joint_is_flagged() {
    for joint in [0, 1] {
        let blocked = |truth: Truth| Truth {
            blocked: Some((joint, 0.0)),
            ..truth
        };
        let number = if joint == 0 { 1 } else { 2 };
        let is = |likeness: &Likeness| *likeness == Likeness::BlockedJoint(number);
        for kind in Kind::ALL {
            flagged(
                &format!("joint {number} blocked"),
                blocked,
                kind,
                member(kind),
                is,
            );
        }
    }
}

#[test]
fn a_wrong_gait_is_flagged_and_named() {
    let same = |truth: Truth| truth;
    let cases = [
        (Kind::Forward, planner().member(Kind::Left, 1.0), "left"),
        (
            Kind::Forward,
            planner().member(Kind::Forward, -1.0),
            "backward",
        ),
        (Kind::Left, planner().member(Kind::Turn, 1.0), "turn-left"),
        (Kind::Turn, planner().member(Kind::Turn, -1.0), "turn-right"),
    ];
    for (kind, played, name) in cases {
        let is = |likeness: &Likeness| *likeness == Likeness::WrongGait(Some(name.to_owned()));
        flagged(&format!("{name} instead"), same, kind, played, is);
    }
}

/// A robot that was never calibrated is called that, or one of another gain, and not one that plays another gait. Its share of the
/// motion is that of a swimmer with its drag.
#[test]
fn a_robot_without_calibration_is_named() {
    for (chi_factor, radius_factor) in [(1.06, 0.95), (0.94, 1.05), (1.1, 0.92), (1.06, 1.0)] {
        for kind in Kind::ALL {
            let (mut named, mut shares) = (0, Vec::new());
            for seed in 0..10 {
                let truth = Truth {
                    chi_factor,
                    radius_factor,
                    ..calibrated(seed)
                };
                let reports = reports(truth, member(kind), member(kind), 3, seed);
                let departures: Vec<Likeness> = reports
                    .into_iter()
                    .filter_map(|report| Some(report.departure?.likeness))
                    .collect();
                for likeness in &departures {
                    assert!(
                        likeness.is_correctable(),
                        "{kind:?}, seed {seed}: {likeness:?}"
                    );
                    if let Likeness::Uncalibrated(share) = likeness {
                        shares.push(*share);
                    }
                }
                named += usize::from(!departures.is_empty());
            }
            let expected = share_of_motion(kind, chi_factor, radius_factor);
            println!(
                "χ × {chi_factor}, r_s × {radius_factor}, {kind:?}: named in {named} of 10, {} cycles as uncalibrated; true share {expected:.3}, \
                 found {shares:.3?}",
                shares.len()
            );
            assert!(
                shares
                    .iter()
                    .all(|share| (share / expected - 1.0).abs() < 0.05)
            );
            if kind == Kind::Forward && chi_factor > 1.09 {
                assert!(named == 10 && shares.len() >= 15, "{named} {shares:?}");
            }
        }
    }
}

/// Reports of a circle that is played on and on, as an experiment tracks it.
fn circle_reports(truth: Truth, degrees: f64, period_s: f64, seed: u64) -> Vec<CycleReport> {
    const CYCLES: u32 = 3;
    let circle = |degrees: f64| swimmer_files::AnyGait::circle(degrees.to_radians());
    let on_robot = |degrees: f64| {
        let table = forecast::table(&circle(degrees), 512).unwrap();
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // some seconds
        let period_us = (period_s * 1e6) as u32;
        GaitOnRobot::new(&model(), &table, period_us, &servos(), CYCLES)
    };
    let member = Member {
        kind: Kind::Forward,
        backwards: false,
        scale: 1.0,
    };
    let family = forecast::Family {
        gaits: [degrees; 3].map(|degrees| (circle(degrees), period_s)),
        mirrored: false,
    };
    let step = forecast::Step {
        cycles: CYCLES,
        period: period_s,
        ..planner().step(member, CYCLES)
    };
    let played = member.of(&family);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let heading = rng.random_range(-3.0..3.0);
    let mut lab = Lab::new(truth, swimmer_model::Pose::new(0.0, 0.0, heading), seed);
    lab.is_ramped_to(played.at(0.0).phi);
    lab.start(played, step);
    let others =
        [50.0, 60.0, 80.0, 90.0].map(|degrees| (format!("{degrees}deg"), on_robot(degrees)));
    let mut play: Option<TrackedPlay> = None;
    while play.as_ref().is_none_or(|play| !play.is_whole()) {
        lab.advance();
        for notice in std::mem::take(&mut lab.notices) {
            if let Notice::Began(time) = notice {
                let others = others
                    .iter()
                    .map(|(name, other)| (name.as_str(), &other.course));
                let began_s = time + rng.random_range(-0.01..0.01);
                let gait = on_robot(degrees);
                play = Some(TrackedPlay::new(
                    &model(),
                    Some(WALLS),
                    gait,
                    others,
                    began_s,
                    CYCLES,
                ));
            }
        }
        let arrived = lab.arrived();
        if let Some(play) = &mut play {
            for pose in &arrived {
                play.pose(pose);
            }
            while let Some(evaluation) = play.take_evaluation() {
                play.evaluated(evaluation.run());
            }
            assert!(lab.now < 100.0);
        }
    }
    play.unwrap().reports().to_vec()
}

/// A circle of a robot that was never calibrated is named within three cycles; a calibrated one raises no alarm.
#[test]
fn a_circle_without_calibration_is_named() {
    let mut failures = Vec::new();
    for period_s in [6.0, 12.0] {
        for (chi_factor, radius_factor) in [(1.06, 0.95), (0.94, 1.05), (1.0, 1.0)] {
            let (mut named, mut gains, mut likeness) = (0, Vec::new(), Vec::new());
            for seed in 0..10 {
                let truth = Truth {
                    chi_factor,
                    radius_factor,
                    ..calibrated(seed)
                };
                let reports = circle_reports(truth, 70.0, period_s, seed);
                gains.extend(reports.iter().filter_map(|report| Some(report.gain?[0])));
                let departure = reports.into_iter().find_map(|report| report.departure);
                named += u32::from(departure.is_some());
                likeness.extend(departure.map(|departure| departure.likeness));
            }
            let mean = gains.iter().sum::<f64>() / gains.len() as f64;
            println!(
                "circle of 70°, {period_s} s, χ × {chi_factor}, r_s × {radius_factor}: named within three cycles in {named} of 10, mean gain \
                 {mean:.3}, {likeness:?}"
            );
            let is_calibrated = (chi_factor - 1.0_f64).abs() < 1e-9;
            let enough = if is_calibrated {
                named == 0
            } else {
                named == 10
            };
            let is_correct = likeness.iter().all(Likeness::is_correctable);
            if !enough || !is_correct {
                failures.push((period_s, chi_factor, named));
            }
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

/// Net motion of a full cycle with another drag over the predicted one: of its position, or of its turn.
fn share_of_motion(kind: Kind, chi_factor: f64, radius_factor: f64) -> f64 {
    let mut swimmer = *model().swimmer();
    swimmer.chi *= chi_factor;
    swimmer.sphere_radius *= radius_factor;
    let course = &others()
        .iter()
        .find(|(other, _)| *other == member(kind))
        .unwrap()
        .1;
    let other = course.with_shapes(&swimmer_model::Model::new(&swimmer).unwrap(), |shape| shape);
    let (predicted, net) = (course.net(), other.net());
    if kind == Kind::Turn {
        net.theta / predicted.theta
    } else {
        net.position().dot(&predicted.position()) / predicted.position().norm_squared()
    }
}

/// No drag explains another gait, also if the monitor does not know it: it is found by the third cycle.
#[test]
fn an_unknown_gait_is_no_matter_of_calibration() {
    let cases = [
        (Kind::Forward, planner().member(Kind::Left, 1.0)),
        (Kind::Forward, planner().member(Kind::Forward, -1.0)),
        (Kind::Left, planner().member(Kind::Turn, 1.0)),
        (Kind::Left, planner().member(Kind::Left, -1.0)),
        (Kind::Turn, planner().member(Kind::Turn, -1.0)),
    ];
    for (kind, played) in cases {
        for seed in 0..10 {
            let truth = calibrated(seed);
            let reports = reports_with(|_| false, truth, member(kind), played, 3, seed);
            let departure = reports.into_iter().find_map(|report| report.departure);
            let named = departure.unwrap_or_else(|| panic!("{kind:?}, {played:?}, seed {seed}"));
            assert!(
                !named.likeness.is_correctable(),
                "{kind:?}, {played:?}: {named:?}"
            );
        }
    }
}

/// While the evaluation of a cycle takes seconds, the play goes on: a wall is noticed, and the results come in order.
#[test]
fn a_slow_evaluation_delays_no_stop() {
    let circle = swimmer_files::AnyGait::circle(1.2);
    let table = forecast::table(&circle, 512).unwrap();
    let course = Course::of_cycle(&model(), &table, 6_000_000, &servos());
    let gait = GaitOnRobot::steady(course.clone(), 6.0);
    let others = std::iter::empty();
    let mut play = TrackedPlay::new(&model(), Some(WALLS), gait.clone(), others, 10.0, 3);
    // A robot whose joints do not move, first in the middle of the tank, then at a wall.
    let pose = |time_s: f64, x_m: f64| Pose {
        time_s,
        x_m: x_m + 1e-4 * (time_s * 1e3).sin(),
        y_m: 0.0,
        heading_rad: 1e-3 * (time_s * 7e2).sin(),
        sigma_position_m: 1e-4,
        sigma_heading_rad: 1e-3,
    };
    let mut time_s = 10.0;
    while time_s < 22.5 {
        time_s += 0.01;
        play.pose(&pose(time_s, 0.0));
        assert!(!play.is_outside());
    }
    let first = play.take_evaluation().unwrap();
    let second = play.take_evaluation().unwrap();
    assert!(play.take_evaluation().is_none() && !play.is_evaluated());
    for _ in 0..10 {
        time_s += 0.01;
        play.pose(&pose(time_s, 0.5 * TANK.length));
    }
    assert!(play.is_outside(), "the wall is noticed meanwhile");
    // Results in another order, and those of another play, are ignored.
    let second = second.run();
    play.evaluated(second.clone());
    assert!(play.reports().is_empty());
    let mut other = Monitor::new(model(), None);
    other.begin(course, 3.0);
    play.evaluated(other.finish().unwrap().run());
    assert!(play.reports().is_empty() && play.departure().is_none());
    play.evaluated(first.run());
    play.evaluated(second);
    let departure = play.departure().unwrap();
    assert!(departure.since == 0 && play.is_evaluated(), "{departure:?}");
}

/// 2.343 s are 117.15 ticks: after 20 cycles a cycle begins with a tick again.
#[test]
fn courses_repeat_with_the_ticks() {
    let model = model();
    let table = forecast::table(&swimmer_files::AnyGait::circle(1.2), 512).unwrap();
    let servos = servos();
    let gait = |period_us, cycles| GaitOnRobot::new(&model, &table, period_us, &servos, cycles);
    let uneven = gait(2_343_000, 50);
    assert_eq!(uneven.course_of(1), uneven.course_of(21));
    let later = Course::of_first_cycles(&model, &table, 2_343_000, &servos, 22);
    let apart = later[21].net().position() - uneven.course_of(1).net().position();
    assert!(apart.norm() < 1e-9, "{apart}");
    assert_ne!(uneven.course_of(1), uneven.course_of(2));
    // The same path by another part of the player.
    let second = Course::of_cycle(&model, &table, 2_343_000, &servos);
    let apart = uneven.course_of(1).net().position() - second.net().position();
    assert!(apart.norm() < 1e-9, "{apart}");
    assert_eq!(gait(2_343_000, 3).course_of(2), uneven.course_of(2));
    let even = gait(2_400_000, 50);
    let apart = even.course_of(40).net().position() - even.course.net().position();
    assert!(apart.norm() < 1e-9, "{apart}");
    // The joints of each cycle begin where those of the cycle before end.
    for cycle in 1..25 {
        let before = uneven.course_of(cycle - 1).last_shape();
        let apart = (uneven.course_of(cycle).shape_at(0.0) - before).norm();
        assert!(apart < 1e-9, "cycle {cycle}: {apart}");
    }
}
