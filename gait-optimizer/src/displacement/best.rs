//! Of all that the search finds within some bounds, the best that is certified; and how far gaits carry that are no optima.

use swimmer_files::Bounds;
use swimmer_model::Model;

use super::search::{CLOSER_LOOKS, Candidate, LOOKS, Search};
use super::trunk::{trunks, trunks_on_the_diagonal};
use super::{DisplacementError, DisplacementProblem, Fates, certified};
use crate::OptimalGait;
use crate::certify::samples_suffice;
use crate::region::Region;

/// What a search within some bounds came to.
pub(super) struct Extremals {
    /// The extremals that head the right way, farthest first.
    pub(super) found: Vec<Candidate>,
    /// Gaits that carry far but are no extremals; only of quarters that may touch their images.
    farthest: Vec<Candidate>,
    /// What became of all that were sent out along the bounds and from φ₁ = φ₂.
    fates: Fates,
}

pub(super) fn candidates(
    problem: &DisplacementProblem,
    model: &Model<f64>,
    (bounds, region): (&Bounds, &Region),
    looks: usize,
) -> Extremals {
    let sign = problem.heading().sign();
    let mut search = Search {
        model,
        region,
        sign,
        touches: 0,
        looks,
    };
    let mut trunks = trunks(search.extremal(0.0), bounds, region);
    let (mut found, seen) = search.candidates(&trunks);
    let fates = seen.fates;
    let mut farthest = Vec::new();
    if region.has_diagonals() {
        farthest.extend(search.farthest(&trunks, seen));
        search.touches = 1;
        trunks.extend(trunks_on_the_diagonal(
            search.extremal(0.0),
            region,
            &trunks,
        ));
        let (touching, seen) = search.candidates(&trunks);
        found.extend(touching);
        farthest.extend(search.farthest(&trunks, seen));
    }
    found.retain(|candidate| sign * candidate.quarter.end[2] > 0.0);
    let far = |a: &Candidate, b: &Candidate| {
        let [a, b] = [a, b].map(|candidate| candidate.quarter.end[2].abs());
        b.total_cmp(&a)
    };
    found.sort_by(far);
    farthest.sort_by(far);
    Extremals {
        found,
        farthest,
        fates,
    }
}

/// The best gait that certifies within these bounds, which may be tighter than the problem's; and how far, over L, gaits
/// carry at least that may touch their images.
pub(super) fn best(
    problem: &DisplacementProblem,
    model: &Model<f64>,
    bounds: &Bounds,
) -> (Result<OptimalGait, DisplacementError>, Option<f64>) {
    let region = Region::new(bounds, &problem.swimmer.links);
    let within = (bounds, &region);
    let heading = problem.heading();
    let mut refused = None;
    let mut farthest = None;
    let mut fates = Fates::default();
    for looks in [LOOKS, CLOSER_LOOKS] {
        let seen = candidates(problem, model, within, looks);
        farthest = seen.farthest.iter().find_map(|candidate| {
            let gait = certified(problem, model, within, candidate)?;
            is_gait(&gait).then_some(gait.displacement_over_length)
        });
        for candidate in &seen.found {
            let Some(gait) = certified(problem, model, within, candidate) else {
                continue;
            };
            if gait.certificate.pass() {
                let finer = finely_sampled(problem, model, within, (candidate, gait));
                return (Ok(finer), farthest);
            }
            refused.get_or_insert(gait);
        }
        fates = seen.fates;
        // Where many get lost, closer looks would only lose more.
        if refused.is_some() || 8 * fates.lost > fates.sent {
            break;
        }
    }
    let error = match refused {
        Some(gait) => DisplacementError::NotCertified {
            displacement_over_length: gait.displacement_over_length,
            failed: gait.certificate.failures(),
        },
        None if problem.bounds == Bounds::default() => {
            DisplacementError::NoUnboundedOptimum { fates }
        }
        None => DisplacementError::NoOptimum {
            heading,
            fates,
            outdone: None,
        },
    };
    (Err(error), farthest)
}

/// Whether all holds that makes a curve a gait within its bounds, optimal or not.
fn is_gait(gait: &OptimalGait) -> bool {
    const OF_AN_OPTIMUM: [&str; 4] = [
        "final_lambda4",
        "start_transversality",
        "end_transversality",
        "conjugate_point_least",
    ];
    let checks = gait.certificate.checks().iter();
    checks
        .filter(|check| !OF_AN_OPTIMUM.contains(&check.name))
        .all(|check| check.pass)
}

/// Most samples of a quarter, as a multiple of those asked for.
const FINEST: usize = 16;

/// Samples this close to each other \[rad\] are not asked further: gaits with steps of 0.1 rad pass, and asking costs as much as
/// finding the gait.
const CLOSE: f64 = 0.08;

/// The gait with as many samples as its own certificate needs when it is worked out from the samples alone; as it is where no
/// number of them will do.
fn finely_sampled(
    problem: &DisplacementProblem,
    model: &Model<f64>,
    within: (&Bounds, &Region),
    (candidate, gait): (&Candidate, OptimalGait),
) -> OptimalGait {
    let steps = gait.phi().windows(2).filter_map(|pair| match pair {
        [from, to] => Some((to - from).norm()),
        _ => None,
    });
    if steps.fold(0.0, f64::max) < CLOSE {
        return gait;
    }
    let mut finer = *problem;
    let mut sampled = gait.clone();
    while !samples_suffice(model, &sampled) {
        finer.quarter_samples *= 2;
        if finer.quarter_samples > FINEST * problem.quarter_samples {
            return gait;
        }
        match certified(&finer, model, within, candidate) {
            Some(again) if again.certificate.pass() => sampled = again,
            _ => return gait,
        }
    }
    sampled
}
