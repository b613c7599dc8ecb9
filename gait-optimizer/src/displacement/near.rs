//! Warm start: the gait of a design from the gait of a neighbouring one, with the same arcs and without a search.

use swimmer_files::ArcKind;

use super::flow::Touch;
use super::search::{QuarterBranch, Search};
use super::start_family::{StartFamily, families};
use super::{DisplacementProblem, certified};
use crate::cycle::Arc;
use crate::momentum::Motion;
use crate::optimal_gait::OptimalGait;
use crate::region::Region;

/// Returns the optimum near that of a neighbouring problem (another swimmer or other bounds, a little changed), with its own
/// certificate. It costs a fraction of a search and has the neighbour's sense and kinds of arcs: only
/// [`displacement()`](super::displacement()) finds out if another kind has become better. Without a heading in the problem it
/// swims forwards.
///
/// Returns `None` if no such gait is near, if it fails its certificate, if the problem's heading is not the neighbour's, or if the
/// neighbour runs along a diagonal.
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
    let model = problem.validated().ok()?;
    let heading = neighbour.heading_counter_clockwise();
    let other_sense = problem.heading.is_some_and(|wanted| wanted != heading);
    let on_diagonal = |arc: &Arc| arc.kind == ArcKind::Diagonal;
    if !neighbour.symmetric || other_sense || neighbour.arcs.iter().any(on_diagonal) {
        return None;
    }
    let region = Region::new(&problem.bounds, &problem.swimmer.links);
    let search = Search {
        model: &model,
        region: &region,
        sign: heading.sign(),
    };
    let leaves = neighbour
        .arcs
        .iter()
        .position(|arc| arc.kind == ArcKind::Singular);
    let flow = search.flow(0.0, Motion::Singular);
    let found = families(flow, &problem.bounds, &region)
        .iter()
        .filter_map(|family| {
            let line = QuarterBranch {
                family,
                touch: Touch::Ends,
            };
            let along_bounds = matches!(family, StartFamily::Bounds { .. });
            let found = match leaves {
                None if along_bounds => search.never_leaving(family),
                Some(first) if along_bounds == (first > 0) => {
                    let arc = neighbour.arcs.get(first)?;
                    let p = family.nearest(&arc.from.into())?;
                    search.near(line, p)
                }
                _ => None,
            };
            found.filter(|candidate| search.sign * candidate.quarter.end[2] > 0.0)
        })
        .max_by(|a, b| {
            let [a, b] = [a, b].map(|candidate| candidate.quarter.end[2].abs());
            a.total_cmp(&b)
        })?;
    let gait = certified(problem, &model, &found).filter(|gait| gait.certificate.pass())?;
    Some(match problem.heading {
        Some(_) => gait,
        None => gait.swum_forwards(),
    })
}
