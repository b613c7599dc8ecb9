//! The farthest certified extremal of one sense.

use swimmer_files::Bounds;
use swimmer_model::Model;

use super::flow::Touch;
use super::search::{Candidate, FINER_SCAN, SCAN_POINTS, Search};
use super::start_family::{families, families_on_the_diagonal};
use super::{DisplacementError, DisplacementProblem, ExtremalOutcomes, Heading, certified};
use crate::momentum::Motion;
use crate::optimal_gait::OptimalGait;
use crate::parallel::Watch;
use crate::region::Region;

/// Extremals of one sense within a region, farthest first, and the fates of all that were traced, from a number of places on each
/// start family. `watch` receives the share of the families that have been scanned.
pub(super) fn candidates(
    bounds: &Bounds,
    heading: Heading,
    (model, region): (&Model<f64>, &Region),
    places: usize,
    watch: Watch<'_>,
) -> (Vec<Candidate>, ExtremalOutcomes) {
    let sign = heading.sign();
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
    let (mut found, outcomes) = search.candidates(&families, places, watch);
    found.retain(|candidate| sign * candidate.quarter.end[2] > 0.0);
    let carried = |candidate: &Candidate| candidate.quarter.end[2].abs();
    found.sort_by(|a, b| carried(b).total_cmp(&carried(a)));
    (found, outcomes)
}

/// The best gait of one sense that is certified among gaits with the paper's symmetries.
pub(super) fn best(
    problem: &DisplacementProblem,
    heading: Heading,
    (model, region): (&Model<f64>, &Region),
    watch: Watch<'_>,
) -> Result<OptimalGait, DisplacementError> {
    let scan = |places| candidates(&problem.bounds, heading, (model, region), places, watch);
    let (mut found, mut outcomes) = scan(SCAN_POINTS);
    // If many are lost, a finer scan only loses more.
    if found.is_empty() && 8 * outcomes.lost <= outcomes.sent {
        (found, outcomes) = scan(FINER_SCAN);
    }
    let mut refused = None;
    for candidate in &found {
        let gait = certified(problem, model, candidate);
        watch(1.0);
        let Some(gait) = gait else {
            continue;
        };
        if gait.certificate.holds_among_symmetric() {
            return Ok(OptimalGait {
                extremals: Some(found.len()),
                ..gait
            });
        }
        refused.get_or_insert(gait);
    }
    Err(match refused {
        Some(gait) => DisplacementError::NotCertified {
            displacement_over_length: gait.displacement_over_length,
            failed: gait.certificate.failures(),
        },
        None if problem.bounds == Bounds::default() => {
            DisplacementError::NoUnboundedOptimum { outcomes }
        }
        None => DisplacementError::NoOptimum {
            heading: Some(heading),
            outcomes,
        },
    })
}
