//! Of all that the search finds within some bounds, the best that is certified; and how far gaits carry that are no optima.

use std::cmp::Ordering;

use nalgebra::Vector2;
use swimmer_files::Bounds;
use swimmer_model::Model;

use super::flow::Touch;
use super::search::{Candidate, FINER_SCAN, SCAN_POINTS, Search, Seen};
use super::start_family::{StartFamily, families, families_on_the_diagonal};
use super::{DisplacementError, DisplacementProblem, Fates, certified, traced};
use crate::certificate::{Condition, Verdict, turning_number};
use crate::momentum::Motion;
use crate::optimal_gait::OptimalGait;
use crate::region::Region;

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
    /// Of the gaits seen that are no extremals and carry farther than `least`, over L, about the farthest; none where none was seen.
    pub(super) fn farthest(
        &self,
        problem: &DisplacementProblem,
        model: &Model<f64>,
        within: (&Bounds, &Region),
        least: f64,
    ) -> Option<OptimalGait> {
        let sign = problem.heading().sign();
        let scans = self.scans.iter();
        let mut carried: Vec<Candidate> = scans
            .flat_map(|(search, families, seen)| search.farthest(families, seen, least / 4.0))
            .filter(|candidate| 4.0 * sign * candidate.quarter.end[2] > least)
            .collect();
        carried.sort_by(farther);
        carried.iter().find_map(|candidate| {
            // Most that carry far wind several times, which a few samples tell.
            let few = traced(model, within.1, candidate, 32)?.cycle();
            if (turning_number(&few.phi) - 1.0).abs() > 0.5 {
                return None;
            }
            let gait = certified(problem, model, within, candidate)?;
            is_gait(&gait).then_some(gait)
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
            let Some(gait) = certified(problem, model, within, candidate) else {
                continue;
            };
            if gait.certificate.holds_among_symmetric() {
                let mut finer = finely_sampled(problem, model, within, (candidate, gait));
                finer.extremals = Some(seen.found.len());
                return (Ok(finer), seen);
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

/// Whether all holds that makes a curve a gait within its bounds, optimal or not.
fn is_gait(gait: &OptimalGait) -> bool {
    gait.certificate.holds_but(&[
        Condition::FinalLambda4,
        Condition::StartTransversality,
        Condition::EndTransversality,
        Condition::NoConjugatePoint,
        Condition::NoAscentWithoutSymmetry,
    ])
}

/// Most samples of a quarter, as a multiple of those asked for.
const FINEST: usize = 16;

/// Gaits with shorter sides and smaller bends between them \[rad\] are not asked: they pass, and asking costs as much as finding the
/// gait.
const CLOSE: [f64; 2] = [0.08, 0.1];

/// The gait with as many samples as its own certificate needs when it is worked out from the samples alone; as it is where no
/// number of them will do.
pub(super) fn finely_sampled(
    problem: &DisplacementProblem,
    model: &Model<f64>,
    within: (&Bounds, &Region),
    (candidate, gait): (&Candidate, OptimalGait),
) -> OptimalGait {
    if longest_and_sharpest(&gait)
        .iter()
        .zip(CLOSE)
        .all(|(found, close)| *found < close)
    {
        return gait;
    }
    let mut finer = *problem;
    let mut sampled = gait.clone();
    while leaves_open(&sampled) {
        finer.quarter_samples *= 2;
        if finer.quarter_samples > FINEST * problem.quarter_samples {
            return gait;
        }
        match certified(&finer, model, within, candidate) {
            Some(again) if again.certificate.holds_among_symmetric() => sampled = again,
            _ => return gait,
        }
    }
    sampled
}

/// The longest side of a gait's polygon, and the largest angle between two but at corners \[rad\].
fn longest_and_sharpest(gait: &OptimalGait) -> [f64; 2] {
    let sides: Vec<_> = gait.phi().array_windows().map(|[a, b]| b - a).collect();
    let bends = sides.array_windows().zip(gait.u().iter().skip(1));
    let bends = bends.filter(|(_, u)| !gait.corners().contains(u));
    let bends = bends.map(|([a, b], _)| a.perp(b).atan2(a.dot(b)).abs());
    [
        sides.iter().map(Vector2::norm).fold(0.0, f64::max),
        bends.fold(0.0, f64::max),
    ]
}

/// Whether samples alone leave open what [`certify`](crate::certify()) asks.
fn leaves_open(gait: &OptimalGait) -> bool {
    let certificate = gait.certify();
    certificate.is_ok_and(|certificate| certificate.verdict() == Verdict::Undecided)
}
