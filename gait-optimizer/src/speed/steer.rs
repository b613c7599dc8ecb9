//! Gaits to steer by: the fastest forward, to the left and turning left, all through one common shape at which they join.
//!
//! In Stokes flow a gait run backwards undoes itself, so three gaits make six. Each is the fastest of its kind that passes the
//! shape. At the shape its costate may jump; every other condition of optimality is that of the fastest gait. If no chain of arcs
//! through the shape meets all conditions, the fastest gait found is returned with the certificate that it fails. Of the shapes
//! tried, the one is chosen at which the three gaits lose least against the fastest gaits that need not join.

mod joint;
mod shape;
#[cfg(test)]
mod tests;

use nalgebra::Vector2;
use swimmer_files::{AnyGait, Bounds, GaitFile, Objective};
use swimmer_model::{Model, Swimmer, Tolerance, swim};

use super::candidate::{self, SIDES, candidate, mended};
use super::certificate::{GaitRequirements, certificate, of_cycle};
use super::error::SpeedError;
use super::polish::Polished;
use super::problem::{SpeedProblem, validate};
use super::search::HOPELESS;
use super::selection::{self, Group};
use super::setting::{Goal, HeadingRule, Setting};
use super::{samples, starts};
use crate::certificate::{Certificate, Condition};
use crate::cycle::Cycle;
use crate::immobile::refuse_immobile;
use crate::optimal_gait::OptimalGait;
use crate::parallel::{Watch, in_parallel};
use crate::region::Region;

/// Swimmer, limits and common shape of the gaits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteerProblem {
    /// Swimmer, bounds, rates, starts and threads; its heading, period and largest number of corners are not used.
    pub of: SpeedProblem,
    /// Common shape \[rad\]; `None` for the one of those tried at which joining costs least.
    pub shape: Option<[f64; 2]>,
}

/// A gait that starts and ends at the common shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Joined {
    /// |d|/(L T) \[1/s\], or |Δθ|/T \[rad/s\] of the gait that turns.
    pub rate: f64,
    /// The same of the fastest gait found that need not join.
    pub unjoined_rate: f64,
    /// Duration of a cycle \[s\].
    pub period: f64,
    /// Motion of a cycle in the frame of the middle link at the common shape: x/L, y/L, θ \[rad\].
    pub net: [f64; 3],
    /// The gait from the common shape, timed as it shall run, with its certificate.
    pub gait: OptimalGait,
}

impl Joined {
    /// Cost of joining: the share of the fastest gait's rate that this gait loses.
    pub fn cost(&self) -> f64 {
        1.0 - self.rate / self.unjoined_rate
    }

    /// One cycle as a file, or the same run backwards.
    pub fn gait_file(&self, swimmer_name: &str, backwards: bool) -> GaitFile {
        let file = self.gait.gait_file(swimmer_name);
        if backwards { file.reversed() } else { file }
    }
}

/// Gaits to steer by.
#[derive(Debug, Clone, PartialEq)]
pub struct Steering {
    /// Shape at which all of them join \[rad\].
    pub shape: [f64; 2],
    /// Along the mean heading; backward is this one run backwards.
    pub forward: Joined,
    /// To the left of the mean heading; right is this one run backwards.
    pub left: Joined,
    /// To the left; the turn to the right is this one run backwards.
    pub turn: Joined,
    /// Common shapes that were tried.
    pub shapes: usize,
}

/// Motion that the fastest gait of a kind maximises.
type Kind = (Goal, HeadingRule);
/// The three kinds, in the order of [`Steering`], with their names in files and in errors.
const KINDS: [(Kind, Objective, &str); 3] = [
    (
        (Goal::Distance, HeadingRule::Forward),
        Objective::JoinedForward,
        "forward",
    ),
    (
        (Goal::Distance, HeadingRule::Sideways),
        Objective::JoinedSideways,
        "sideways",
    ),
    (
        (Goal::Rotation, HeadingRule::Any),
        Objective::JoinedTurning,
        "turning",
    ),
];

/// Finds the gaits to steer by; `watch` receives the completed share.
///
/// # Errors
/// [`SpeedError`] where the problem makes no sense, or no gait of a kind can be certified.
pub fn steer(problem: &SteerProblem, watch: Watch<'_>) -> Result<Steering, SpeedError> {
    let of = &problem.of;
    validate(of)?;
    of.swimmer.check_regular()?;
    let model = Model::new(&of.swimmer.of_unit_length())?;
    refuse_immobile(&model, &of.bounds)?;
    let region = Region::new(&of.bounds, &of.swimmer.links);
    let fast = of.fast();
    let setting = |kind: Kind, anchor| Setting {
        asked: asked(kind, anchor),
        ..of.setting(&model, &region)
    };
    if let Some(shape) = problem.shape {
        let margin = -region.overstepped(&Vector2::from(shape));
        if margin.is_nan() || margin < shape::MARGIN * region.scale() {
            return Err(SpeedError::Shape { shape });
        }
    }
    let mut free = Vec::with_capacity(KINDS.len());
    for (number, (kind, ..)) in KINDS.into_iter().enumerate() {
        let setting = setting(kind, None);
        let starts: Vec<_> = (0..of.starts.max(1))
            .map(|index| starts::start(setting.region, of.seed, index))
            .collect();
        let chains = chains(&setting, &starts, of.threads);
        if chains.is_empty() {
            return Err(of_kind(of, number, 0));
        }
        free.push(chains);
        watch(0.5 * (number + 1) as f64 / KINDS.len() as f64);
    }
    let joining = shape::Joining {
        settings: &|kind: usize, anchor| setting(KINDS[kind].0, Some(anchor)),
        region: &region,
        free: &free,
        seed: of.seed,
        threads: of.threads,
    };
    let none_of = |kind: usize| of_kind(of, kind, free[kind].len());
    let (anchor, [forward, left, turn], shapes) = match problem.shape {
        Some(shape) => {
            let anchor = Vector2::from(shape);
            (
                anchor,
                joining.certified_at(anchor, None).map_err(none_of)?,
                1,
            )
        }
        None => joining
            .cheapest(&|share| watch(0.5 + 0.5 * share))
            .map_err(none_of)?,
    };
    let told = |number: usize, chain: &Polished| {
        let (kind, objective, _) = KINDS[number];
        let joined = setting(kind, Some(anchor));
        let of_file = (objective, &of.swimmer, &of.bounds);
        let unjoined = joining.unjoined(number, &setting(kind, None), chain);
        told(of_file, &joined, chain, (fast, unjoined)).ok_or_else(|| none_of(number))
    };
    Ok(Steering {
        shape: anchor.into(),
        forward: told(0, &forward)?,
        left: told(1, &left)?,
        turn: told(2, &turn)?,
        shapes,
    })
}

fn of_kind(problem: &SpeedProblem, kind: usize, chains: usize) -> SpeedError {
    SpeedError::NoJoinedGait {
        kind: KINDS[kind].2,
        bounds: problem.bounds,
        starts: problem.starts,
        chains,
    }
}

/// Gaits that starts lead to, fastest first, certified or not.
fn chains(setting: &Setting, starts: &[Vec<Vector2<f64>>], threads: usize) -> Vec<Polished> {
    let groups = selection::rough_groups(setting, starts, threads, &|_| ());
    finished(setting, &groups, threads)
}

/// Gaits that groups of rough polygons lead to, fastest first, certified or not. Slow polygons are finished only if none of the
/// fast ones leads to a gait.
fn finished(setting: &Setting, groups: &[Group], threads: usize) -> Vec<Polished> {
    /// Groups of rough polygons that are finished.
    const GROUPS: usize = 6;
    let fastest = groups.first().map_or(0.0, Group::speed);
    let groups = groups.get(..GROUPS).unwrap_or(groups);
    let slow = groups.partition_point(|group| group.speed() >= HOPELESS * fastest);
    let (fast, slow) = groups.split_at(slow);
    let chains = finished_all(setting, fast, threads);
    if chains.is_empty() {
        finished_all(setting, slow, threads)
    } else {
        chains
    }
}

fn finished_all(setting: &Setting, groups: &[Group], threads: usize) -> Vec<Polished> {
    let chosen: Vec<_> = groups.iter().flat_map(|group| &group.chosen).collect();
    let finished = in_parallel(
        chosen.len(),
        threads,
        &|_| (),
        || (),
        |(), index| joined(setting, candidate(setting, chosen[index], SIDES)?),
    );
    let mut chains: Vec<Polished> = finished.into_iter().flatten().collect();
    chains.sort_by(|a, b| b.speed.total_cmp(&a.speed));
    chains
}

/// A chain whose certificate passes, perhaps with more bends, with short singular arcs put in, or with a servo that switches just
/// before gaits join or just after.
fn certified(setting: &Setting, mut chain: Polished) -> Option<Polished> {
    let passes = |chain: &Polished| {
        let (.., certificate) = cycle(setting, chain, Bounds::default())?;
        certificate.pass().then(|| chain.clone())
    };
    let mut switches = joint::MOST;
    loop {
        if let Some(certified) = candidate::certified(setting, &chain, passes) {
            return Some(certified);
        }
        switches = switches.checked_sub(1)?;
        chain = joint::switched(setting, &chain)?;
    }
}

/// A chain for which all holds that makes it a gait of its kind within its bounds and rates: one to steer by, optimal or not.
fn joined(setting: &Setting, chain: Polished) -> Option<Polished> {
    const OF_A_GAIT: [Condition; 9] = [
        Condition::Closed,
        Condition::KeepsBounds,
        Condition::NothingFolded,
        Condition::DisplacementSteppedAgain,
        Condition::NoRotation,
        Condition::RotationSteppedAgain,
        Condition::PassesJoint,
        Condition::FullRate,
        Condition::Heading,
    ];
    let (.., certificate) = cycle(setting, &chain, Bounds::default())?;
    let mut checks = certificate.checks().iter();
    checks
        .all(|check| check.pass || !OF_A_GAIT.contains(&check.condition))
        .then_some(chain)
}

/// The chain near a neighbour's, whose common shape lies close by.
fn near(setting: &Setting, neighbour: &Polished) -> Option<Polished> {
    mended(setting, neighbour.links.clone()).and_then(|chain| joined(setting, chain))
}

/// The conditions of a gait of one of the kinds that joins others at its first sample's shape; none for any other objective.
pub(crate) fn certify_joined(
    model: &Model<f64>,
    (file, gait): (&GaitFile, &AnyGait),
    region: &Region,
    objective: Objective,
) -> Option<Certificate> {
    let (kind, ..) = KINDS.into_iter().find(|kind| kind.1 == objective)?;
    let asked = asked(kind, file.phi.first().copied());
    Some(certificate((model, &[]), region, asked, file, gait))
}

fn asked((goal, heading): Kind, anchor: Option<Vector2<f64>>) -> GaitRequirements {
    GaitRequirements {
        heading,
        goal,
        anchor,
        ..GaitRequirements::default()
    }
}

/// A chain's cycle from the common shape, the way that leads forward, left or turns left, as a gait with its certificate.
fn cycle(
    setting: &Setting,
    chain: &Polished,
    bounds: Bounds,
) -> Option<(Cycle, AnyGait, Certificate)> {
    let mut links = chain.links.iter();
    let first = links.position(|link| link.anchored).unwrap_or(0);
    let mut cycle = samples::cycle_from(setting, chain, 1.0, first);
    let backward = match (setting.asked.goal, setting.asked.heading) {
        (Goal::Rotation, _) => chain.net.rotation < 0.0,
        (Goal::Distance, HeadingRule::Sideways) => chain.net.heading().sin() < 0.0,
        (Goal::Distance, _) => chain.net.heading().cos() < 0.0,
    };
    if backward {
        cycle = cycle.reversed(|phi| *phi);
    }
    let (gait, certificate) = of_cycle(setting, bounds, &cycle)?;
    Some((cycle, gait, certificate))
}

/// A joined chain as an answer; `fast` is the faster servo's rate, `unjoined` the speed of the fastest gait that was met and need not
/// join.
fn told(
    of @ (_, _, bounds): (Objective, &Swimmer<f64>, &Bounds),
    setting: &Setting,
    chain: &Polished,
    (fast, unjoined): (f64, f64),
) -> Option<Joined> {
    let (cycle, gait, certificate) = cycle(setting, chain, *bounds)?;
    let stroke = swim(setting.model, &gait, &Tolerance::default());
    let [x, y] = stroke.displacement.into();
    Some(Joined {
        rate: chain.speed * fast,
        unjoined_rate: unjoined * fast,
        period: chain.layout.period(&chain.z) / fast,
        net: [x, y, stroke.rotation],
        gait: OptimalGait {
            certificate,
            ..OptimalGait::of_cycle(of, false, cycle, &stroke)
        },
    })
}
