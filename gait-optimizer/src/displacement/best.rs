//! Of all that the search finds within some bounds, the best that is certified; and how far gaits carry that are no optima.

use std::cmp::Ordering;

use swimmer_files::Bounds;
use swimmer_model::Model;

use super::flow::Touch;
use super::search::{Candidate, FINER_SCAN, SCAN_POINTS, Search, Seen};
use super::start_family::{StartFamily, families, families_on_the_diagonal};
use super::{DisplacementError, DisplacementProblem, Fates, certified};
use crate::certificate::{Condition, again_within, simple_and_turning_once, turning_number};
use crate::cycle::Cycle;
use crate::momentum::Motion;
use crate::optimal_gait::OptimalGait;
use crate::region::Region;

/// Samples of a quarter that is no optimum.
const SAMPLES: usize = 192;

/// What a search within some bounds came to.
pub(super) struct Extremals<'a> {
    /// The extremals that head the right way, farthest first.
    pub(super) found: Vec<Candidate>,
    /// What the scans saw beside them; only of quarters that may touch their images.
    scans: Vec<(Search<'a>, Vec<StartFamily>, Seen)>,
    /// What became of all that were sent out along the bounds and from φ₁ = φ₂.
    fates: Fates,
}

pub(super) fn candidates<'a>(
    problem: &DisplacementProblem,
    model: &'a Model<f64>,
    (bounds, region): (&Bounds, &'a Region),
    scan_points: usize,
) -> Extremals<'a> {
    let sign = problem.heading().sign();
    let search = |touch| Search {
        model,
        region,
        sign,
        touch,
        scan_points,
    };
    let bare = search(Touch::Ends).flow(0.0, Motion::Singular);
    let off_the_diagonal = families(bare, bounds, region);
    let (mut found, seen) = search(Touch::Ends).candidates(&off_the_diagonal);
    let fates = seen.fates;
    let mut scans = Vec::new();
    if region.has_diagonals() {
        scans.push((search(Touch::Ends), off_the_diagonal.clone(), seen));
        for touch in [Touch::GoesInwards, Touch::GoesOutwards] {
            let mut families = off_the_diagonal.clone();
            families.extend(families_on_the_diagonal(
                bare,
                region,
                &off_the_diagonal,
                touch,
            ));
            let (touching, seen) = search(touch).candidates(&families);
            found.extend(touching);
            scans.push((search(touch), families, seen));
        }
    }
    found.retain(|candidate| sign * candidate.quarter.end[2] > 0.0);
    found.sort_by(farther);
    Extremals {
        found,
        scans,
        fates,
    }
}

/// The farther one first.
fn farther(a: &Candidate, b: &Candidate) -> Ordering {
    let [a, b] = [a, b].map(|candidate| candidate.quarter.end[2].abs());
    b.total_cmp(&a)
}

impl Extremals<'_> {
    /// About the farthest of the gaits seen that are no extremals and carry farther than `least`, with its X over L; none where none
    /// was seen.
    pub(super) fn farthest(
        &self,
        model: &Model<f64>,
        sign: f64,
        least: f64,
    ) -> Option<(Cycle, f64)> {
        let scans = self.scans.iter();
        let mut seen: Vec<_> = scans
            .flat_map(|(search, families, seen)| {
                let farthest = seen.farthest(least / 4.0);
                farthest.map(move |(index, p, carried)| (carried, search, families.get(index), p))
            })
            .collect();
        seen.sort_by(|a, b| b.0.total_cmp(&a.0));
        seen.into_iter().find_map(|(_, search, family, p)| {
            let candidate = search.candidate(family?, p)?;
            let far = 4.0 * candidate.quarter.end[2];
            // Most that carry far wind several times, which a few samples tell.
            let few = candidate.cycle(model, 32)?;
            if sign * far <= least || (turning_number(&few.phi) - 1.0).abs() > 0.5 {
                return None;
            }
            let cycle = candidate.cycle(model, SAMPLES)?;
            let loops = simple_and_turning_once(&cycle.phi, cycle.quarter());
            let kept = cycle
                .quarter()
                .iter()
                .all(|phi| search.region.overstepped(phi) <= Condition::KeepsBounds.tolerance());
            let again = (cycle.swum(model)?.displacement.x - far).abs() <= again_within(far.abs());
            (loops.iter().all(|check| check.pass) && kept && again).then_some((cycle, far))
        })
    }
}

/// The best gait with the paper's symmetries that certifies among such within these bounds, which may be tighter than the problem's, and carries farther than `least`,
/// over L; and what else was seen there.
pub(super) fn best<'a>(
    problem: &DisplacementProblem,
    model: &'a Model<f64>,
    within: (&Bounds, &'a Region),
    least: f64,
) -> (Result<OptimalGait, DisplacementError>, Extremals<'a>) {
    let mut refused = None;
    let mut seen = candidates(problem, model, within, SCAN_POINTS);
    for closer in [true, false] {
        let farther = |candidate: &&Candidate| 4.0 * candidate.quarter.end[2].abs() > least;
        for candidate in seen.found.iter().filter(farther) {
            let Some(gait) = certified(problem, model, within.0, candidate) else {
                continue;
            };
            if gait.certificate.holds_among_symmetric() {
                let extremals = Some(seen.found.len());
                return (Ok(OptimalGait { extremals, ..gait }), seen);
            }
            refused.get_or_insert(gait);
        }
        // Where many get lost, a finer scan would only lose more.
        if !closer || least > 0.0 || refused.is_some() || 8 * seen.fates.lost > seen.fates.sent {
            break;
        }
        seen = candidates(problem, model, within, FINER_SCAN);
    }
    let fates = seen.fates;
    let error = match refused {
        Some(gait) => DisplacementError::NotCertified {
            displacement_over_length: gait.displacement_over_length,
            failed: gait.certificate.failures(),
        },
        None if problem.bounds == Bounds::default() => {
            DisplacementError::NoUnboundedOptimum { fates }
        }
        None => DisplacementError::NoOptimum {
            heading: problem.heading(),
            fates,
            outdone: None,
        },
    };
    (Err(error), seen)
}
