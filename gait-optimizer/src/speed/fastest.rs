//! Result of a search for the fastest gait.

use swimmer_files::Objective;
use swimmer_model::{Tolerance, swim, wrapped_angle};

use super::certificate::of_cycle;
use super::polish::Polished;
use super::problem::SpeedProblem;
use super::samples;
use super::setting::Setting;
use super::structure::Link;
use crate::optimal_gait::OptimalGait;

/// The fastest gait.
#[derive(Debug, Clone, PartialEq)]
pub struct Fastest {
    /// |d|/(L T) \[1/s\].
    pub speed_over_length: f64,
    /// |d|/L of a cycle.
    pub distance_over_length: f64,
    /// \[s\]
    pub period: f64,
    /// Time of the period \[s\] in which the servos rest, after the cycle.
    pub rest: f64,
    /// Direction of the displacement relative to the cycle's mean heading \[rad\].
    pub heading: f64,
    /// The gait, with the timing at which it is fastest.
    pub gait: OptimalGait,
    /// Closed curves from which the search started.
    pub starts: usize,
    /// Starts that led to this gait.
    pub found: usize,
    /// |d|/(L T) of a cycle with more corners than allowed. `None` if no such cycle is faster by more than 1e-6 of the speed.
    pub longer: Option<f64>,
    /// |d|/(L T) of a faster chain that failed its certificate. `None` if no faster chain was found.
    pub uncertified: Option<f64>,
    /// Polished arcs, the initial guess for neighbouring problems.
    pub(crate) links: Vec<Link>,
}

/// Converts a chain to a result. Returns `None` if its samples are not a valid gait.
pub(crate) fn told(problem: &SpeedProblem, setting: &Setting, chain: &Polished) -> Option<Fastest> {
    let fast = problem.fast();
    // Of both senses the one that swims forwards, of two mirror images the one that swims to the left.
    let ahead = wrapped_angle(chain.net.heading());
    let backward = ahead.cos() < -1e-9 || (ahead.cos() < 1e-9 && ahead < 0.0);
    let half_turn = if backward { std::f64::consts::PI } else { 0.0 };
    let forward = wrapped_angle(ahead + half_turn);
    let sign = if forward < -1e-9 { -1.0 } else { 1.0 };
    let heading = sign * forward;
    let mut cycle = samples::cycle(setting, chain, sign);
    if backward {
        cycle = cycle.reversed(|phi| *phi);
    }
    let (gait, certificate) = of_cycle(setting, problem.bounds, &cycle)?;
    let stroke = swim(setting.model, &gait, &Tolerance::default());
    let of = (Objective::Speed, &problem.swimmer, &problem.bounds);
    Some(Fastest {
        speed_over_length: chain.speed * fast,
        distance_over_length: chain.net.distance(),
        period: chain.layout.period(&chain.z) / fast,
        rest: 0.0,
        heading,
        starts: 0,
        found: 0,
        longer: None,
        uncertified: None,
        links: chain.links.clone(),
        gait: OptimalGait {
            certificate,
            optimal_period: problem.period,
            ..OptimalGait::of_cycle(of, false, cycle, &stroke)
        },
    })
}
