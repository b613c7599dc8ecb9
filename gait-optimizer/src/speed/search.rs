//! From rough polygons to the fastest chain that is certified.

use std::collections::BTreeSet;
use std::ops::Range;

use swimmer_files::Objective;
use swimmer_model::{Tolerance, swim, wrapped_angle};

use super::candidate::{bent, candidate};
use super::certificate::{Asked, of_cycle};
use super::interior::Polygon;
use super::polish::Polished;
use super::problem::Setting;
use super::samples;
use super::selection::Group;
use super::{Fastest, SpeedAtlas, SpeedError, SpeedProblem};
use crate::optimal_gait::OptimalGait;
use crate::parallel::{Watch, in_parallel};

/// Of the time, about, until all rough polygons are there.
pub(super) const ROUGH_SHARE: f64 = 0.6;
/// Groups that are finished at a time.
const BATCH: usize = 8;
/// Rough polygons that are slower than this share of the best finished gait are left.
const HOPELESS: f64 = 0.93;

/// What has been found so far.
pub(super) struct Search<'a> {
    problem: &'a SpeedProblem,
    setting: &'a Setting<'a>,
    /// The faster servo's rate.
    fast: f64,
    groups: &'a [Group],
    /// Chains, fastest first, each with the group that it comes from.
    chains: Vec<(Polished, usize)>,
}

impl<'a> Search<'a> {
    pub(super) fn new(
        problem: &'a SpeedProblem,
        setting: &'a Setting<'a>,
        fast: f64,
        groups: &'a [Group],
    ) -> Self {
        Self {
            problem,
            setting,
            fast,
            groups,
            chains: Vec::new(),
        }
    }

    /// Finishes group after group until no other can be as fast, or none is left.
    pub(super) fn run(mut self, watch: Watch<'_>) -> Result<Fastest, SpeedError> {
        let mut done = 0;
        loop {
            let best = self.chains.first().map_or(0.0, |(best, _)| best.speed);
            let hopeless = |group: &Group| group.speed() < HOPELESS * best;
            if self.groups.get(done).is_none_or(hopeless) {
                let answer = self.answer();
                if answer.is_ok() || done >= self.groups.len() {
                    return answer;
                }
            }
            // Beside the fastest that are left, only those that may turn out as fast.
            let left = self.groups[done..].iter().take(BATCH);
            let fastest = self.groups[done].speed();
            let worth = left.take_while(|group| group.speed() >= HOPELESS * fastest);
            let next = done + worth.count().max(1);
            self.finish(done..next);
            done = next;
            watch(ROUGH_SHARE + (1.0 - ROUGH_SHARE) * done as f64 / self.groups.len() as f64);
        }
    }

    /// Finishes every group, and tells all chains that are certified.
    pub(super) fn all(mut self, watch: Watch<'_>) -> SpeedAtlas {
        let count = self.groups.len();
        for done in (0..count).step_by(BATCH) {
            self.finish(done..(done + BATCH).min(count));
            watch(
                ROUGH_SHARE + (1.0 - ROUGH_SHARE) * (done + BATCH).min(count) as f64 / count as f64,
            );
        }
        let (mut optima, mut longer, mut uncertified) = (Vec::new(), 0, Vec::new());
        for chain in shortest_of_alike(&self.chains) {
            match self.certified(chain) {
                Some(answer) if answer.gait.arcs.len() <= self.problem.max_corners => {
                    optima.push(answer);
                }
                Some(_) => longer += 1,
                None => uncertified.push(chain.speed * self.fast),
            }
        }
        SpeedAtlas {
            optima,
            longer,
            uncertified: uncertified.len(),
            best_uncertified: uncertified.into_iter().next(),
        }
    }

    /// A chain as an answer, where its certificate passes.
    fn certified(&self, chain: &Polished) -> Option<Fastest> {
        let Self {
            problem,
            setting,
            fast,
            ref chains,
            ..
        } = *self;
        let passes = |answer: &Fastest| answer.gait.certificate.pass();
        let first = told(problem, setting, chain, fast).filter(passes);
        // Where the polygon had no corner left for a short singular arc the certificate shows it.
        let bent = || told(problem, setting, &bent(setting, chain)?, fast).filter(passes);
        let mut answer = first.or_else(bent)?;
        // Two of one group stand for the same starts.
        let here = chains.iter().filter(|(one, _)| alike(one, chain));
        let here: BTreeSet<usize> = here.map(|(_, group)| *group).collect();
        answer.found = here.into_iter().map(|group| self.groups[group].count).sum();
        Some(answer)
    }

    /// Finishes what was chosen of some groups.
    fn finish(&mut self, groups: Range<usize>) {
        let jobs: Vec<(&Polygon, usize)> = groups
            .flat_map(|at| {
                self.groups[at]
                    .chosen
                    .iter()
                    .map(move |polygon| (polygon, at))
            })
            .collect();
        let finished = in_parallel(
            jobs.len(),
            self.problem.threads,
            &|_| (),
            || (),
            |(), index| {
                let (polygon, group) = jobs[index];
                Some((candidate(self.setting, polygon)?, group))
            },
        );
        self.chains.extend(finished.into_iter().flatten());
        self.chains
            .sort_by(|(a, _), (b, _)| b.speed.total_cmp(&a.speed));
    }

    /// The fastest chain that is certified.
    fn answer(&self) -> Result<Fastest, SpeedError> {
        let Self {
            problem,
            fast,
            ref chains,
            ..
        } = *self;
        let (mut longer, mut uncertified) = (None, None);
        for best in shortest_of_alike(chains) {
            let better = |speed: &mut Option<f64>| {
                speed.get_or_insert(best.speed * fast);
            };
            let Some(mut answer) = self.certified(best) else {
                better(&mut uncertified);
                continue;
            };
            if answer.gait.arcs.len() > problem.max_corners {
                better(&mut longer);
                continue;
            }
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
            chains: chains.len(),
            uncertified,
        })
    }
}

/// Whether two chains are as fast as each other.
fn alike(a: &Polished, b: &Polished) -> bool {
    (a.speed - b.speed).abs() <= 1e-9 * b.speed
}

/// One chain of each speed, fastest first: the one of the shortest period, as a gait run several times over is as fast as the
/// gait.
fn shortest_of_alike(chains: &[(Polished, usize)]) -> Vec<&Polished> {
    let mut best: Vec<&Polished> = Vec::new();
    for (chain, _) in chains {
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
pub(crate) fn told(
    problem: &SpeedProblem,
    setting: &Setting,
    chain: &Polished,
    fast: f64,
) -> Option<Fastest> {
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
    let asked = Asked {
        heading: problem.heading,
        period: problem.period.is_some(),
        ..Asked::default()
    };
    let (gait, certificate) = of_cycle(setting, asked, problem.bounds, &cycle)?;
    let stroke = swim(setting.model, &gait, &Tolerance::default());
    let of = (Objective::Speed, &problem.swimmer, &problem.bounds);
    Some(Fastest {
        speed_over_length: chain.speed * fast,
        distance_over_length: chain.net.distance(),
        period: chain.layout.period(&chain.z) / fast,
        heading,
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
