//! The fastest gait: most net displacement per unit of time with no net rotation, when servos turn no faster than they can.
//!
//! With a price on time the problem is well-posed over all closed curves. Extremals are chains of three kinds of arcs: *extreme*
//! (both servos at full rate: straight in the plane of joint angles), *singular* (h = 0, one servo at full rate), and along a
//! bound. The search is global and needs no guess: from many starts an interior-point method finds the best polygon near each
//! ([`interior`]), what pushes against its sides tells the arcs ([`structure`]), and Newton's method brings them to rounding
//! ([`polish`]). The certificate is worked out from the finished curve alone ([`certificate`]).

mod arc;
mod candidate;
mod certificate;
mod chain;
mod error;
mod interior;
mod polish;
mod problem;
mod quadrature;
mod samples;
mod starts;
mod structure;
#[cfg(test)]
mod tests;

use nalgebra::Vector2;
use swimmer_files::{AnyGait, Bounds, GaitFile, Objective};
use swimmer_model::{Model, Swimmer, Tolerance, swim};

use crate::immobile::refuse_immobile;
use crate::optimal_gait::{OptimalGait, Solution};
use crate::parallel::in_parallel;
use crate::region::Region;
use crate::{Certificate, Immobile};

pub use error::SpeedError;
use polish::Polished;
pub use problem::HeadingRule;
use problem::Setting;

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedProblem {
    /// Whose gait.
    pub swimmer: Swimmer<f64>,
    /// Bounds on shapes; those of quarters (`min_angle`, `sector`) make no sense here.
    pub bounds: Bounds,
    /// Largest |φ̇ᵢ| \[rad/s\].
    pub rates: [f64; 2],
    /// Which way the gait shall lead.
    pub heading: HeadingRule,
    /// The period \[s\], where the farthest gait in this time is asked for.
    pub period: Option<f64>,
    /// Most corners of a cycle: a chain of unlike cycles may always beat each of them.
    pub max_corners: usize,
    /// Closed curves to start from.
    pub starts: usize,
    /// Of the random ones.
    pub seed: u64,
    /// Threads to search with; the answer does not depend on it.
    pub threads: usize,
}

impl SpeedProblem {
    /// Most corners of a cycle unless told otherwise.
    pub const MAX_CORNERS: usize = 16;
    /// Starts unless told otherwise.
    pub const STARTS: usize = 64;

    /// Without bounds, any way.
    pub fn new(swimmer: Swimmer<f64>, rates: [f64; 2]) -> Self {
        Self {
            swimmer,
            bounds: Bounds::default(),
            rates,
            heading: HeadingRule::Any,
            period: None,
            max_corners: Self::MAX_CORNERS,
            starts: Self::STARTS,
            seed: 0,
            threads: 1,
        }
    }
}

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
    /// How many of the starts led here.
    pub found: usize,
    /// |d|/(L T) of a cycle with more corners than were asked for, where one is better by more than 1e-6 of it.
    pub longer: Option<f64>,
    /// |d|/(L T) of a faster chain that failed its certificate: none where the answer is the fastest that was met.
    pub uncertified: Option<f64>,
}

/// Finds the fastest gait.
///
/// # Errors
/// [`SpeedError`] where the problem makes no sense or no chain can be certified.
pub fn fastest(problem: &SpeedProblem) -> Result<Fastest, SpeedError> {
    validate(problem)?;
    let model = Model::new(&problem.swimmer.of_unit_length())?;
    refuse_immobile(&model, &problem.bounds)?;
    let region = Region::new(&problem.bounds, &problem.swimmer.links);
    // Time in units in which the faster servo turns by 1 rad.
    let fast = problem.rates[0].max(problem.rates[1]);
    let setting = Setting {
        model: &model,
        region: &region,
        rates: problem.rates.map(|rate| rate / fast),
        heading: problem.heading,
        period: problem.period.map(|period| period * fast),
    };
    let mut chains: Vec<Polished> = in_parallel(
        problem.starts.max(1),
        problem.threads,
        &|_| (),
        || (),
        |(), index| {
            let start = starts::start(&region, problem.seed, index);
            candidate::candidate(&setting, &start)
        },
    )
    .into_iter()
    .flatten()
    .collect();
    chains.sort_by(|a, b| b.speed.total_cmp(&a.speed));
    let searched = chains.len();
    let (mut longer, mut uncertified) = (None, None);
    for best in shortest_of_alike(&chains) {
        let better = |speed: &mut Option<f64>| {
            speed.get_or_insert(best.speed * fast);
        };
        // Where the polygon had no corner left for a short singular arc the certificate shows it.
        let passes = |answer: &Fastest| answer.gait.certificate.pass();
        let first = told(problem, &setting, best, fast).filter(passes);
        let bent = || told(problem, &setting, &candidate::bent(&setting, best)?, fast);
        let Some(mut answer) = first.or_else(|| bent().filter(passes)) else {
            better(&mut uncertified);
            continue;
        };
        if answer.gait.arcs.len() > problem.max_corners {
            better(&mut longer);
            continue;
        }
        answer.found = chains.iter().filter(|one| alike(one, best)).count();
        let clearly = |speed: Option<f64>| {
            speed.filter(|speed| *speed > answer.speed_over_length * (1.0 + 1e-6))
        };
        answer.longer = clearly(longer);
        answer.uncertified = clearly(uncertified);
        return Ok(answer);
    }
    Err(SpeedError::NoGait {
        bounds: problem.bounds,
        starts: problem.starts,
        chains: searched,
        uncertified,
    })
}

/// The conditions of a gait from anywhere, timed as its samples are. One that leads exactly along its mean heading, or across, may
/// have been asked to, and then passes as such.
pub(crate) fn certify_speed(
    model: &Model<f64>,
    file: &GaitFile,
    gait: &AnyGait,
    region: &Region,
) -> Certificate {
    let of = |rule| certificate::certificate(model, region, (rule, false), file, gait);
    let free = of(HeadingRule::Any);
    if free.pass() {
        return free;
    }
    [HeadingRule::Forward, HeadingRule::Sideways]
        .into_iter()
        .map(of)
        .find(Certificate::pass)
        .unwrap_or(free)
}

fn validate(problem: &SpeedProblem) -> Result<(), SpeedError> {
    for rate in problem.rates {
        if !(rate.is_finite() && rate > 0.0) {
            return Err(SpeedError::Rate { rate });
        }
    }
    if let Some(period) = problem.period
        && !(period.is_finite() && period > 0.0)
    {
        return Err(SpeedError::Period { period });
    }
    if problem.bounds.min_angle.is_some() || problem.bounds.sector {
        return Err(SpeedError::OfQuarters {
            bounds: problem.bounds,
        });
    }
    if problem.max_corners < 3 {
        return Err(SpeedError::Corners {
            corners: problem.max_corners,
        });
    }
    Ok(())
}

/// Whether two chains are as fast as each other.
fn alike(a: &Polished, b: &Polished) -> bool {
    (a.speed - b.speed).abs() <= 1e-9 * b.speed
}

/// One chain of each speed, fastest first: the one of the shortest period, as a gait run several times over is as fast as the
/// gait.
fn shortest_of_alike(chains: &[Polished]) -> Vec<&Polished> {
    let mut best: Vec<&Polished> = Vec::new();
    for chain in chains {
        match best.last_mut() {
            Some(last) if alike(chain, last) => {
                if chain.layout.period(&chain.z) < last.layout.period(&last.z) * (1.0 - 1e-9) {
                    *last = chain;
                }
            }
            _ => best.push(chain),
        }
    }
    best
}

/// A chain as an answer; none where its samples make no gait.
fn told(problem: &SpeedProblem, setting: &Setting, chain: &Polished, fast: f64) -> Option<Fastest> {
    // Run the way that leads forward, and of two mirror images the one that leads to the left.
    let ahead = remainder(chain.net.heading());
    let backward = ahead.cos() < -1e-9 || (ahead.cos() < 1e-9 && ahead < 0.0);
    let half_turn = if backward { std::f64::consts::PI } else { 0.0 };
    let forward = remainder(ahead + half_turn);
    let sign = if forward < -1e-9 { -1.0 } else { 1.0 };
    let heading = sign * forward;
    let (mut cycle, mut arcs) = samples::cycle(setting, chain, sign);
    if backward {
        (cycle, arcs) = (cycle.reversed(|phi| *phi), samples::reversed(&arcs));
    }
    let gait = cycle.gait().ok()?;
    let stroke = swim(setting.model, &gait, &Tolerance::default());
    let file = GaitFile {
        bounds: problem.bounds,
        arcs: cycle.arcs.clone(),
        corners: cycle.corners.clone(),
        u: cycle.u.clone(),
        phi: cycle.phi.clone(),
        ..GaitFile::default()
    };
    let certificate = certificate::certificate(
        setting.model,
        setting.region,
        (problem.heading, problem.period.is_some()),
        &file,
        &gait,
    );
    let distance = chain.net.distance();
    let period = chain.layout.period(&chain.z);
    Some(Fastest {
        speed_over_length: chain.speed * fast,
        distance_over_length: distance,
        period: period / fast,
        heading,
        found: 0,
        longer: None,
        uncertified: None,
        gait: OptimalGait::new(Solution {
            objective: Objective::Speed,
            swimmer: problem.swimmer,
            bounds: problem.bounds,
            symmetric: false,
            links_cross: cycle.links_cross(setting.model),
            arcs,
            cycle,
            stroke,
            certificate: certificate.with(second_order(chain)),
        }),
    })
}

/// What the polish knows beyond the curve.
fn second_order(chain: &Polished) -> Vec<crate::Check> {
    vec![
        crate::Check::at_most("polish_residual", chain.residual, 1e-9),
        crate::Check::at_least("second_variation_least", chain.convexity, 0.0),
    ]
}

/// An angle in (−π, π].
fn remainder(angle: f64) -> f64 {
    let direction = Vector2::new(angle.cos(), angle.sin());
    direction.y.atan2(direction.x)
}

impl From<Immobile> for SpeedError {
    fn from(error: Immobile) -> Self {
        Self::Immobile(error)
    }
}
