//! Efficiency of truncated Fourier series against their order (paper, Appendix C).

use super::chain::starts;
use super::fourier::{Objective, climb, series};
use super::{EfficiencyError, EfficiencyProblem};

/// Predicted gain at which the ascent of one order stops.
const LEAST_GAIN: f64 = 1e-12;
/// Fewest panels of a quarter, and panels for each order.
const PANELS: (usize, usize) = (22, 4);

/// Returns ξ of the best gaits of a branch that are Fourier series of order 1, 2, …, `highest`, without bounds: the sub-optimal gaits
/// of the paper's Appendix C. Each order starts from the one below it. Of several starts, that with the best gait of the highest
/// order counts.
///
/// # Errors
/// [`EfficiencyError`] if the problem is invalid or no start leads to a gait of the highest order.
///
/// ```
/// use gait_optimizer::{Branch, EfficiencyProblem, efficiency, efficiency_by_order};
/// use swimmer_model::Swimmer;
///
/// let problem = EfficiencyProblem::new(Swimmer::purcell(), Branch::Small);
/// let orders = efficiency_by_order(&problem, 4)?;
/// assert!(orders.is_sorted());
/// let missing = 1.0 - orders[3] / efficiency(&problem)?.efficiency;
/// assert!((0.0..1e-4).contains(&missing), "{missing}");
/// # Ok::<(), gait_optimizer::EfficiencyError>(())
/// ```
pub fn efficiency_by_order(
    problem: &EfficiencyProblem,
    highest: usize,
) -> Result<Vec<f64>, EfficiencyError> {
    let model = problem.validated()?;
    let branch = problem.branch;
    let from = |start: [f64; 2]| {
        let mut coefficients = start.to_vec();
        let mut efficiencies = Vec::with_capacity(highest);
        for order in 1..=highest {
            coefficients.resize(2 * order, 0.0);
            let (least, per_order) = PANELS;
            let mut objective = Objective::new(&model, order, least.max(per_order * order));
            let maximum = climb(|x| objective.expansion(x), &coefficients, LEAST_GAIN)?;
            efficiencies.push(maximum.value.efficiency());
            coefficients = maximum.coefficients;
        }
        let start_angle = series(&coefficients, 0.0).0.x;
        (start_angle > branch.least_start()).then_some(efficiencies)
    };
    starts(&model, branch)?
        .into_iter()
        .filter_map(from)
        .max_by(|a, b| {
            a.last()
                .partial_cmp(&b.last())
                .unwrap_or(std::cmp::Ordering::Equal)
        })
        .ok_or(EfficiencyError::NotConverged {
            branch,
            order: highest,
            efficiency: f64::NAN,
        })
}
