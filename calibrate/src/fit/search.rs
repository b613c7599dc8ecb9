//! From many starts to the best optimum: a grid of starts with ideal servos, whose distinct ends then start the fit with the
//! path that the servos really played.

use swimmer_files::AnyGait;

use super::problem::Problem;
use super::{FitError, Observation};

/// Starting grid: r_s/L and χ.
const GRID: ([f64; 4], [f64; 5]) = ([0.02, 0.08, 0.2, 0.4], [1.3, 2.0, 3.5, 6.0, 10.0]);
/// p of a start just inside the border r_s = 0: a sphere of a thousandth of the length.
const SMALL_SPHERE: f64 = 0.03;
/// Ends of the search that are followed up.
const FOLLOWED: usize = 3;

/// The best optimum (√(r_s/L), ln χ) and its cost.
pub(crate) fn search(
    problem: &Problem<'_>,
    gaits: &[AnyGait],
) -> Result<([f64; 2], f64), FitError> {
    let start = problem.start;
    let ideal: Vec<Observation> = problem
        .runs
        .iter()
        .zip(gaits)
        .map(|(run, gait)| run.ideal(gait))
        .collect();
    let search = problem.of_runs(&ideal);
    let length = start.total_length();
    let mut starts: Vec<[f64; 2]> = vec![[(start.sphere_radius / length).sqrt(), start.chi.ln()]];
    for radius in GRID.0 {
        starts.extend(GRID.1.map(|chi| [radius.sqrt(), chi.ln()]));
    }
    let mut ranked: Vec<([f64; 2], f64)> = starts
        .iter()
        .filter_map(|p| Some((*p, search.cost(*p)?)))
        .collect();
    ranked.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut ends: Vec<[f64; 2]> = Vec::new();
    let best = ranked.iter().take(FOLLOWED).map(|(p, _)| *p);
    for p in best.filter_map(|p| search.minimise(p)) {
        if ends
            .iter()
            .all(|q| (q[0] - p[0]).abs() + (q[1] - p[1]).abs() > 1e-3)
        {
            ends.push(p);
        }
    }
    let bare = ends
        .iter()
        .filter_map(|p| problem.without_sphere().minimise(*p));
    // From the border inwards again: its optimum may be a saddle.
    let bare: Vec<[f64; 2]> = bare
        .flat_map(|[_, k]| [[0.0, k], [SMALL_SPHERE, k]])
        .collect();
    let finished = ends
        .iter()
        .chain(bare.iter().filter(|p| p[0] > 0.0))
        .filter_map(|p| problem.minimise(*p))
        .chain(bare.iter().filter(|p| p[0] <= 0.0).copied())
        .filter_map(|p| Some((p, problem.cost(p)?)));
    let best = finished.min_by(|a, b| a.1.total_cmp(&b.1));
    best.ok_or(FitError::NoConvergence {
        starts: starts.len(),
    })
}
