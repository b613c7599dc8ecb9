//! Certified efficiency gaits by collocation: starts from circles, collocates, and polishes with the optimiser's shooting.

use gait_optimizer::{
    Direct, EfficiencyProblem, Objective, OptimalGait, SimpleShape, Watch, best_amplitudes,
    efficiency_from,
};

use super::error::CollocationError;
use super::problem::CollocationProblem;
use super::solve::solve;

/// Largest amplitude of the circles that serve as initial guesses \[rad\].
const LARGEST: f64 = 5.0;

/// Returns the gait with the greatest Lighthill efficiency of a branch: collocated from the locally best circles, then polished
/// and certified by the optimiser. `watch` receives 0 at each start, then the progress of the optimiser. `EfficiencyFigures::direct_efficiency` keeps the efficiency of the collocation itself.
///
/// # Errors
/// [`CollocationError`] if the problem is invalid or no such gait was found.
///
/// ```
/// use gait_optimizer::{Branch, EfficiencyProblem};
/// use swimmer_model::Swimmer;
///
/// let gait = collocation::efficiency(&EfficiencyProblem::new(Swimmer::purcell(), Branch::Small), &|_| ())?;
/// assert!((gait.efficiency - 0.012364154624).abs() < 1e-12);
/// # Ok::<(), collocation::CollocationError>(())
/// ```
pub fn efficiency(
    problem: &EfficiencyProblem,
    watch: Watch<'_>,
) -> Result<OptimalGait, CollocationError> {
    let model = problem.validated()?;
    let branch = problem.branch;
    let circles = best_amplitudes(&model, SimpleShape::Circle, Objective::Efficiency, LARGEST);
    circles
        .iter()
        .inspect(|_| watch(0.0))
        .filter(|circle| circle.displacement_over_length * branch.sign() > 0.0)
        .map(|circle| {
            let guess = SimpleShape::Circle.gait(circle.amplitude);
            let solution = solve(&CollocationProblem::new(&model, branch.sign()), &guess)?;
            let direct = Direct {
                method: "collocation",
                gait: &solution.gait()?,
                efficiency: solution.efficiency,
            };
            Ok(efficiency_from(problem, &direct, watch)?)
        })
        // The best gait, or the first error if no start succeeds.
        .reduce(|best, next| match (&best, &next) {
            (Err(_), Ok(_)) => next,
            (Ok(gait), Ok(other)) if other.efficiency > gait.efficiency => next,
            _ => best,
        })
        .unwrap_or(Err(CollocationError::NoStart { branch }))
}
