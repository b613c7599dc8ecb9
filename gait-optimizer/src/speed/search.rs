//! Search for the fastest gait: from rough polygons to the fastest certified chain.

use std::cell::OnceCell;
use std::collections::BTreeSet;
use std::ops::Range;

use swimmer_model::Model;

use super::candidate::{SIDES, candidate, certified, certified_closely, mended};
use super::error::SpeedError;
use super::fastest::{Fastest, told};
use super::interior::Polygon;
use super::pairs::pairs;
use super::period;
use super::polish::Polished;
use super::problem::{SpeedProblem, validate};
use super::selection::{Group, rough_groups};
use super::setting::{HeadingRule, Setting};
use super::starts::start;
use crate::immobile::refuse_immobile;
use crate::parallel::{Watch, in_parallel};
use crate::region::Region;

/// Approximate share of the work that the rough polygons take.
pub(super) const ROUGH_SHARE: f64 = 0.6;
/// Groups that are finished at the same time.
const BATCH: usize = 8;
/// Sides of a finished polygon per side of a rough one, if the chain from fewer sides is not certified.
const MORE_SIDES: [usize; 2] = [3, 4];
/// Rough polygons slower than this share of the best finished gait are skipped.
pub(super) const HOPELESS: f64 = 0.93;

/// Finds the fastest gait.
///
/// # Errors
/// [`SpeedError`] if the problem is invalid or no chain can be certified.
pub fn fastest(problem: &SpeedProblem) -> Result<Fastest, SpeedError> {
    problem.watched(&|_| ())
}

impl SpeedProblem {
    /// [`fastest`] with a progress callback: `watch` receives the completed fraction of the work.
    ///
    /// # Errors
    /// As [`fastest`].
    pub fn watched(&self, watch: Watch<'_>) -> Result<Fastest, SpeedError> {
        match self.period {
            Some(period) => period::farthest(self, period, watch),
            None => self.searched_once(watch),
        }
    }

    /// Runs one search. With a prescribed period it considers only cycles that take all of it.
    pub(super) fn searched_once(&self, watch: Watch<'_>) -> Result<Fastest, SpeedError> {
        self.searched(watch, |search, watch| search.run(watch))?
    }

    /// Finds every locally fastest gait to which the starts lead, with the share of the work done passed to `watch`.
    ///
    /// # Errors
    /// [`SpeedError`] if the problem is invalid.
    pub fn atlas(&self, watch: Watch<'_>) -> Result<SpeedAtlas, SpeedError> {
        self.searched(watch, |search, watch| search.all(watch))
    }

    /// Finds the fastest gait with the arcs of a neighbouring problem's gait (slightly different swimmer, bounds or rates), with its own
    /// certificate. It costs a small part of a search and does not consider other arcs. Returns `None` if there is no such gait, or if
    /// it fails its certificate.
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
        self.swimmer.check_regular()?;
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

/// All locally fastest gaits of a search, and counts of the rest.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedAtlas {
    /// Certified gaits, fastest first.
    pub optima: Vec<Fastest>,
    /// Certified cycles with more corners than allowed.
    pub longer: usize,
    /// Chains of arcs that failed their certificate.
    pub uncertified: usize,
    /// Speed |d|/(L T) \[1/s\] of the fastest uncertified chain.
    pub best_uncertified: Option<f64>,
}

/// State of a search.
pub(super) struct Search<'a> {
    problem: &'a SpeedProblem,
    setting: &'a Setting<'a>,
    /// Closed curves from which the search started.
    starts: usize,
    groups: &'a [Group],
    /// Finished chains, fastest first.
    chains: Vec<Finished>,
}

/// Finished chain of a group.
struct Finished {
    chain: Polished,
    group: usize,
    /// Its gait if certified, computed on first use.
    certified: OnceCell<Option<Fastest>>,
}

impl Search<'_> {
    /// Finishes groups until no remaining group can be as fast.
    pub(super) fn run(mut self, watch: Watch<'_>) -> Result<Fastest, SpeedError> {
        let mut done = 0;
        loop {
            let best = self.chains.first().map_or(0.0, |best| best.chain.speed);
            let left = self.groups.get(done);
            let hopeless = |speed: f64| left.is_none_or(|group| group.speed() < HOPELESS * speed);
            if hopeless(best) {
                // A faster chain may have too many corners, or fail its certificate.
                let answer = self.answer();
                let speed = answer.as_ref().map_or(0.0, |found| found.speed_over_length);
                if left.is_none() || hopeless(speed / self.problem.fast()) {
                    return answer;
                }
            }
            // With the fastest remaining group, only those that may become as fast.
            let left = self.groups[done..].iter().take(BATCH);
            let fastest = self.groups[done].speed();
            let worth = left.take_while(|group| group.speed() >= HOPELESS * fastest);
            let next = done + worth.count().max(1);
            self.finish(done..next);
            done = next;
            watch(ROUGH_SHARE + (1.0 - ROUGH_SHARE) * done as f64 / self.groups.len() as f64);
        }
    }

    /// Finishes every group and returns all certified chains.
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
        // A certified gait may be slower than its chain, and equal to another.
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

    /// Returns the certified gait of a chain, with the counts of starts.
    fn certified(&self, one: &Finished) -> Option<Fastest> {
        let mut answer = one
            .certified
            .get_or_init(|| self.looked_into(one))
            .clone()?;
        answer.starts = self.starts;
        // Two chains of one group come from the same starts.
        let here = self.chains.iter().filter(|other| alike(other, one));
        let here: BTreeSet<usize> = here.map(|other| other.group).collect();
        answer.found = here.into_iter().map(|group| self.groups[group].count).sum();
        Some(answer)
    }

    /// Returns the certified gait of a chain, or of one from more sides of its polygon unless it has too many corners.
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

    /// Returns `true` if a chain has more corners than allowed.
    fn is_long(&self, one: &Finished) -> bool {
        one.chain.links.len() > self.problem.max_corners
    }

    /// Finishes the chosen polygons of several groups.
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

    /// Returns the fastest certified gait.
    fn answer(&self) -> Result<Fastest, SpeedError> {
        let problem = self.problem;
        let (mut longer, mut uncertified) = (None, None);
        let mut answer: Option<Fastest> = None;
        for one in shortest_of_alike(&self.chains) {
            let speed = one.chain.speed * problem.fast();
            // A certified gait may be slower than its chain.
            if answer
                .as_ref()
                .is_some_and(|answer| answer.speed_over_length >= speed)
            {
                break;
            }
            // Of the chains with too many corners only the fastest is reported.
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

/// Converts a chain to a result. Returns `None` if its certificate fails.
fn passed(problem: &SpeedProblem, setting: &Setting, chain: &Polished) -> Option<Fastest> {
    told(problem, setting, chain).filter(|found| found.gait.certificate.pass())
}

/// Returns `true` if two chains are equally fast.
fn alike(a: &Finished, b: &Finished) -> bool {
    (a.chain.speed - b.chain.speed).abs() <= 1e-9 * b.chain.speed
}

/// Returns one chain of each speed, fastest first: the one with the shortest period, since several laps of a gait are as fast as
/// the gait.
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
