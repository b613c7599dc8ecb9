//! The fastest gait within limits on power, rates and torque, against an independent direct method: nothing is faster.

mod changed;
mod plane;
mod speed_curved;

use std::time::Instant;

use changed::{Change, rounded};
use gait_optimizer::{
    Bounds, Branch, EfficiencyError, EfficiencyProblem, LimitedProblem, Objective, Torque, Verdict,
    certify, efficiency, fastest_within,
};
use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_files::{AnyGait, GaitFile};
use swimmer_model::{Gait as _, Links, Model, Swimmer, Tolerance, swim};

use speed_curved::{Curved, least_time};

const ELEMENTS: usize = 40;

/// The direct method from random starts reaches curves that can be swum within all limits: none is faster than the answer. By
/// what share the best is slower, which is what a corner within an element costs where a start led to the same gait.
#[track_caller]
fn nothing_faster(problem: LimitedProblem, starts: usize) -> f64 {
    let found = fastest_within(&problem, &|_| ()).unwrap();
    let speed = found.speed_over_length;
    let max_angle = problem.bounds.max_angle.unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut best = 0.0_f64;
    for start in 0..starts {
        let mut draw = |largest: f64| rng.random_range(-largest..largest);
        // Ellipses of any place, size and tilt; the first is nearly a circle.
        let centre = Vector2::new(draw(0.6), draw(0.6));
        let size = 0.55 + draw(0.35);
        let turn = if start == 0 { 0.0 } else { draw(0.5) };
        let curve = |s: f64| {
            let circle = Vector2::new(s.cos(), (s + turn).sin()) * size;
            (circle + centre * (1.0 - size)) * max_angle
        };
        let climbed = Curved::new(&problem, ELEMENTS, curve).climb(speed);
        println!("  {climbed:.12} of {speed:.12}");
        best = best.max(climbed);
    }
    let off = best / speed - 1.0;
    println!(
        "{:?}: {speed:.12}, direct {best:.12}: {off:.1e}",
        found.limits
    );
    assert!(off < 1e-6, "{best} {speed}");
    -off
}

fn robot(power: Option<f64>, rates: Option<[f64; 2]>, torque: Option<Torque>) -> LimitedProblem {
    LimitedProblem {
        swimmer: Swimmer::robot(),
        bounds: Bounds::within(2.0),
        power_over_viscosity: power,
        rates,
        torque,
        threads: 2,
    }
}

#[test]
fn nothing_is_faster_on_power_and_rate() {
    let slower = nothing_faster(robot(Some(5e-3), Some([1.0; 2]), None), 2);
    assert!(slower < 1e-5, "{slower}");
}

#[test]
fn nothing_is_faster_on_torque() {
    let torque = Torque {
        stall_over_viscosity: 5e-3,
        no_load_rate: 2.0,
    };
    let slower = nothing_faster(robot(None, None, Some(torque)), 2);
    assert!(slower < 1e-5, "{slower}");
}

/// On all of them, on weak servos, and of another swimmer, from more starts.
#[test]
#[ignore = "minutes: part of the soak"]
fn nothing_is_faster_anywhere() {
    let torque = |stall_over_viscosity: f64| {
        Some(Torque {
            stall_over_viscosity,
            no_load_rate: 2.0,
        })
    };
    let purcell = |power: Option<f64>, torque: Option<Torque>| LimitedProblem {
        swimmer: Swimmer::purcell(),
        ..robot(power, Some([1.0; 2]), torque)
    };
    for problem in [
        robot(Some(5e-3), Some([1.0; 2]), None),
        robot(Some(5e-3), Some([1.0; 2]), torque(5e-3)),
        purcell(Some(0.4), None),
    ] {
        let slower = nothing_faster(problem, 10);
        assert!(slower < 1e-5, "{slower}");
    }
    // Few starts lead to the fastest gaits of these.
    nothing_faster(robot(None, None, torque(1e-3)), 10);
    nothing_faster(purcell(Some(0.4), torque(0.4)), 10);
}

/// Powers from where it binds alone to where it never does, with rates of 1 rad/s: more is never slower, no gait is faster than with
/// one limit alone, and every file passes its certificate. By how many powers there was no answer.
#[track_caller]
fn more_power_is_never_slower(swimmer: Swimmer<f64>, max_angle: f64, powers: &[f64]) -> usize {
    let asked = |power: Option<f64>, rates: Option<[f64; 2]>| {
        let problem = LimitedProblem {
            swimmer,
            bounds: Bounds::within(max_angle),
            ..robot(power, rates, None)
        };
        fastest_within(&problem, &|_| ())
    };
    let at_rate = asked(None, Some([1.0; 2])).unwrap().speed_over_length;
    let on_one = asked(Some(1.0), None).unwrap().speed_over_length;
    let (mut before, mut unanswered) = (0.0, 0);
    for &power in powers {
        let begun = Instant::now();
        let found = match asked(Some(power), Some([1.0; 2])) {
            Ok(found) => found,
            Err(error) => {
                println!("{max_angle} {power:e}: {error}");
                unanswered += 1;
                continue;
            }
        };
        let speed = found.speed_over_length;
        println!(
            "{max_angle} {power:e}: {speed:.12} {:?} {:?} in {:.1} s",
            found.limits,
            found.uncertified,
            begun.elapsed().as_secs_f64()
        );
        assert!(speed >= before * (1.0 - 1e-9), "{power}");
        assert!(
            speed <= at_rate.min(on_one * power.sqrt()) * (1.0 + 1e-7),
            "{power}"
        );
        let file = found.gait.gait_file("");
        let certificate = certify(&swimmer, &file, file.objective, &file.bounds).unwrap();
        assert!(certificate.pass(), "{power}: {}", certificate.failures());
        before = speed;
    }
    unanswered
}

#[test]
fn more_power_is_never_slower_between_the_limits() {
    let powers = [0.2, 0.4, 0.5, 0.8];
    assert_eq!(
        more_power_is_never_slower(Swimmer::purcell(), 2.6, &powers),
        0
    );
    // Here the power hardly binds.
    assert_eq!(
        more_power_is_never_slower(Swimmer::robot(), 2.0, &[7.792e-3]),
        0
    );
}

/// Quicker servos are never slower on the same power, and a time runs as fast for everybody: with s times the rates and s² times the
/// power the same gait is s times as fast.
#[track_caller]
fn a_higher_rate_is_never_slower(swimmer: Swimmer<f64>, power: f64, rates: &[f64]) {
    let speed = |power: f64, rate: f64| {
        let problem = LimitedProblem {
            swimmer,
            ..robot(Some(power), Some([rate; 2]), None)
        };
        let found = fastest_within(&problem, &|_| ()).unwrap();
        println!(
            "{power} {rate}: {:.12} {:?}",
            found.speed_over_length, found.limits
        );
        assert_eq!(found.limits.len(), 2);
        assert!(found.gait.certificate.pass());
        found.speed_over_length
    };
    let speeds: Vec<f64> = rates.iter().map(|rate| speed(power, *rate)).collect();
    assert!(
        speeds.windows(2).all(|pair| pair[1] > pair[0]),
        "{speeds:?}"
    );
    let scaled = speed(power * 1.3_f64.powi(2), rates[0] * 1.3) / 1.3;
    assert!((scaled / speeds[0] - 1.0).abs() < 1e-10, "{scaled}");
}

#[test]
fn a_higher_rate_is_never_slower_on_the_same_power() {
    a_higher_rate_is_never_slower(Swimmer::robot(), 5e-3, &[0.9, 1.0, 1.25]);
    a_higher_rate_is_never_slower(Swimmer::purcell(), 0.4, &[0.85, 1.0, 1.2]);
}

/// The same where power and rate take turns a dozen times.
#[test]
#[ignore = "minutes: part of the soak"]
fn a_higher_rate_is_never_slower_over_many() {
    for (swimmer, power, least) in [
        (Swimmer::robot(), 3e-3, 0.7),
        (Swimmer::purcell(), 0.4, 0.75),
    ] {
        let rates: Vec<f64> = (0..10).map(|k| least * 1.05_f64.powi(k)).collect();
        a_higher_rate_is_never_slower(swimmer, power, &rates);
    }
}

/// Stronger servos are never slower, and the weakest are as fast as they are strong: they never come near the rate at which they give
/// nothing.
#[test]
fn weak_servos_are_as_fast_as_they_are_strong() {
    let speeds = [1e-5, 3.4e-4, 1e-3].map(|stall_over_viscosity| {
        let torque = Torque {
            stall_over_viscosity,
            no_load_rate: 2.0,
        };
        let found = fastest_within(&robot(None, None, Some(torque)), &|_| ()).unwrap();
        println!("{stall_over_viscosity}: {:.12}", found.speed_over_length);
        assert!(found.gait.certificate.pass());
        found.speed_over_length / stall_over_viscosity
    });
    // Each is slower than in proportion, for what its rate takes of its torque.
    assert!(speeds[0] > speeds[1] && speeds[1] > speeds[2], "{speeds:?}");
    assert!(speeds[2] > 0.8 * speeds[0], "{speeds:?}");
}

/// From where the power alone binds to where it never does.
#[test]
#[ignore = "minutes: part of the soak"]
fn more_power_is_never_slower_over_many() {
    let mut unanswered = 0;
    for (swimmer, least) in [(Swimmer::robot(), 2e-3), (Swimmer::purcell(), 0.12)] {
        for max_angle in [2.0, 2.6] {
            let powers: Vec<f64> = (0..16).map(|k| least * 1.12_f64.powi(k)).collect();
            let here = more_power_is_never_slower(swimmer, max_angle, &powers);
            println!("{max_angle}: {here} of {} without an answer", powers.len());
            unanswered += here;
        }
    }
    assert_eq!(unanswered, 0);
}

fn verdict(file: &GaitFile) -> (Verdict, String) {
    let certificate = certify(&Swimmer::robot(), file, file.objective, &file.bounds).unwrap();
    (certificate.verdict(), certificate.failures())
}

/// A file holds no limits, and none the less tells whether its gait is the fastest within those that it takes in full: it passes
/// wherever it begins and whichever way it runs, does not fail for its samples, and fails for certain where it was changed.
#[test]
fn files_of_gaits_that_several_limits_bind_are_certified() {
    let torque = Torque {
        stall_over_viscosity: 5e-3,
        no_load_rate: 2.0,
    };
    let problems = [
        robot(Some(5e-3), Some([1.0; 2]), None),
        robot(None, None, Some(torque)),
    ];
    let files = problems.map(|problem| {
        let found = fastest_within(&problem, &|_| ()).unwrap();
        found.gait.gait_file("robot")
    });
    for file in &files {
        let read = GaitFile::parse(&file.to_text(), "a.gait".as_ref()).unwrap();
        let begun = file.begun_at(file.u.partition_point(|&u| u < 1.0 / 3.0));
        for (what, told) in [("read", read), ("back", file.reversed()), ("begun", begun)] {
            let (said, why) = verdict(&told);
            assert_eq!(said, Verdict::Pass, "{what}: {why}");
        }
        for digits in [9, 6] {
            let (said, why) = verdict(&rounded(file, digits));
            assert_ne!(said, Verdict::Fail, "{digits} digits: {why}");
        }
    }
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for asked in 0..100 {
        let file = &files[asked % 2];
        let change = Change::drawn(&mut rng);
        let perturbed = change.of(file, asked / 2 % Change::KINDS, &mut rng);
        let (said, why) = verdict(&perturbed);
        assert_eq!(said, Verdict::Fail, "{asked}, {change:?}: {why}");
    }
}

/// |d|/(L T) of a file's curve run as fast as the limits let it, pushed by two waves: by so much of the first, and by as much of the second as
/// it takes to turn nothing.
fn pushed(problem: &LimitedProblem, file: &GaitFile, waves: &[Wave; 2], size: f64) -> Option<f64> {
    let model = Model::new(&problem.swimmer.of_unit_length()).unwrap();
    let max_angle = problem.bounds.max_angle.unwrap_or(f64::INFINITY);
    let gait = |sizes: [f64; 2]| {
        let push = |u: f64| wave(&waves[0], u) * sizes[0] + wave(&waves[1], u) * sizes[1];
        let shapes = file.u.iter().zip(&file.phi);
        let shapes =
            shapes.map(|(u, phi)| (phi + push(*u)).map(|a| a.clamp(-max_angle, max_angle)));
        let file = GaitFile {
            phi: shapes.collect(),
            ..file.clone()
        };
        AnyGait::from_file(&file).unwrap()
    };
    let swum = |other: f64| swim(&model, &gait([size, other]), &Tolerance::default());
    let (mut before, mut other) = ((size, swum(size).rotation), 0.0);
    for _ in 0..20 {
        let rotation = swum(other).rotation;
        if rotation.abs() < 1e-10 {
            let gait = gait([size, other]);
            let places = (0..4000).map(|k| gait.at((f64::from(k) + 0.5) / 4000.0));
            let period = places.map(|at| least_time(problem, &model, &at.phi, &at.rate));
            return Some(swum(other).displacement.norm() / (period.sum::<f64>() / 4000.0));
        }
        let slope = (rotation - before.1) / (other - before.0);
        before = (other, rotation);
        other -= rotation / slope;
    }
    None
}

/// Sines and cosines of the cycle.
type Wave = [[Vector2<f64>; 2]; 3];

fn wave(wave: &Wave, u: f64) -> Vector2<f64> {
    let halves = (1..).zip(wave).map(|(k, [cosine, sine])| {
        let angle = std::f64::consts::TAU * f64::from(k) * u;
        cosine * angle.cos() + sine * angle.sin()
    });
    halves.sum()
}

/// By random pushes of any size nothing near an answer is faster. The direct method leaves a saddle that is pushed aside for a faster gait, and
/// the certificate refuses it for that alone: on a given power, the most efficient gait with the paper's symmetries of a swimmer whose
/// better gaits have none.
#[test]
fn a_saddle_fails_the_second_order_condition_alone() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let still = [[[Vector2::zeros(); 2]; 3]; 2];
    let problem = robot(Some(5e-3), Some([1.0; 2]), None);
    let found = fastest_within(&problem, &|_| ()).unwrap();
    let file = found.gait.gait_file("robot");
    let here = pushed(&problem, &file, &still, 0.0).unwrap();
    let mut draw = || rng.random_range(-1.0..1.0);
    let mut least = f64::INFINITY;
    for size in (0..60).map(|k| 1e-3 * 2.0_f64.powi(k % 8)) {
        let waves = std::array::from_fn(|_| {
            std::array::from_fn(|_| [(); 2].map(|()| Vector2::new(draw(), draw())))
        });
        if let Some(speed) = pushed(&problem, &file, &waves, size) {
            least = least.min(1.0 - speed / here);
        }
    }
    println!("answer: at least {least:.1e} slower");
    assert!(least > 0.0 && least.is_finite(), "{least}");

    let long = Links {
        middle: 0.4,
        front: 1.0,
        back: 1.0,
    };
    let swimmer = Swimmer {
        links: long,
        chi: 2.6,
        ..Swimmer::purcell()
    };
    let refused = efficiency(&EfficiencyProblem {
        quarter_samples: 1024,
        ..EfficiencyProblem::new(swimmer, Branch::Large)
    });
    let Err(EfficiencyError::Saddle { gait: saddle, .. }) = refused else {
        panic!("{refused:?}");
    };
    let problem = LimitedProblem {
        swimmer,
        bounds: Bounds::default(),
        ..robot(Some(1.0), None, None)
    };
    let file = GaitFile {
        objective: Objective::Speed,
        ..saddle.gait_file("")
    };
    let certificate = certify(&swimmer, &file, file.objective, &file.bounds).unwrap();
    println!("saddle: {}", certificate.failures());
    assert_eq!(certificate.verdict(), Verdict::Fail);
    assert!(certificate.failures().starts_with("second_variation_least"));
    assert!(!certificate.failures().contains(','));
    let here = pushed(&problem, &file, &still, 0.0).unwrap();
    let gait = AnyGait::from_file(&file).unwrap();
    let aside = [[Vector2::new(draw(), draw()) * 0.05; 2]; 3];
    let curve = |angle: f64| {
        let u = angle / std::f64::consts::TAU;
        gait.at(u).phi + wave(&aside, u)
    };
    let beside = Curved::new(&problem, 24, curve).climb(0.0);
    println!("saddle: {here:.9}, beside it {beside:.9}");
    assert!(beside > 1.01 * here, "{beside} {here}");
}
