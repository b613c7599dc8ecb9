//! Influence of single runs: leave-one-out fits, and outliers against all others.
//!
//! A value stands out when the fit without it, with variances estimated without it too, predicts something else than was
//! measured, by more than Student's t allows at 1 % after as many looks as there are values. The worst goes first; then the
//! others are looked at again, for a bad one hides behind a worse.

use super::surface::Surface;
use crate::fit::likelihood::Estimate;
use crate::fit::outliers::{self, FALSE_ALARM};
use crate::fit::run_values::RunValues;
use crate::quantities::QUANTITIES;

/// Number of values per value that may be left out.
const VALUES_FOR_ONE: usize = 6;

/// A value that the others do not expect.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unexpected {
    pub(super) row: usize,
    /// RunValues less what the others predict, in standard errors of that difference.
    pub(super) standard_errors: f64,
    /// The same in the value's units.
    pub(super) deviation: f64,
    /// Chance of so large a deviation among all values looked at.
    pub(super) chance: f64,
}

/// Leaves out what stands out, and estimates from the rest.
pub(super) fn without_outliers(
    surface: &Surface,
    data: &RunValues,
    start: [f64; 2],
) -> Option<(RunValues, Estimate, Vec<Unexpected>)> {
    let mut data = data.clone();
    let mut estimate = Estimate::of(surface, &data, &start)?;
    let mut found: Vec<Unexpected> = Vec::new();
    let most = data.count() / VALUES_FOR_ONE;
    while found.len() < most {
        let looks = data.count();
        let rows = (0..data.values.len()).filter(|row| data.used[*row]);
        let worst = rows
            .filter_map(|row| unexpected(surface, &data, &estimate.at, row, looks))
            .min_by(|a, b| a.chance.total_cmp(&b.chance));
        let Some(worst) = worst.filter(|worst| worst.chance < FALSE_ALARM) else {
            break;
        };
        let without = data.without(|row| row == worst.row);
        let Some(next) = Estimate::of(surface, &without, &estimate.at) else {
            break;
        };
        found.push(worst);
        (data, estimate) = (without, next);
    }
    Some((data, estimate, found))
}

fn unexpected(
    surface: &Surface,
    data: &RunValues,
    start: &[f64],
    row: usize,
    looks: usize,
) -> Option<Unexpected> {
    let without = data.without(|other| other == row);
    let rest = Estimate::of(surface, &without, start)?;
    let gradient = rest.jacobian.row(row);
    let predicted = (gradient * rest.components.covariance() * gradient.transpose())[(0, 0)];
    let variance = predicted + rest.components.variance(row);
    let deviation = -rest.residuals[row];
    let standard_errors = deviation / variance.sqrt();
    let chance = outliers::chance(&rest.components, row, standard_errors, looks)?;
    Some(Unexpected {
        row,
        standard_errors,
        deviation,
        chance,
    })
}

/// The estimate without each run; `None` where the others do not determine it.
pub(super) fn leave_one_out(
    surface: &Surface,
    data: &RunValues,
    start: [f64; 2],
) -> Vec<Option<[f64; 2]>> {
    (0..data.values.len() / QUANTITIES)
        .map(|run| {
            let without = data.without(|row| row / QUANTITIES == run);
            let found = Estimate::of(surface, &without, &start)?.at;
            let at = [found[0], found[1]];
            surface.rectangle.holds(at).then_some(at)
        })
        .collect()
}
