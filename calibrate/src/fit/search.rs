//! From many starts to the best optimum: a grid of starts with ideal servos, whose distinct ends then start the fit with the
//! path that the servos really played. r_s = 0 is a bound, and a start of its own from each end.

use super::run_model::RunModel;
use super::run_values::RunValues;
use crate::error::FitError;
use crate::least_squares::{Minimum, Model, cost, minimise};

/// Starting grid: r_s/L and χ.
const GRID: ([f64; 4], [f64; 5]) = ([0.02, 0.08, 0.2, 0.4], [1.3, 2.0, 3.5, 6.0, 10.0]);
/// Ends of the search that are followed up.
const FOLLOWED: usize = 3;
/// Ends that are nearer are one.
const APART: f64 = 1e-3;

/// The best optimum (r_s/L, ln χ) of a model of these two.
pub(crate) fn search(
    model: &RunModel,
    data: &RunValues,
    weights: &[f64],
) -> Result<Minimum, FitError> {
    let ideal = model.with_ideal_servos();
    let bounds = model.bounds();
    let start = &model.start.swimmer;
    let mut starts = vec![[start.sphere_radius / start.total_length(), start.chi.ln()]];
    for radius in GRID.0 {
        starts.extend(GRID.1.map(|chi| [radius, chi.ln()]));
    }
    let price = |at: &[f64; 2]| {
        let values = ideal.values(at)?;
        let residuals: Vec<f64> = values
            .iter()
            .zip(&data.values)
            .map(|(a, b)| a - b)
            .collect();
        Some(cost(&residuals, weights))
    };
    let mut ranked: Vec<([f64; 2], f64)> = starts
        .iter()
        .filter_map(|at| Some((*at, price(at)?)))
        .collect();
    ranked.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut ends: Vec<[f64; 2]> = Vec::new();
    for (start, _) in ranked.iter().take(FOLLOWED) {
        let end = minimise(&ideal, &data.values, weights, start, &bounds);
        let Some(&[radius, chi]) = end.as_ref().map(|end| end.at.as_slice()) else {
            continue;
        };
        if ends
            .iter()
            .all(|q| (q[0] - radius).abs() + (q[1] - chi).abs() > APART)
        {
            ends.push([radius, chi]);
        }
    }
    ends.iter()
        .flat_map(|[radius, chi]| [[*radius, *chi], [0.0, *chi]])
        .filter_map(|start| minimise(model, &data.values, weights, &start, &bounds))
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
        .ok_or(FitError::NoConvergence {
            starts: starts.len(),
        })
}
