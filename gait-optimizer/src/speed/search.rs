//! From rough polygons to the fastest chain that is certified.

use std::collections::BTreeSet;
use std::ops::Range;

use swimmer_model::Model;

use super::candidate::{bent, candidate, mended};
use super::error::SpeedError;
use super::fastest::{Fastest, told};
use super::interior::{Polygon, rough_polygon};
use super::polish::Polished;
use super::problem::{SpeedProblem, validate};
use super::selection::{Group, groups};
use super::setting::Setting;
use super::starts::start;
use crate::immobile::refuse_immobile;
use crate::parallel::{Watch, in_parallel};
use crate::region::Region;

/// Of the time, about, until all rough polygons are there.
pub(super) const ROUGH_SHARE: f64 = 0.6;
/// Groups that are finished at a time.
const BATCH: usize = 8;
/// Rough polygons that are slower than this share of the best finished gait are left.
const HOPELESS: f64 = 0.93;

/// Finds the fastest gait.
///
/// # Errors
/// [`SpeedError`] where the problem makes no sense or no chain can be certified.
pub fn fastest(problem: &SpeedProblem) -> Result<Fastest, SpeedError> {
    problem.watched(&|_| ())
}

impl SpeedProblem {
    /// As [`fastest`], while somebody watches.
    ///
    /// # Errors
    /// As [`fastest`].
    pub fn watched(&self, watch: Watch<'_>) -> Result<Fastest, SpeedError> {
        self.searched(watch, |search, watch| search.run(watch))?
    }

    /// Every locally fastest gait that the starts lead to, while somebody watches.
    ///
    /// # Errors
    /// [`SpeedError`] where the problem makes no sense.
    pub fn atlas(&self, watch: Watch<'_>) -> Result<SpeedAtlas, SpeedError> {
        self.searched(watch, |search, watch| search.all(watch))
    }

    /// The fastest gait that has the arcs of a neighbouring problem's (another swimmer, other bounds or rates, a little changed),
    /// with its own certificate. It costs a small part of a search, and tells nothing of other arcs. None where there is no such
    /// gait, or where it fails its certificate.
    pub fn near(&self, neighbour: &Fastest) -> Option<Fastest> {
        validate(self).ok()?;
        let model = Model::new(&self.swimmer.of_unit_length()).ok()?;
        let region = Region::new(&self.bounds, &self.swimmer.links);
        let fast = self.rates[0].max(self.rates[1]);
        let setting = self.setting(&model, &region);
        let polished = mended(&setting, neighbour.links.clone())?;
        let found = told(self, &setting, &polished, fast)?;
        (found.gait.certificate.pass() && found.gait.arcs.len() <= self.max_corners)
            .then_some(found)
    }

    fn searched<R>(
        &self,
        watch: Watch<'_>,
        finish: impl Fn(Search<'_>, Watch<'_>) -> R,
    ) -> Result<R, SpeedError> {
        let problem = self;
        validate(problem)?;
        let model = Model::new(&problem.swimmer.of_unit_length())?;
        refuse_immobile(&model, &problem.bounds)?;
        let region = Region::new(&problem.bounds, &problem.swimmer.links);
        let fast = problem.rates[0].max(problem.rates[1]);
        let setting = problem.setting(&model, &region);
        let roughly = |(): &mut (), index: usize| {
            rough_polygon(&setting, &start(&region, problem.seed, index))
        };
        let share = |share: f64| watch(ROUGH_SHARE * share);
        let rough = in_parallel(
            problem.starts.max(1),
            problem.threads,
            &share,
            || (),
            roughly,
        );
        let groups = groups(rough.into_iter().flatten().collect());
        Ok(finish(Search::new(problem, &setting, fast, &groups), watch))
    }
}

/// All locally fastest gaits that were found, and what became of the rest.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedAtlas {
    /// Certified, fastest first.
    pub optima: Vec<Fastest>,
    /// Certified cycles of more corners than were asked for.
    pub longer: usize,
    /// Chains of arcs that failed their certificate, and the speed of the fastest of them, |d|/(L T) \[1/s\].
    pub uncertified: usize,
    /// See [`Self::uncertified`].
    pub best_uncertified: Option<f64>,
}

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
            let left = self.groups.get(done);
            let hopeless = |speed: f64| left.is_none_or(|group| group.speed() < HOPELESS * speed);
            if hopeless(best) {
                // A faster chain may be longer than was asked for, or fail its certificate.
                let answer = self.answer();
                let speed = answer.as_ref().map_or(0.0, |found| found.speed_over_length);
                if left.is_none() || hopeless(speed / self.fast) {
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
