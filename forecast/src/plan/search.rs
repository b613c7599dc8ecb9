//! Plan search: chains of three legs between approaches to both ends.

use swimmer_model::{Model, Pose};

use super::aim::{Aim, Chain};
use super::budget::{Budget, PAIR};
use super::legs::{LARGEST, chains, settled, with_cycles};
use super::walls::{Sweeps, Walls};
use super::way_out::{Way, ways_out};
use super::{Plan, PlanError, PlanRequest, Step, duration};

/// Factors by which a leg is divided into smaller cycles if its cycles do not fit between the walls.
const SMALLER: [u32; 5] = [1, 2, 4, 8, 16];
/// Plans that take more than this share of a known plan's duration are not extended.
const WORTH: f64 = 0.98;
/// Headings that are tried if the target has none.
const HEADINGS: usize = 24;

/// Effort of a search.
pub(super) struct Effort {
    /// Work at which the search with the gaits, or with their mirror images, ends, in vertices of played paths.
    pub(super) budget: usize,
    /// Distance that a plan leaves beyond the margin \[m\], because servos rest anywhere within their dead band.
    pub(super) spare: f64,
    /// Also search for approaches if the largest cycles fit.
    everywhere: bool,
    /// Pairs of approaches that are tried.
    pairs: usize,
    /// Chains between such a pair that are refined to meet the target.
    aimed: usize,
}

/// Efforts in order; the next is tried if one finds no plan.
///
/// Without a budget, 30 random targets took at most 1.4 million vertices in either search of the first effort, and targets 2 mm
/// from a wall 2.7 million where the search found a plan; where it found none it took up to 13 million. All budgets together are
/// about 20 s of a core.
pub(super) const EFFORTS: [Effort; 3] = {
    let quick = Effort {
        budget: 3_000_000,
        spare: 0.001,
        everywhere: false,
        pairs: 60,
        aimed: 4,
    };
    let narrow = Effort {
        budget: 1_500_000,
        spare: 0.0,
        ..quick
    };
    let thorough = Effort {
        budget: 4_000_000,
        spare: 0.0005,
        everywhere: true,
        pairs: 500,
        aimed: 100,
    };
    [quick, narrow, thorough]
};

/// Counts of a search, for its error message.
#[derive(Debug, Default)]
pub(super) struct SearchCounts {
    /// Chains of legs that meet the target, and those of them that stay clear of the walls.
    pub(super) met: [usize; 2],
    /// Reason why the robot refuses the first refused chain.
    pub(super) refused: Option<PlanError>,
}

/// An approach from the start and one to the target.
struct Pair<'a> {
    outward: &'a Way,
    inward: &'a Way,
    /// Net motion required of the legs between them.
    wanted: Pose<f64>,
    /// Approximate lower bound of a chain's duration \[s\].
    least: f64,
}

/// Search with one family of gaits.
pub(super) struct PlanSearch<'a> {
    pub(super) model: &'a Model<f64>,
    pub(super) request: &'a PlanRequest,
    /// Walls that a played plan stays clear of.
    pub(super) walls: &'a Walls<'a>,
    /// The gaits, and the space that they need between walls that are nearer by the effort's spare distance.
    pub(super) sweeps: Sweeps<'a>,
    pub(super) effort: &'a Effort,
}

impl PlanSearch<'_> {
    /// The quickest plan with these gaits, or the known plan if none is quicker.
    pub(super) fn quickest(
        &self,
        known: Option<Plan>,
        counts: &mut SearchCounts,
        budget: &mut Budget<'_>,
    ) -> Option<Plan> {
        let Self {
            model,
            request,
            walls,
            sweeps,
            effort,
        } = self;
        let (family, nets) = (sweeps.family, sweeps.nets);
        let way_in = family.way_in(model);
        let begun = request.from * way_in;
        let aim = Aim {
            model,
            family,
            request,
            nets,
            way_in,
        };
        let outward = ways_out(sweeps, &begun, effort.everywhere);
        let inward = ends(request).into_iter().filter(|end| {
            let fits = |pose: &Pose<f64>| walls.fits(pose, &nalgebra::Vector2::zeros());
            fits(end) && walls.fits(&(*end * way_in), &family.shape())
        });
        let inward: Vec<Way> = inward
            .flat_map(|end| ways_out(sweeps, &(end * way_in), effort.everywhere))
            .collect();
        let pairs = inward.iter().flat_map(|inward| {
            outward.iter().map(|outward| {
                let wanted = outward.there.inverse() * inward.there;
                let least = nets.least(&wanted) + outward.duration + inward.duration;
                Pair {
                    outward,
                    inward,
                    wanted,
                    least,
                }
            })
        });
        // The quickest at best first.
        let mut pairs: Vec<Pair> = pairs.collect();
        pairs.sort_by(|a, b| a.least.total_cmp(&b.least));
        let mut best = known;
        for pair in pairs.into_iter().take(effort.pairs) {
            let Pair {
                outward,
                inward,
                wanted,
                least,
            } = pair;
            let ways = outward.duration + inward.duration;
            let most = best
                .as_ref()
                .map_or(f64::INFINITY, |best| best.duration * WORTH);
            if least > most || budget.is_spent() {
                break;
            }
            budget.spend(PAIR);
            let mut left = legs_between(sweeps, &outward.there, &wanted, counts);
            left.retain(|legs| ways + duration(legs) < most);
            for legs in left.iter().take(effort.aimed) {
                if budget.is_spent() {
                    break;
                }
                let chain = Chain {
                    out: &outward.steps,
                    legs: legs.clone(),
                    back: inward.steps.iter().rev().map(Step::undone).collect(),
                };
                let hit = match aim.hit(&begun, chain, budget) {
                    Ok(Some(hit)) => hit,
                    Ok(None) => continue,
                    Err(error) => {
                        counts.refused.get_or_insert(error);
                        continue;
                    }
                };
                if walls.leaves_played(&request.from, &hit.way) {
                    best = Some(Plan::new(request, family, hit));
                    break;
                }
            }
        }
        best
    }
}

/// Chains of legs from this pose with the required net motion that stay clear of the walls, the quickest first.
pub(super) fn legs_between(
    sweeps: &Sweeps<'_>,
    begun: &Pose<f64>,
    wanted: &Pose<f64>,
    counts: &mut SearchCounts,
) -> Vec<Vec<Step>> {
    let all = chains(sweeps.nets, wanted);
    counts.met[0] += all.len();
    let fitted = all
        .iter()
        .filter_map(|legs| fitted(sweeps, begun, wanted, legs));
    let mut within: Vec<_> = fitted.collect();
    counts.met[1] += within.len();
    within.sort_by(|a, b| duration(a).total_cmp(&duration(b)));
    within
}

/// Poses in which the plan may end.
pub(super) fn ends(request: &PlanRequest) -> Vec<Pose<f64>> {
    let any = (0..HEADINGS).map(|k| std::f64::consts::TAU * k as f64 / HEADINGS as f64);
    let headings = request
        .heading
        .map_or_else(|| any.collect(), |one| vec![one]);
    let end = |heading| Pose::new(request.to.x, request.to.y, heading);
    headings.into_iter().map(end).collect()
}

/// Legs from this pose with the required net motion that stay clear of the walls, each with the largest cycles that fit.
fn fitted(
    sweeps: &Sweeps<'_>,
    begun: &Pose<f64>,
    wanted: &Pose<f64>,
    legs: &[Step],
) -> Option<Vec<Step>> {
    let mut pose = *begun;
    let mut chosen = Vec::with_capacity(legs.len());
    for leg in legs {
        let (leg, there) = SMALLER.iter().find_map(|&times| {
            let leg = with_cycles(sweeps.nets, leg, leg.cycles * times);
            Some((leg, sweeps.after(&pose, &leg.member, leg.cycles)?))
        })?;
        chosen.push(leg);
        pose = there;
    }
    let settled = settled(sweeps.nets, wanted, &chosen, LARGEST)?;
    let mut pose = *begun;
    for leg in &settled {
        pose = sweeps.after(&pose, &leg.member, leg.cycles)?;
    }
    Some(settled)
}
