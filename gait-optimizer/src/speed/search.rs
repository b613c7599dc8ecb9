//! From rough polygons to the fastest chain that is certified.

use std::cell::OnceCell;
use std::collections::BTreeSet;
use std::ops::Range;

use swimmer_model::Model;

use super::candidate::{SIDES, candidate, certified, certified_closely, mended};
use super::error::SpeedError;
use super::fastest::{Fastest, told};
use super::interior::Polygon;
use super::pairs::pairs;
use super::polish::Polished;
use super::problem::{SpeedProblem, validate};
use super::selection::{Group, rough_groups};
use super::setting::{HeadingRule, Setting};
use super::starts::start;
use crate::immobile::refuse_immobile;
use crate::parallel::{Watch, in_parallel};
use crate::region::Region;

/// Of the time, about, until all rough polygons are there.
pub(super) const ROUGH_SHARE: f64 = 0.6;
/// Groups that are finished at a time.
const BATCH: usize = 8;
/// Sides of a finished polygon for each of a rough one where the chain that fewer lead to is not certified.
const MORE_SIDES: [usize; 2] = [3, 4];
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
        let setting = self.setting(&model, &region);
        let polished = mended(&setting, neighbour.links.clone())?;
        certified_closely(&setting, &polished, |chain| passed(self, &setting, chain))
            .filter(|found| found.gait.arcs.len() <= self.max_corners)
    }

    fn searched<R>(
        &self,
        watch: Watch<'_>,
        finish: impl Fn(Search<'_>, Watch<'_>) -> R,
    ) -> Result<R, SpeedError> {
        validate(self)?;
        let model = Model::new(&self.swimmer.of_unit_length())?;
        refuse_immobile(&model, &self.bounds)?;
        let region = Region::new(&self.bounds, &self.swimmer.links);
        let setting = self.setting(&model, &region);
        let random = (0..self.starts.max(1)).map(|index| start(&region, self.seed, index));
        let mut starts: Vec<_> = random.collect();
        if self.heading != HeadingRule::Any {
            starts.extend(pairs(self, &setting));
        }
        let share = |share: f64| watch(ROUGH_SHARE * share);
        let groups = rough_groups(&setting, &starts, self.threads, &share);
        let search = Search {
            problem: self,
            setting: &setting,
            starts: starts.len(),
            groups: &groups,
            chains: Vec::new(),
        };
        Ok(finish(search, watch))
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
    /// Closed curves that were started from.
    starts: usize,
    groups: &'a [Group],
    /// Fastest first.
    chains: Vec<Finished>,
}

/// A chain that a group led to.
struct Finished {
    chain: Polished,
    group: usize,
    /// Its gait, where one is certified, once that has been asked for.
    certified: OnceCell<Option<Fastest>>,
}

impl Search<'_> {
    /// Finishes group after group until no other can be as fast, or none is left.
    pub(super) fn run(mut self, watch: Watch<'_>) -> Result<Fastest, SpeedError> {
        let mut done = 0;
        loop {
            let best = self.chains.first().map_or(0.0, |best| best.chain.speed);
            let left = self.groups.get(done);
            let hopeless = |speed: f64| left.is_none_or(|group| group.speed() < HOPELESS * speed);
            if hopeless(best) {
                // A faster chain may be longer than was asked for, or fail its certificate.
                let answer = self.answer();
                let speed = answer.as_ref().map_or(0.0, |found| found.speed_over_length);
                if left.is_none() || hopeless(speed / self.problem.fast()) {
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
        for one in shortest_of_alike(&self.chains) {
            match self.certified(one) {
                Some(answer) if answer.gait.arcs.len() <= self.problem.max_corners => {
                    optima.push(answer);
                }
                Some(_) => longer += 1,
                None => uncertified.push(one.chain.speed * self.problem.fast()),
            }
        }
        // What chains are certified as may be slower than they are, and alike.
        let speed = |found: &Fastest| found.speed_over_length;
        optima.sort_by(|a, b| speed(b).total_cmp(&speed(a)));
        optima.dedup_by(|a, b| (speed(a) - speed(b)).abs() <= 1e-9 * speed(b));
        SpeedAtlas {
            optima,
            longer,
            uncertified: uncertified.len(),
            best_uncertified: uncertified.into_iter().next(),
        }
    }

    /// A chain as an answer, where what it leads to is certified.
    fn certified(&self, one: &Finished) -> Option<Fastest> {
        let mut answer = one
            .certified
            .get_or_init(|| self.looked_into(one))
            .clone()?;
        answer.starts = self.starts;
        // Two of one group stand for the same starts.
        let here = self.chains.iter().filter(|other| alike(other, one));
        let here: BTreeSet<usize> = here.map(|other| other.group).collect();
        answer.found = here.into_iter().map(|group| self.groups[group].count).sum();
        Some(answer)
    }

    /// The certified gait of a chain, or, unless it is longer than was asked for, of one that more sides of its polygon show.
    fn looked_into(&self, one: &Finished) -> Option<Fastest> {
        let setting = self.setting;
        let passes = |chain: &Polished| passed(self.problem, setting, chain);
        let from_more_sides = |times: usize| {
            let polygons = self.groups[one.group].chosen.iter();
            let mut chains = polygons.filter_map(|polygon| candidate(setting, polygon, times));
            chains.find_map(|chain| certified(setting, &chain, passes))
        };
        if self.is_long(one) {
            return certified_closely(setting, &one.chain, passes);
        }
        certified(setting, &one.chain, passes)
            .or_else(|| MORE_SIDES.into_iter().find_map(from_more_sides))
    }

    /// Whether a chain has more corners than are asked for.
    fn is_long(&self, one: &Finished) -> bool {
        one.chain.links.len() > self.problem.max_corners
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
                Some(Finished {
                    chain: candidate(self.setting, polygon, SIDES)?,
                    group,
                    certified: OnceCell::new(),
                })
            },
        );
        self.chains.extend(finished.into_iter().flatten());
        self.chains
            .sort_by(|a, b| b.chain.speed.total_cmp(&a.chain.speed));
    }

    /// The fastest chain that is certified.
    fn answer(&self) -> Result<Fastest, SpeedError> {
        let problem = self.problem;
        let (mut longer, mut uncertified) = (None, None);
        let mut answer: Option<Fastest> = None;
        for one in shortest_of_alike(&self.chains) {
            let speed = one.chain.speed * problem.fast();
            // What a chain is certified as may be slower than the chain.
            if answer
                .as_ref()
                .is_some_and(|answer| answer.speed_over_length >= speed)
            {
                break;
            }
            // Of long ones the fastest is told.
            if self.is_long(one) && longer.is_some() {
                continue;
            }
            match self.certified(one) {
                None => {
                    uncertified.get_or_insert(speed);
                }
                Some(found) if found.gait.arcs.len() > problem.max_corners => {
                    longer.get_or_insert(found.speed_over_length);
                }
                Some(found) => {
                    let known = answer
                        .as_ref()
                        .map_or(0.0, |answer| answer.speed_over_length);
                    if found.speed_over_length > known {
                        answer = Some(found);
                    }
                }
            }
        }
        if let Some(mut answer) = answer {
            let clearly = |speed: Option<f64>| {
                speed.filter(|speed| *speed > answer.speed_over_length * (1.0 + 1e-6))
            };
            (answer.longer, answer.uncertified) = (clearly(longer), clearly(uncertified));
            return Ok(answer);
        }
        Err(SpeedError::NoGait {
            bounds: problem.bounds,
            starts: problem.starts,
            chains: self.chains.len(),
            uncertified,
        })
    }
}

/// A chain as an answer, where its certificate passes.
fn passed(problem: &SpeedProblem, setting: &Setting, chain: &Polished) -> Option<Fastest> {
    told(problem, setting, chain).filter(|found| found.gait.certificate.pass())
}

/// Whether two chains are as fast as each other.
fn alike(a: &Finished, b: &Finished) -> bool {
    (a.chain.speed - b.chain.speed).abs() <= 1e-9 * b.chain.speed
}

/// One chain of each speed, fastest first: the one of the shortest period, as a gait run several times over is as fast as the
/// gait.
fn shortest_of_alike(chains: &[Finished]) -> Vec<&Finished> {
    let period = |one: &Finished| one.chain.layout.period(&one.chain.z);
    let mut best: Vec<&Finished> = Vec::new();
    for one in chains {
        match best.last_mut() {
            Some(last) if alike(one, last) => {
                if period(one) < period(last) * (1.0 - 1e-9) {
                    *last = one;
                }
            }
            _ => best.push(one),
        }
    }
    best
}
