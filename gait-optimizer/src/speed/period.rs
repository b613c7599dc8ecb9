//! Farthest gait in a given period: a cycle that takes all of it, laps of a shorter cycle, or a shorter cycle and a rest.
//!
//! All of these are feasible, so the greatest displacement grows with the period. For some periods no cycle that takes the whole period
//! satisfies the conditions: as the period grows, a branch of cycles ends where more time gains nothing. Branches are therefore
//! followed in the period by continuation, from gaits that searches return, and a rest fills the remaining time.

use super::error::SpeedError;
use super::fastest::Fastest;
use super::problem::{SpeedProblem, validate};
use crate::parallel::{Watch, in_parallel};

/// Continuation steps per octave of the period.
const STEPS: f64 = 8.0;
/// Branches followed to each period.
const FOLLOWED: usize = 2;
/// Most continuation steps on a branch.
const MOST_STEPS: usize = 80;
/// Starts of a search for branches: the first starts are good initial guesses.
const STARTS: usize = 12;
/// Periods of the searches relative to that of the fastest gait, in octaves.
const RUNGS: [f64; 7] = [-1.0, -0.5, 0.0, 0.5, 1.0, 1.5, LONGEST];
/// Longest of them: cycles that take a longer period are mostly no optima, and a search that finds none costs most.
const LONGEST: f64 = 2.0;
/// Approximate share of the work that the fastest gait takes.
const FASTEST_SHARE: f64 = 0.05;
/// Fewest corners of a lap.
const CORNERS: usize = 3;

/// Returns the farthest gait in the period of the problem.
pub(super) fn farthest(
    problem: &SpeedProblem,
    period: f64,
    watch: Watch<'_>,
) -> Result<Fastest, SpeedError> {
    validate(problem)?;
    let free = SpeedProblem {
        period: None,
        ..*problem
    };
    let fastest = free.searched_once(&|share| watch(FASTEST_SHARE * share));
    let longest = match &fastest {
        Ok(fastest) => fastest.period * LONGEST.exp2(),
        Err(_) => f64::INFINITY,
    };
    let mut searches: Vec<SpeedProblem> = (1..=most_laps(problem))
        .filter(|&laps| period / laps as f64 <= longest)
        .map(|laps| SpeedProblem {
            period: Some(period / laps as f64),
            max_corners: problem.max_corners / laps,
            starts: starts(problem, laps),
            ..*problem
        })
        .collect();
    if let Ok(fastest) = &fastest {
        let shorter = rungs(problem, fastest).filter(|rung| rung.period <= Some(period));
        searches.extend(shorter);
    }
    let share = |share: f64| watch(FASTEST_SHARE + (1.0 - FASTEST_SHARE) * share);
    let found = searched(&searches, problem.threads, &share);
    let mut errors = found.iter().filter_map(|found| found.as_ref().err());
    let error = errors.next().or(fastest.as_ref().err()).cloned();
    let branches = Branches {
        problem,
        fastest: fastest.as_ref().ok(),
        known: found.into_iter().filter_map(Result::ok).collect(),
    };
    branches.farthest(period).ok_or_else(|| {
        error.unwrap_or(SpeedError::NoGait {
            bounds: problem.bounds,
            starts: problem.starts,
            chains: 0,
            uncertified: None,
        })
    })
}

/// Returns searches that do not depend on the period of the problem: at periods near that of the fastest gait, for one lap and for two.
pub(super) fn rungs<'a>(
    problem: &'a SpeedProblem,
    fastest: &'a Fastest,
) -> impl Iterator<Item = SpeedProblem> + 'a {
    RUNGS.into_iter().flat_map(move |octaves: f64| {
        [1, 2].map(|laps| SpeedProblem {
            period: Some(fastest.period * octaves.exp2()),
            max_corners: (problem.max_corners / laps).max(CORNERS),
            starts: problem.starts.min(STARTS),
            ..*problem
        })
    })
}

/// Runs several searches in parallel.
pub(super) fn searched(
    problems: &[SpeedProblem],
    threads: usize,
    watch: Watch<'_>,
) -> Vec<Result<Fastest, SpeedError>> {
    in_parallel(
        problems.len(),
        threads,
        watch,
        || (),
        |(), index| {
            let one = SpeedProblem {
                threads: 1,
                ..problems[index]
            };
            one.searched_once(&|_| ())
        },
    )
}

/// Starts of a search for a number of laps.
fn starts(problem: &SpeedProblem, laps: usize) -> usize {
    if laps == 1 {
        problem.starts
    } else {
        problem.starts.min(STARTS)
    }
}

/// Most laps that the number of corners admits.
fn most_laps(problem: &SpeedProblem) -> usize {
    (problem.max_corners / CORNERS).max(1)
}

/// Gaits with certificates for their own periods, from which branches are followed.
pub(super) struct Branches<'a> {
    pub(super) problem: &'a SpeedProblem,
    pub(super) fastest: Option<&'a Fastest>,
    pub(super) known: Vec<Fastest>,
}

impl Branches<'_> {
    /// Returns the farthest gait in a period: laps of one cycle, then a rest.
    pub(super) fn farthest(&self, period: f64) -> Option<Fastest> {
        let laps = (1..=most_laps(self.problem)).filter_map(|laps| {
            let lap = self.lap(period / laps as f64, self.problem.max_corners / laps)?;
            self.repeated(&lap, laps)
        });
        let farthest = laps.reduce(farther)?;
        let speed = |found: &Fastest| found.distance_over_length / period;
        let clearly = |other: &f64| *other > speed(&farthest) * (1.0 + 1e-6);
        // More laps would exceed the number of corners.
        let whole = self.fastest.map(|one| {
            let laps = (period / one.period).floor();
            laps * one.distance_over_length / period
        });
        let longer = farthest.longer.into_iter().chain(whole).reduce(f64::max);
        Some(Fastest {
            longer: longer.filter(clearly),
            uncertified: farthest.uncertified.filter(clearly),
            speed_over_length: speed(&farthest),
            rest: (period - farthest.period).max(0.0),
            period,
            ..farthest
        })
    }

    /// Returns the farthest single cycle within a period and a number of corners.
    fn lap(&self, most: f64, corners: usize) -> Option<Fastest> {
        let mut shorter: Vec<&Fastest> = Vec::new();
        let mut longer: Option<&Fastest> = None;
        let known = self.known.iter().chain(self.fastest);
        for one in known.filter(|one| one.gait.arcs.len() <= corners) {
            if one.period <= most * (1.0 + 1e-12) {
                shorter.push(one);
            } else if longer.is_none_or(|longer| one.period < longer.period) {
                longer = Some(one);
            }
        }
        shorter.sort_by(|a, b| b.distance_over_length.total_cmp(&a.distance_over_length));
        let up = shorter.iter().take(FOLLOWED);
        let all = up.copied().chain(longer);
        all.filter_map(|one| self.followed(one, most, corners))
            .reduce(farther)
    }

    /// Returns the farthest gait of at most the period `to` on the branch that leads from a gait to this period.
    fn followed(&self, from: &Fastest, to: f64, corners: usize) -> Option<Fastest> {
        let fits = |found: &Fastest| {
            found.period <= to * (1.0 + 1e-12) && found.gait.arcs.len() <= corners
        };
        let mut here = self.near(from, from.period)?;
        let mut best = Some(here.clone()).filter(fits);
        for _ in 0..MOST_STEPS {
            let next = self.next(here.period, to);
            if (next / here.period - 1.0).abs() < 1e-12 {
                break;
            }
            let Some(found) = self.near(&here, next) else {
                break;
            };
            here = found;
            if fits(&here) {
                best = best.into_iter().chain([here.clone()]).reduce(farther);
            }
        }
        best
    }

    /// Returns the next period between two periods, on a grid that depends on neither.
    fn next(&self, from: f64, to: f64) -> f64 {
        let fast = self.problem.fast();
        let step = (from * fast).log2() * STEPS;
        let period = |step: f64| (step / STEPS).exp2() / fast;
        if to > from {
            period((step + 1e-6).floor() + 1.0).min(to)
        } else {
            period((step - 1e-6).ceil() - 1.0).max(to)
        }
    }

    /// Returns the gait of the same arcs for another period.
    fn near(&self, one: &Fastest, period: f64) -> Option<Fastest> {
        let problem = SpeedProblem {
            period: Some(period),
            ..*self.problem
        };
        let found = problem.near(one)?;
        Some(Fastest {
            starts: one.starts,
            found: one.found,
            longer: one.longer,
            uncertified: one.uncertified,
            ..found
        })
    }

    /// Returns several laps of a cycle as one gait.
    fn repeated(&self, lap: &Fastest, laps: usize) -> Option<Fastest> {
        if laps == 1 {
            return Some(lap.clone());
        }
        let repeated = Fastest {
            links: vec![lap.links.clone(); laps].concat(),
            ..lap.clone()
        };
        self.near(&repeated, lap.period * laps as f64)
    }
}

fn farther(one: Fastest, other: Fastest) -> Fastest {
    if other.distance_over_length > one.distance_over_length {
        other
    } else {
        one
    }
}
