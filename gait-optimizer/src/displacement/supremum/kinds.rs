//! What climbs within a problem's own bounds come to while gaps are wide: each another kind of gait.

use nalgebra::Vector2;
use swimmer_model::Model;

use super::curve::{Ground, Mesh};
use crate::displacement::best::best;
use crate::displacement::{DisplacementProblem, OUTDONE};
use crate::region::Region;

/// A polygon at rest and what it carries.
pub(super) type Kind = (Vec<Vector2<f64>>, f64);

const COARSE: Mesh = Mesh {
    gap: 0.02,
    side: 0.08,
};
/// Most moves of a climb.
const MOST_MOVES: usize = 600;
/// Most slits tried from a start, and from one polygon.
const MOST_TRIED: usize = 12;
const TRIED_AT_ONCE: usize = 5;
/// What carries this much farther, relatively, is worth another slit.
const FARTHER: f64 = 1e-5;
/// By how much kinds differ, relatively.
const ALIKE: f64 = 1e-4;

/// Quarters that the search for optima meets: the optimum's, and the farthest that is none.
pub(super) fn met(problem: &DisplacementProblem, model: &Model<f64>, region: &Region) -> Vec<Kind> {
    let within = (&problem.bounds, region);
    let (optimum, seen) = best(problem, model, within);
    let optimum = optimum.map(|gait| (gait.cycle, gait.displacement_over_length));
    let carried = optimum.as_ref().map_or(0.0, |(_, far)| far.abs());
    let farthest = seen.farthest(carried * (1.0 + OUTDONE));
    let met = optimum.into_iter().chain(farthest);
    met.map(|(cycle, far)| (cycle.quarter().to_vec(), far.abs()))
        .collect()
}

/// Farthest first, without those that carry as far as another.
pub(super) fn distinct(mut kinds: Vec<Kind>) -> Vec<Kind> {
    kinds.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    kinds.dedup_by(|(_, a), (_, b)| (*b - *a).abs() < ALIKE * *b);
    kinds
}

/// Straight across between the diagonals, along the bounds.
pub(super) fn across(problem: &DisplacementProblem) -> impl Iterator<Item = Vec<Vector2<f64>>> {
    let places = [problem.bounds.max_angle, problem.bounds.min_angle];
    places.into_iter().flatten().map(|angle| {
        let [from, to] = [angle, -angle].map(|one| Vector2::new(one, angle));
        (0..=8)
            .map(|k| from + (to - from) * (f64::from(k) / 8.0))
            .collect()
    })
}

/// What a start climbs to, with every slit that pays, and how far that carries.
pub(super) fn explored(ground: &Ground<'_>, start: &[Vector2<f64>]) -> Kind {
    let (mut here, mut carried) = ground.climbed(start, COARSE, MOST_MOVES);
    let mut tried = 0;
    'further: while tried < MOST_TRIED {
        let excursions = ground.excursions(&here, COARSE);
        for excursion in excursions.iter().take(TRIED_AT_ONCE) {
            tried += 1;
            let taken = excursion.taken(&here, COARSE);
            let (there, farther) = ground.climbed(&taken, COARSE, MOST_MOVES);
            if farther > carried * (1.0 + FARTHER) {
                (here, carried) = (there, farther);
                continue 'further;
            }
        }
        break;
    }
    (here, carried)
}
