//! The fastest gait within limits on power, rates and torque, against an independent direct method: nothing is faster.

mod plane;
mod speed_direct;

use gait_optimizer::{Bounds, LimitedProblem, SpeedProblem, Torque, fastest_within};
use nalgebra::{Matrix2, Vector2};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_model::Swimmer;

use speed_direct::{Direct, Gauge};

const SIDES: usize = 24;

/// The direct method from random starts reaches polygons that can be swum within all limits: none is faster than the answer, and
/// the best is as fast but for the few percent that straight sides cost.
#[track_caller]
fn nothing_faster(problem: LimitedProblem, starts: usize) {
    let found = fastest_within(&problem, &|_| ()).unwrap();
    let speed = found.speed_over_length;
    let volume = problem.swimmer.total_length().powi(3);
    let gauges = || {
        let mut gauges: Vec<Gauge> = Vec::new();
        if let Some(power) = problem.power_over_viscosity.map(|power| power / volume) {
            gauges.push(Box::new(move |w, v| (v.dot(&(w * v)) / power).sqrt()));
        }
        if let Some(torque) = problem.torque {
            for (joint, of_torque, of_rate) in
                (0..8).map(|k| (k % 2, [1.0, -1.0][k / 2 % 2], [1.0, -1.0][k / 4]))
            {
                let stall = torque.stall_over_viscosity / volume;
                gauges.push(Box::new(move |w: &Matrix2<f64>, v: &Vector2<f64>| {
                    of_torque * (w * v)[joint] / stall + of_rate * v[joint] / torque.no_load_rate
                }));
            }
        }
        gauges
    };
    let asked = SpeedProblem {
        bounds: problem.bounds,
        ..SpeedProblem::new(problem.swimmer, problem.rates.unwrap_or([1e3; 2]))
    };
    let max_angle = problem.bounds.max_angle.unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut best = 0.0_f64;
    for start in 0..starts {
        let mut draw = |largest: f64| rng.random_range(-largest..largest);
        let centre = Vector2::new(draw(0.6), draw(0.6));
        let size = 0.55 + draw(0.35);
        let turn = if start == 0 { 0.0 } else { draw(0.5) };
        let curve = |s: f64| {
            let circle = Vector2::new(s.cos(), (s + turn).sin()) * size;
            (circle + centre * (1.0 - size)) * max_angle
        };
        let mut direct = Direct::new(&asked, SIDES, curve).limited(gauges());
        if direct.climb().is_some() {
            println!("  {:.12} of {speed:.12}", direct.swimmable());
            best = best.max(direct.swimmable());
        }
    }
    println!("{:?}: {speed:.12}, direct {best:.12}", found.limits);
    assert!(best <= speed * (1.0 + 1e-6), "{best} {speed}");
    assert!(best > speed * 0.95, "{best} {speed}");
}

fn robot(power: Option<f64>, rates: Option<[f64; 2]>, torque: Option<Torque>) -> LimitedProblem {
    LimitedProblem {
        swimmer: Swimmer::robot(),
        bounds: Bounds {
            max_angle: Some(2.0),
            ..Bounds::default()
        },
        power_over_viscosity: power,
        rates,
        torque,
        threads: 2,
    }
}

#[test]
fn nothing_is_faster_on_power_and_rate() {
    nothing_faster(robot(Some(5e-3), Some([1.0; 2]), None), 6);
}

#[test]
fn nothing_is_faster_on_torque() {
    let torque = Torque {
        stall_over_viscosity: 5e-3,
        no_load_rate: 2.0,
    };
    nothing_faster(robot(None, None, Some(torque)), 6);
}
