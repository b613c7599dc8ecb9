//! From a problem to a certified gait with collocation in between: circles, collocation, and the optimiser's polish.

use gait_optimizer::{
    Direct, EfficiencyProblem, Objective, OptimalGait, SimpleShape, best_amplitudes,
    efficiency_from,
};

use super::error::CollocationError;
use super::problem::CollocationProblem;
use super::solve::solve;

/// Circles up to this amplitude are tried \[rad\].
const LARGEST: f64 = 5.0;

/// The gait of most Lighthill efficiency of a branch, found by collocation from the locally best circles, then polished and
/// certified by the optimiser. What collocation itself says of it is in the figures' `direct_efficiency`.
///
/// # Errors
/// [`CollocationError`]: what is wrong with the problem, or that there is no such gait.
///
/// ```
/// use gait_optimizer::{Branch, EfficiencyProblem};
/// use swimmer_model::Swimmer;
///
/// let gait = collocation::efficiency(&EfficiencyProblem::new(Swimmer::purcell(), Branch::Small))?;
/// assert!((gait.efficiency - 0.012364154624).abs() < 1e-12);
/// # Ok::<(), collocation::CollocationError>(())
/// ```
pub fn efficiency(problem: &EfficiencyProblem) -> Result<OptimalGait, CollocationError> {
    let model = problem.validated()?;
    let branch = problem.branch;
    let circles = best_amplitudes(&model, SimpleShape::Circle, Objective::Efficiency, LARGEST);
    circles
        .iter()
        .filter(|circle| circle.displacement_over_length * branch.sign() > 0.0)
        .map(|circle| {
            let guess = SimpleShape::Circle.gait(circle.amplitude);
            let solution = solve(&CollocationProblem::new(&model, branch.sign()), &guess)?;
            let direct = Direct {
                method: "collocation",
                gait: &solution.gait()?,
                efficiency: solution.efficiency,
            };
            Ok(efficiency_from(problem, &direct)?)
        })
        // The best one, else the first error.
        .reduce(|best, next| match (&best, &next) {
            (Err(_), Ok(_)) => next,
            (Ok(gait), Ok(other)) if other.efficiency > gait.efficiency => next,
            _ => best,
        })
        .unwrap_or(Err(CollocationError::NoStart { branch }))
}
