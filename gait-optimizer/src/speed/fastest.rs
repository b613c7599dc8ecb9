//! A fastest gait as it is told.

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
    /// Of the displacement against the cycle's mean heading \[rad\].
    pub heading: f64,
    /// The gait, timed as it shall run.
    pub gait: OptimalGait,
    /// Closed curves that were started from, and how many of them led here.
    pub starts: usize,
    /// See [`Self::starts`].
    pub found: usize,
    /// |d|/(L T) of a cycle with more corners than were asked for, where one is better by more than 1e-6 of it.
    pub longer: Option<f64>,
    /// |d|/(L T) of a faster chain that failed its certificate: none where the answer is the fastest that was met.
    pub uncertified: Option<f64>,
    /// Its arcs as they were polished, to start a neighbour from.
    pub(crate) links: Vec<Link>,
}

/// A chain as an answer; none where its samples make no gait.
pub(crate) fn told(problem: &SpeedProblem, setting: &Setting, chain: &Polished) -> Option<Fastest> {
    let fast = problem.fast();
    // Run the way that leads forward, and of two mirror images the one that leads to the left.
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
        heading,
        starts: 0,
        found: 0,
        longer: None,
        uncertified: None,
        links: chain.links.clone(),
        gait: OptimalGait {
            certificate,
            ..OptimalGait::of_cycle(of, false, cycle, &stroke)
        },
    })
}
