//! The gait of a design from the gait of a neighbouring one: the same arcs, their place found again, no search.

use swimmer_files::ArcKind;
use swimmer_model::Model;

use super::best::finely_sampled;
use super::flow::Touch;
use super::search::{Candidate, LOOKS, Search};
use super::trunk::{Trunk, trunks, trunks_on_the_diagonal};
use super::{DisplacementProblem, certified};
use crate::OptimalGait;
use crate::region::Region;

/// The optimum of a problem that lies near the optimum of a neighbouring one (another swimmer or other bounds, a little changed),
/// with its own certificate. It costs a fraction of a search, and it is the neighbour's kind of gait: whether another kind has
/// become better only [`displacement()`](super::displacement()) tells.
///
/// None where there is no such gait near by, or where it fails its certificate: then ask for
/// [`displacement()`](super::displacement()).
///
/// ```
/// use gait_optimizer::{DisplacementProblem, displacement, displacement_near};
/// use swimmer_model::Swimmer;
///
/// let mut problem = DisplacementProblem::new(Swimmer::purcell());
/// let here = displacement(&problem)?;
/// problem.swimmer.chi = 2.01;
/// let next = displacement_near(&problem, &here).unwrap();
/// let direct = displacement(&problem)?;
/// assert!(next.certificate.pass());
/// assert!((next.displacement_over_length / direct.displacement_over_length - 1.0).abs() < 1e-10);
/// # Ok::<(), gait_optimizer::DisplacementError>(())
/// ```
pub fn displacement_near(
    problem: &DisplacementProblem,
    neighbour: &OptimalGait,
) -> Option<OptimalGait> {
    problem.validate().ok()?;
    let touching = neighbour.bounds.sector;
    if !neighbour.symmetric || (problem.bounds.sector && !touching) {
        return None;
    }
    let bounds = match touching {
        true if problem.may_touch() => problem.touching(),
        true if !problem.bounds.sector => return None,
        _ => problem.bounds,
    };
    let model = Model::new(&problem.swimmer.of_unit_length()).ok()?;
    let region = Region::new(&bounds, &problem.swimmer.links);
    let search = |touch| Search {
        model: &model,
        region: &region,
        sign: problem.heading().sign(),
        touch,
        looks: LOOKS,
    };
    let sign = problem.heading().sign();
    let bare = search(Touch::Ends).extremal(0.0);
    let off_the_diagonal = trunks(bare, &bounds, &region);
    let mut found = nearest(&search(Touch::Ends), &off_the_diagonal, neighbour);
    if touching {
        for touch in [Touch::GoesInwards, Touch::GoesOutwards] {
            let mut trunks = off_the_diagonal.clone();
            trunks.extend(trunks_on_the_diagonal(
                bare,
                &region,
                &off_the_diagonal,
                touch,
            ));
            found.extend(nearest(&search(touch), &trunks, neighbour));
        }
    }
    let farther = |a: &Candidate, b: &Candidate| {
        let [a, b] = [a, b].map(|candidate| sign * candidate.quarter.end[2]);
        a.total_cmp(&b)
    };
    let found = found
        .into_iter()
        .filter(|candidate| sign * candidate.quarter.end[2] > 0.0)
        .max_by(farther)?;
    let within = (&bounds, &region);
    let gait = certified(problem, &model, within, &found)?;
    if !gait.certificate.pass() {
        return None;
    }
    Some(finely_sampled(problem, &model, within, (&found, gait)))
}

/// The extremals that leave the trunks where the neighbour's leaves its own.
fn nearest(search: &Search<'_>, trunks: &[Trunk], neighbour: &OptimalGait) -> Vec<Candidate> {
    let leaves = neighbour
        .arcs
        .iter()
        .position(|arc| arc.kind == ArcKind::Singular);
    let found = trunks.iter().filter_map(|trunk| {
        let along_bounds = matches!(trunk, Trunk::Bounds { .. });
        match leaves {
            None if along_bounds => search.never_leaving(trunk),
            Some(first) if along_bounds == (first > 0) => {
                let arc = neighbour.arcs.get(first)?;
                let p = trunk.nearest(&arc.from.into())?;
                search.candidate(trunk, search.polished(trunk, p)?)
            }
            _ => None,
        }
    });
    found.collect()
}
