//! Gaits of most Lighthill efficiency by direct collocation (paper, section V, where GPOPS-II does this): the second method, which
//! shares with the optimiser only A and W and where the bounds are. [`efficiency()`] has a gait polished and certified;
//! [`solve`] is collocation alone, with bounds as well.
//!
//! The problem on a quarter gait, t = 0 … 1: states z = (φ₁, φ₂, x, θ, E), control u = Φ̇, from φ₁ = φ₂ to φ₁ = −φ₂, make
//! `x_f²/E_f` greatest, |φᵢ| ≤ `φ_max`. It is discretised by Legendre–Gauss–Radau collocation on an even mesh (`radau`, `mesh`),
//! fine enough that the states, integrated again with the interpolated control, agree; else there is no answer. A coarse mesh
//! comes first: free gaits are so smooth that it mostly does, and with bounds the fine one starts where it ends.
//!
//! # Why a solver of our own
//!
//! As φ̇ = u, θ, x and E can be solved for in one sweep (`path`), every iterate obeys the state equations and the merit function
//! is the objective with its barrier (`newton`), so neither filter nor restoration is needed, and Newton's equation is small
//! enough for conjugate gradients. Of the published crates `clarabel` is for convex problems only, `argmin` has no constraints,
//! `ipopt` binds to C, `interiors` builds its matrices anew at every call; `ripopt` and `pounce-rs`, ports of Ipopt in
//! Rust, are under the EPL and bring a second linear algebra.

mod efficiency;
mod error;
mod guess;
mod mesh;
mod newton;
mod path;
mod radau;
mod solution;
#[cfg(test)]
mod tests;

pub use efficiency::efficiency;
pub use error::CollocationError;
pub use solution::CollocationSolution;

use gait_optimizer::region::{Bound, Level, Region};
use gait_optimizer::{Branch, EfficiencyProblem};
use nalgebra::{Matrix2xX, Vector2};
use swimmer_files::Bounds;
use swimmer_model::{Gait, Model};

use mesh::Mesh;
use newton::Newton;
use path::Path;

/// What is to be solved, and how finely.
#[derive(Debug, Clone, Copy)]
pub struct CollocationProblem<'a> {
    /// The swimmer, its side links alike.
    pub model: &'a Model<f64>,
    /// Bounds of the shapes; `max_angle` and `no_overlap` apply.
    pub bounds: Bounds,
    /// Whether x shall be positive or negative: +1 or −1.
    pub sign: f64,
    /// Elements of the last mesh. A first one with a quarter of them comes before, and without bounds may do.
    pub elements: usize,
    /// Degree of the elements.
    pub degree: usize,
}

/// Relative difference of ξ from that of the gait integrated again: more, and it is no gait but an optimum of the mesh.
const TOLERANCE: f64 = 1e-6;
/// The same on the first mesh, for an answer without bounds and for a start of the second mesh with them.
const AGREED: f64 = 1e-10;
const ROUGH: f64 = 1e-3;
/// How many times fewer elements than the last mesh the first has.
const COARSER: usize = 4;
/// Where the barrier begins, where one mesh hands it on to the other, and where it ends; it counts against an objective,
/// ln E − 2 ln x, of order one.
const FIRST_BARRIER: f64 = 1e-2;
const HANDED_ON: f64 = 1e-5;
const LAST_BARRIER: f64 = 1e-10;
/// Without a bound no angle may leave two turns.
const HORIZON: f64 = 2.0 * std::f64::consts::TAU;

impl<'a> CollocationProblem<'a> {
    /// The problem without bounds on 80 elements of degree 5.
    pub fn new(model: &'a Model<f64>, sign: f64) -> Self {
        Self {
            model,
            bounds: Bounds::default(),
            sign,
            elements: 80,
            degree: 5,
        }
    }

    /// With |φᵢ| ≤ `max_angle` \[rad\].
    #[must_use]
    pub fn with_max_angle(mut self, max_angle: f64) -> Self {
        self.bounds.max_angle = Some(max_angle);
        self
    }

    fn validate(&self) -> Result<Vec<Bound>, CollocationError> {
        let swimmer = *self.model.swimmer();
        EfficiencyProblem {
            bounds: self.bounds,
            ..EfficiencyProblem::new(swimmer, Branch::Small)
        }
        .validated()?;
        let refuse = |name, value, problem| {
            Err(CollocationError::Problem {
                name,
                value,
                problem,
            })
        };
        if self.sign.abs().to_bits() != 1.0_f64.to_bits() {
            return refuse("sign", self.sign, "it must be 1 or −1");
        }
        if self.elements == 0 || self.elements > 1000 {
            return refuse("elements", self.elements as f64, "use 1 to 1000");
        }
        if self.degree < 2 || self.degree > radau::HIGHEST_DEGREE {
            return refuse("degree", self.degree as f64, "use 2 to 16");
        }
        Ok(Region::new(&self.bounds, &swimmer.links).bounds().collect())
    }

    /// The optimum of one mesh, if its ξ agrees with that of the gait integrated again.
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
        // φ̇ = u holds for polynomials whatever the mesh. What a coarse mesh gets wrong are θ, x and E, and a spurious optimum of
        // the discretisation lives on just that: along the same polynomials they follow again by a rule of the highest degree.
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

/// How far shapes are within each wall, shape by shape with its number.
fn levels<'a>(
    walls: &'a [Bound],
    shapes: &'a Matrix2xX<f64>,
) -> impl Iterator<Item = (usize, Level)> + 'a {
    (0..shapes.ncols() * walls.len()).map(move |i| {
        let (point, wall) = (i / walls.len(), &walls[i % walls.len()]);
        (point, wall.smooth_level(&shapes.column(point).into_owned()))
    })
}

/// Solves from the first quarter of a gait that starts on φ₁ = φ₂ > 0 and runs counter-clockwise; one that leaves the bounds is
/// shrunk.
///
/// # Errors
/// [`CollocationError`]: what is wrong with the problem or the guess, where the iteration stopped, or that the
/// mesh is too coarse. A gait that does not survive its own re-integration is never returned.
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
