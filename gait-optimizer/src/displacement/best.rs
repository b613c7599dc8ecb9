//! Of all that the search finds within some bounds, the best that is certified; and how far gaits carry that are no optima.

use std::cmp::Ordering;

use swimmer_files::Bounds;
use swimmer_model::Model;

use super::flow::Touch;
use super::search::{Candidate, FINER_SCAN, MIDDLING, SCAN_POINTS, Search, Seen};
use super::start_family::{StartFamily, families, families_on_the_diagonal};
use super::{DisplacementError, DisplacementProblem, certified};
use crate::certificate::{Condition, again_within, simple_and_turning_once};
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
    search: Search<'a>,
    families: Vec<StartFamily>,
    seen: Seen,
}

/// Everything within a region: where it has the diagonals among its bounds, also what touches its images. So many places of each
/// family are looked at.
pub(super) fn candidates<'a>(
    problem: &DisplacementProblem,
    model: &'a Model<f64>,
    (bounds, region): (&Bounds, &'a Region),
    places: usize,
) -> Extremals<'a> {
    let sign = problem.heading().sign();
    let search = Search {
        model,
        region,
        sign,
    };
    let flow = search.flow(0.0, Motion::Singular);
    let mut families = families(flow, bounds, region);
    if region.has_diagonals() {
        let [inwards, outwards] = [Touch::GoesInwards, Touch::GoesOutwards]
            .map(|touch| families_on_the_diagonal(flow, region, &families, touch));
        families.extend(inwards.into_iter().chain(outwards));
    }
    let (mut found, seen) = search.candidates(&families, places);
    found.retain(|candidate| sign * candidate.quarter.end[2] > 0.0);
    found.sort_by(farther);
    Extremals {
        found,
        search,
        families,
        seen,
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
    pub(super) fn farthest(&self, least: f64) -> Option<(Cycle, f64)> {
        let mut seen = self.seen.farthest(&self.families, least / 4.0);
        seen.find_map(|(line, p)| {
            if 4.0 * self.search.miss(line, p, MIDDLING)?.carried <= least {
                return None;
            }
            let candidate = self.search.candidate(line, p)?;
            let far = 4.0 * candidate.quarter.end[2];
            let cycle = candidate.cycle(self.search.model, SAMPLES)?;
            let loops = simple_and_turning_once(&cycle.phi, cycle.quarter());
            let kept = cycle.quarter().iter().all(|phi| {
                self.search.region.overstepped(phi) <= Condition::KeepsBounds.tolerance()
            });
            let again = (cycle.swum(self.search.model)?.displacement.x - far).abs()
                <= again_within(far.abs());
            (loops.iter().all(|check| check.pass) && kept && again).then_some((cycle, far))
        })
    }
}

/// The best gait with the paper's symmetries that certifies among such within these bounds, which may be tighter than the problem's;
/// and what else was seen there.
pub(super) fn best<'a>(
    problem: &DisplacementProblem,
    model: &'a Model<f64>,
    within: (&Bounds, &'a Region),
) -> (Result<OptimalGait, DisplacementError>, Extremals<'a>) {
    let own = |candidate: &&Candidate| problem.bounds_of(candidate) == problem.bounds;
    let mut extremals = candidates(problem, model, within, SCAN_POINTS);
    let fates = extremals.seen.fates;
    // Where many get lost, a finer scan would only lose more.
    if !extremals.found.iter().any(|candidate| own(&candidate)) && 8 * fates.lost <= fates.sent {
        extremals = candidates(problem, model, within, FINER_SCAN);
    }
    let mut refused = None;
    for candidate in &extremals.found {
        let Some(gait) = certified(problem, model, candidate) else {
            continue;
        };
        let is_own = own(&candidate);
        if gait.certificate.holds_among_symmetric() {
            let found = extremals.found.iter();
            let alike = found.filter(|one| !is_own || own(one)).count();
            let gait = OptimalGait {
                extremals: Some(alike),
                ..gait
            };
            return (Ok(gait), extremals);
        }
        if is_own {
            refused.get_or_insert(gait);
        }
    }
    let fates = extremals.seen.fates;
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
    (Err(error), extremals)
}
