#![allow(clippy::cast_sign_loss, reason = "periods are above 0")]

use super::*;
use gait_optimizer::{DisplacementProblem, displacement};
use gait_player::GaitTable;
use gait_player::table::check::Checker;
use swimmer_files::Bounds;
use swimmer_model::{Gait as _, Links, Swimmer, Tolerance, swim};

/// Result of the robot's complete check of the table of a file: the shortest period that it allows \[µs\], and whether it allows
/// this one.
fn robots_word(file: &GaitFile, period: f64, max_rate: f64) -> (u32, bool) {
    let gait = AnyGait::from_file(file).unwrap();
    word_on(&crate::table(&gait, MAX_KNOTS).unwrap(), period, max_rate)
}

fn word_on(table: &GaitTable, period: f64, max_rate: f64) -> (u32, bool) {
    let links = Links {
        middle: 0.071,
        front: 0.137,
        back: 0.137,
    };
    let limits = Limits {
        max_rate: max_rate as f32,
        ..Limits::ROBOT
    };
    let facts = Checker::new().advance(table, &links, u32::MAX).unwrap();
    let period_us = (period * 1e6).round() as u32;
    let allowed = facts.allow_period(&limits, period_us).is_ok();
    (facts.min_period_us(&limits), allowed)
}

fn square(amplitude: f64) -> GaitFile {
    let corners = [0.0, 0.25, 0.5, 0.75];
    GaitFile {
        corners: corners.to_vec(),
        ..GaitFile::sampled(&AnyGait::square(amplitude), 256)
    }
}

/// Gaits with corners and without, of the paper's robot.
fn gaits() -> Vec<GaitFile> {
    let within = |bounds: Bounds| {
        let problem = DisplacementProblem {
            bounds,
            ..DisplacementProblem::new(Swimmer::robot())
        };
        displacement(&problem).unwrap().gait_file("robot")
    };
    let at_most = Bounds::within(2.8);
    vec![
        square(1.0),
        square(2.4),
        GaitFile::sampled(&AnyGait::circle(1.2), 256),
        within(at_most),
        within(Bounds {
            min_angle: Some(1.5),
            ..at_most
        }),
        within(Bounds {
            sector: true,
            ..at_most
        }),
        within(Bounds {
            sector: true,
            ..at_most.apart(0.005)
        }),
    ]
}

#[test]
fn what_is_promised_is_what_the_robot_takes() {
    let model = Model::new(&Swimmer::robot()).unwrap();
    let rate = 3.5;
    let mut refused_before = 0;
    for (number, file) in gaits().iter().enumerate() {
        let gait = AnyGait::from_file(file).unwrap();
        let of_curve = super::super::shortest_period(&gait, [rate; 2]).unwrap();
        let shortest = match timing_of_table(&model, file, 0.5 * of_curve, rate) {
            Err(TimingError::TooFast { shortest, .. }) => shortest,
            other => panic!("{number}: {other:?}"),
        };
        // Corners left as they are would cost up to a quarter.
        println!("{number}: curve {of_curve:.4} s, table {shortest:.4} s");
        assert!(
            (0.99..1.02).contains(&(shortest / of_curve)),
            "{number}: {shortest} {of_curve}"
        );
        let whole = swim(&model, &gait, &Tolerance::default()).displacement;
        for share in [1.0, 1.0001, 1.01, 1.1, 1.5, 4.0] {
            let period = shortest * share;
            let (timing, timed) = timing_of_table(&model, file, period, rate).unwrap();
            let (least_us, allowed) = robots_word(&timed, period, rate);
            assert!(
                allowed,
                "{number}: {period} s promised, {least_us} µs asked"
            );
            assert!((timing.period - period).abs() < 1e-12 && timing.efficiency_loss < 0.5);
            assert!((timing.shortest_period - shortest).abs() < 1e-12);
            let swum = AnyGait::from_file(&timed).unwrap();
            let moved = swim(&model, &swum, &Tolerance::default()).displacement;
            assert!(
                (moved - whole).norm() < 1e-4 * whole.norm(),
                "{number}: {moved} {whole}"
            );
            // With corners left as they are it would have been refused.
            let sampled = GaitTable::from_fn(MAX_KNOTS, |u| swum.at(u).phi.into()).unwrap();
            refused_before += usize::from(!word_on(&sampled, period, rate).1);
        }
    }
    assert!(refused_before > 6, "{refused_before}");
}

#[test]
fn with_time_to_spare_it_is_constant_power() {
    let model = Model::new(&Swimmer::robot()).unwrap();
    let file = square(1.0);
    let (timing, timed) = timing_of_table(&model, &file, 100.0, 3.5).unwrap();
    let gait = AnyGait::from_file(&file).unwrap();
    let free = Curve::new(&model, &gait).unwrap();
    let free = free.timing(100.0, f64::INFINITY);
    assert_eq!(timed, free.retime_file(&file));
    assert!((timing.energy / free.energy - 1.0).abs() < 1e-12 && timing.at_limit == 0.0);
}

#[test]
fn senseless_numbers_are_refused() {
    let model = Model::new(&Swimmer::robot()).unwrap();
    let timed = |period, rate| timing_of_table(&model, &square(1.0), period, rate);
    let shortest = |amplitude: f64, rate| {
        super::super::shortest_period(&AnyGait::circle(amplitude), [3.5, rate])
    };
    for rate in [0.0, -1.0, f64::NAN] {
        assert!(matches!(timed(5.0, rate), Err(TimingError::Rate { .. })));
        assert!(matches!(shortest(1.0, rate), Err(TimingError::Rate { .. })));
    }
    let still = GaitFile::sampled(&AnyGait::circle(0.0), 9);
    let still = timing_of_table(&model, &still, 5.0, 1.0).unwrap_err();
    assert_eq!(
        (still, shortest(0.0, 1.0)),
        (TimingError::Still, Err(TimingError::Still))
    );
    for period in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            timed(period, 1.0),
            Err(TimingError::Period { .. })
        ));
    }
}
