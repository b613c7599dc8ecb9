//! The fastest gait: most net displacement per unit of time with no net rotation, when servos turn no faster than they can.
//!
//! With a price on time the problem is well-posed over all closed curves. Extremals are chains of three kinds of arcs: *extreme*
//! (both servos at full rate: straight in the plane of joint angles), *singular* (h = 0, one servo at full rate), and along a
//! bound. The search is global and needs no guess: from many starts an interior-point method finds a rough polygon near each;
//! those that may be the fastest it finishes ([`interior`], [`selection`]). What pushes against their sides tells the arcs
//! ([`structure`]), and Newton's method brings them to rounding ([`polish`]). The certificate is worked out from the finished
//! curve alone ([`certificate`]).

mod arc;
mod bordered;
mod candidate;
pub(crate) mod certificate;
mod chain;
mod ensemble;
mod error;
mod front;
pub(crate) mod gauge;
pub(crate) mod interior;
pub(crate) mod phases;
mod polish;
pub(crate) mod problem;
mod quadrature;
mod samples;
mod search;
pub(crate) mod selection;
pub(crate) mod starts;
mod steer;
mod structure;
#[cfg(test)]
mod tests;
mod widened;

use std::cell::Cell;

use swimmer_files::{AnyGait, Bounds, GaitFile};
use swimmer_model::{Model, Swimmer};

use crate::certificate::{Certificate, Condition};
use crate::immobile::{Immobile, refuse_immobile};
use crate::optimal_gait::OptimalGait;
use crate::parallel::{Watch, in_parallel};
use crate::region::Region;

pub(crate) use candidate::mended;
pub use error::SpeedError;
pub use front::{Front, front};
pub(crate) use polish::{Polished, speed_of};
use problem::Goal;
pub use problem::HeadingRule;
pub(crate) use problem::Setting;
use search::Search;
pub(crate) use search::told;
pub(crate) use steer::certify_joined;
pub use steer::{Joined, SteerProblem, Steering, steer};

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
    /// The first starts, each a good guess where angles are bounded: for an answer at once, as a rule the fastest.
    pub const GUESSES: usize = 3;

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
        let polished = candidate::mended(&setting, neighbour.links.clone())?;
        let found = search::told(self, &setting, &polished, fast)?;
        (found.gait.certificate.pass() && found.gait.arcs.len() <= self.max_corners)
            .then_some(found)
    }

    /// The problem in units in which the faster servo turns by 1 rad.
    pub(crate) fn setting<'a>(&self, model: &'a Model<f64>, region: &'a Region) -> Setting<'a> {
        let fast = self.rates[0].max(self.rates[1]);
        Setting {
            model,
            region,
            rates: self.rates.map(|rate| rate / fast),
            beyond: Vec::new(),
            heading: self.heading,
            period: self.period.map(|period| period * fast),
            goal: Goal::Distance,
            members: &[],
            anchor: None,
        }
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
            interior::rough_polygon(&setting, &starts::start(&region, problem.seed, index))
        };
        let share = |share: f64| watch(search::ROUGH_SHARE * share);
        let rough = in_parallel(
            problem.starts.max(1),
            problem.threads,
            &share,
            || (),
            roughly,
        );
        let groups = selection::groups(rough.into_iter().flatten().collect());
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
    /// Its arcs as they were polished, to start a neighbour from.
    pub(crate) links: Vec<structure::Link>,
}

/// Finds the fastest gait.
///
/// # Errors
/// [`SpeedError`] where the problem makes no sense or no chain can be certified.
pub fn fastest(problem: &SpeedProblem) -> Result<Fastest, SpeedError> {
    problem.watched(&|_| ())
}

/// Whose limits a gait was made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MadeFor {
    /// Those of its servos' rates.
    Rates,
    /// Others that it takes in full.
    Others,
}

/// The conditions of a gait from anywhere, timed as its samples are. One whose servos are slower than their rates somewhere may have
/// been made for other limits; where they clearly are, and nearly take others in full all along, it was. That is told of the samples
/// as they are, and kept for others of the same gait.
pub(crate) fn certify_speed(
    model: &Model<f64>,
    (file, gait): (&GaitFile, &AnyGait),
    region: &Region,
    made_for: &Cell<Option<MadeFor>>,
) -> Certificate {
    const CLEARLY: f64 = 1e-2;
    const NEARLY: f64 = 0.9;
    let others = || certificate::within_its_own((model, region), (file, gait));
    let rates = || certify_at_rates(model, file, gait, region);
    match made_for.get() {
        Some(MadeFor::Rates) => return rates(),
        Some(MadeFor::Others) => return others(),
        None => {}
    }
    let off = certificate::off_full_rate(model, region, file, gait);
    let takes = |within: &Certificate| within.value(Condition::TakesLimit) > Some(NEARLY);
    let meant = |within: &Certificate| within.pass() || off > CLEARLY && takes(within);
    let slower = off > Condition::FullRate.tolerance();
    let within = slower.then(others).filter(meant);
    made_for.set(Some(match within {
        Some(_) => MadeFor::Others,
        None => MadeFor::Rates,
    }));
    within.unwrap_or_else(rates)
}

/// The same of one that was made for its servos' rates. One that leads exactly along its mean heading, or across, may have been asked
/// to, and one that is slower than a longer or shorter one may have been given its period; it then passes as such.
fn certify_at_rates(
    model: &Model<f64>,
    file: &GaitFile,
    gait: &AnyGait,
    region: &Region,
) -> Certificate {
    let of = |(heading, period)| {
        let asked = certificate::Asked {
            heading,
            period,
            ..certificate::Asked::default()
        };
        certificate::certificate((model, &[]), region, asked, file, gait)
    };
    let free = of((HeadingRule::Any, false));
    if free.pass() {
        return free;
    }
    [
        (HeadingRule::Forward, false),
        (HeadingRule::Sideways, false),
        (HeadingRule::Any, true),
        (HeadingRule::Forward, true),
        (HeadingRule::Sideways, true),
    ]
    .into_iter()
    .map(of)
    .find(Certificate::pass)
    .unwrap_or(free)
}

/// As [`certify_speed`], of an ensemble's displacement.
#[cfg(test)]
pub(crate) fn certify_ensemble(
    of: (&Model<f64>, &[(crate::member::Member, f64)]),
    bounds: &Bounds,
    file: &GaitFile,
    gait: &AnyGait,
) -> Certificate {
    let region = Region::new(bounds, &of.0.swimmer().links);
    certificate::certificate(of, &region, certificate::Asked::default(), file, gait)
}

pub(crate) fn validate(problem: &SpeedProblem) -> Result<(), SpeedError> {
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

impl From<Immobile> for SpeedError {
    fn from(error: Immobile) -> Self {
        Self::Immobile(error)
    }
}
