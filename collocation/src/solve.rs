//! Solution by a coarse mesh, then a fine one, with re-integration of the states as a check.

use gait_optimizer::region::Bound;
use nalgebra::{Matrix2xX, Vector2};
use swimmer_model::Gait;

use super::error::CollocationError;
use super::mesh::Mesh;
use super::newton::Newton;
use super::path::{Path, levels};
use super::problem::CollocationProblem;
use super::solution::CollocationSolution;
use super::{guess, radau};

/// Largest relative difference of ξ from that of the re-integrated gait. A larger one marks a spurious optimum of the mesh.
const TOLERANCE: f64 = 1e-6;
/// The same limit on the coarse mesh, for a result without bounds or for the initial guess of the fine mesh with bounds.
const AGREED: f64 = 1e-10;
const ROUGH: f64 = 1e-3;
/// Ratio of the numbers of elements of the fine and the coarse mesh.
const COARSER: usize = 4;
/// Barrier parameter at the start, at the change of meshes and at the end. The objective, ln E − 2 ln x, is of order one.
const FIRST_BARRIER: f64 = 1e-2;
const HANDED_ON: f64 = 1e-5;
const LAST_BARRIER: f64 = 1e-10;

impl CollocationProblem<'_> {
    /// Solves one mesh and checks ξ against the re-integrated gait.
    fn solved(
        &self,
        walls: &[Bound],
        elements: usize,
        shape: &dyn Fn(f64) -> Vector2<f64>,
        barriers: [f64; 2],
        tolerance: f64,
    ) -> Result<CollocationSolution, CollocationError> {
        let mesh = Mesh::new(elements, self.degree);
        let phi = guess::on_mesh(shape, &mesh, walls, barriers[0])?;
        let path = Newton::new(self, &mesh, walls, phi, barriers[0]).run(barriers[1])?;
        // φ̇ = u is exact for polynomials on any mesh. A coarse mesh has errors in θ, x and E, and a spurious optimum exploits
        // them. So these states are integrated again along the same polynomials by the rule of the highest degree.
        let fine = Mesh::new(elements, radau::HIGHEST_DEGREE);
        let along = |t: &f64| mesh.shape(&path.phi, *t);
        let phi: Vec<_> = fine.times.iter().map(along).collect();
        let again = Path::new(self.model, &fine, Matrix2xX::from_columns(&phi));
        let beyond = levels(walls, &again.phi).map(|(_, level)| -level.value);
        let solution = CollocationSolution {
            efficiency: path.efficiency(self.model),
            efficiency_again: again.efficiency(self.model),
            overstepped: beyond.fold(0.0, f64::max),
            phi: path.phi,
            mesh,
        };
        let off = (solution.efficiency_again / solution.efficiency - 1.0).abs();
        if off <= tolerance && again.final_x * self.sign > 0.0 {
            return Ok(solution);
        }
        Err(CollocationError::Spurious {
            efficiency: solution.efficiency,
            again: solution.efficiency_again,
            points: solution.mesh.len(),
        })
    }
}

/// Solves the problem from the first quarter of `guess`, a gait that starts on φ₁ = φ₂ > 0 and runs counter-clockwise. A guess
/// that leaves the bounds is scaled down.
///
/// # Errors
/// [`CollocationError`] if the problem or the guess is invalid, the iteration does not converge, or the mesh is too coarse. A
/// gait whose re-integration disagrees is never returned.
///
/// ```
/// use collocation::{CollocationProblem, solve};
/// use swimmer_model::{Circle, Model, Swimmer};
///
/// let model = Model::new(&Swimmer::purcell()).unwrap();
/// let found = solve(&CollocationProblem::new(&model, 1.0), &Circle { amplitude: 1.3 })?;
/// assert!((found.efficiency - 0.012364154624).abs() < 1e-10);
/// let within = CollocationProblem::new(&model, 1.0).with_max_angle(1.2);
/// assert!(solve(&within, &found.gait()?)?.efficiency < found.efficiency);
/// # Ok::<(), collocation::CollocationError>(())
/// ```
pub fn solve<G: Gait<f64> + ?Sized>(
    problem: &CollocationProblem<'_>,
    guess: &G,
) -> Result<CollocationSolution, CollocationError> {
    let walls = problem.validate()?;
    let quarter = |t: f64| guess.at(0.25 * t).phi;
    let tolerance = if walls.is_empty() { AGREED } else { ROUGH };
    let few = problem.elements.div_ceil(COARSER);
    let coarse = problem.solved(&walls, few, &quarter, [FIRST_BARRIER, HANDED_ON], tolerance);
    if coarse.is_ok() && walls.is_empty() {
        return coarse;
    }
    let last = |shape: &dyn Fn(f64) -> Vector2<f64>, barrier| {
        problem.solved(
            &walls,
            problem.elements,
            shape,
            [barrier, LAST_BARRIER],
            TOLERANCE,
        )
    };
    coarse
        .and_then(|coarse| last(&|t| coarse.phi(t), HANDED_ON))
        .or_else(|_| last(&quarter, FIRST_BARRIER))
}
