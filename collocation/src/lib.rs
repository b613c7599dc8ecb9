//! Gaits of most Lighthill efficiency by direct collocation (paper, section V, where GPOPS-II does this): the second method, which
//! shares with the optimiser only A and W and where the bounds are. [`efficiency()`] has a gait polished and certified;
//! [`solve`] is collocation alone, with bounds as well.
//!
//! The problem on a quarter gait, t = 0 … 1: states z = (φ₁, φ₂, x, θ, E), control u = Φ̇, from φ₁ = φ₂ to φ₁ = −φ₂, make
//! `x_f²/E_f` greatest, |φᵢ| ≤ `φ_max`. It is discretised by Legendre–Gauss–Radau collocation of any degree on any mesh
//! (`radau`, `mesh`), and the mesh is refined until the states, integrated again with the interpolated control, agree
//! (`reintegration`).
//!
//! # Why a solver of our own
//!
//! The KKT matrix of collocation is a chain of small dense blocks. Each element condenses its own nodes and hands three
//! numbers' worth of quadratic to its neighbour (`block`, `elimination`), which costs less than a general sparse
//! factorisation spends on finding an order; and as φ̇ = u, θ, x and E can be solved for in one sweep, every iterate obeys
//! the state equations and the merit function is the objective with its barrier (`newton`), so neither filter nor
//! restoration is needed. Of the published crates `clarabel` is for convex problems only, `argmin` has no constraints,
//! `ipopt` binds to C, `interiors` builds its matrices anew at every call; `ripopt` and `pounce-rs`, ports of Ipopt in
//! Rust, are under the EPL and bring a second linear algebra.

mod block;
mod efficiency;
mod elimination;
mod error;
mod guess;
mod mesh;
mod newton;
mod path;
mod radau;
mod refine;
mod reintegration;
mod solution;
#[cfg(test)]
mod tests;
mod walls;

pub use efficiency::efficiency;
pub use error::CollocationError;
use guess::Fit;
pub use guess::QuarterGuess;
pub use solution::{BoundArc, CollocationNode, CollocationSolution, MeshRound};

use nalgebra::Vector2;
use swimmer_files::Bounds;
use swimmer_model::Model;

use mesh::Mesh;
use newton::{FIRST_BARRIER, Newton, Optimum};
use path::Path;
use refine::Verdict;
use walls::Wall;

/// What is to be solved, and how finely.
#[derive(Debug, Clone, Copy)]
pub struct CollocationProblem<'a> {
    /// The swimmer, its side links alike.
    pub model: &'a Model<f64>,
    /// Bounds of the shapes; not the sector, whose sides the quarter starts and ends on.
    pub bounds: Bounds,
    /// Whether x shall be positive or negative: +1 or −1.
    pub sign: f64,
    /// Elements of the first mesh.
    pub elements: usize,
    /// Degree of the first mesh's elements.
    pub degree: usize,
    /// What the error of each element may be: θ \[rad\], x over `x_f` and E over `E_f`, integrated again; and the square of
    /// the relative unevenness of the power, and of ten times
    /// the overstepping of a bound between nodes. 0 takes the first mesh as it is.
    pub tolerance: f64,
}

/// Where the mesh may go no further.
const MOST_POINTS: usize = 1500;
const MOST_ROUNDS: usize = 30;
/// Relative difference of ξ from that of the gait integrated again that no refinement could mend.
const SPURIOUS: f64 = 0.02;
/// Rounds in which element ends are put where bounds begin and end.
const KINK_ROUNDS: usize = 10;
/// The barrier on every mesh but the first.
const AGAIN_BARRIER: f64 = 1e-9;
/// A point whose multiplier wants it this near to a wall \[rad\] is put there.
const NEAR_WALL: f64 = 1e-5;
/// Share of the largest multiplier of a bound above which it counts as active.
const ACTIVE: f64 = 1e-3;
/// Multiplier density below which no bound is active, in an objective of order one.
const ACTIVE_AT_ALL: f64 = 1e-6;
/// Without a bound no angle may leave two turns.
const HORIZON: f64 = 2.0 * std::f64::consts::TAU;

impl<'a> CollocationProblem<'a> {
    /// The problem without bounds on 20 elements of degree 5, tolerance 10⁻⁸.
    pub fn new(model: &'a Model<f64>, sign: f64) -> Self {
        Self {
            model,
            bounds: Bounds::default(),
            sign,
            elements: 20,
            degree: 5,
            tolerance: 1e-8,
        }
    }

    /// With |φᵢ| ≤ `max_angle` \[rad\].
    #[must_use]
    pub fn with_max_angle(mut self, max_angle: f64) -> Self {
        self.bounds.max_angle = Some(max_angle);
        self
    }

    fn validate(&self) -> Result<Vec<Wall>, CollocationError> {
        let refuse = |name, value, problem| {
            Err(CollocationError::Problem {
                name,
                value,
                problem,
            })
        };
        let links = self.model.swimmer().links;
        if (links.front - links.back).abs() > 1e-12 * links.front.abs() {
            return Err(CollocationError::Asymmetric {
                front: links.front,
                back: links.back,
            });
        }
        if self.sign.abs().to_bits() != 1.0_f64.to_bits() {
            return refuse("sign", self.sign, "it must be 1 or −1");
        }
        if self.elements == 0 || self.elements > 1000 {
            return refuse("elements", self.elements as f64, "use 1 to 1000");
        }
        if self.degree < 2 || self.degree > radau::HIGHEST_DEGREE {
            return refuse("degree", self.degree as f64, "use 2 to 16");
        }
        if self.tolerance < 0.0 || self.tolerance.is_nan() {
            return refuse("tolerance", self.tolerance, "it must not be negative");
        }
        let angle = |value: f64| value > 0.0 && value <= HORIZON;
        let bounds = &self.bounds;
        if let Some(max) = bounds.max_angle.filter(|&max| !angle(max)) {
            return refuse("max_angle", max, "it must be above 0 and at most two turns");
        }
        let highest = bounds.max_angle.unwrap_or(HORIZON);
        if let Some(min) = bounds
            .min_angle
            .filter(|&min| !angle(min) || min >= highest)
        {
            return refuse(
                "min_angle",
                min,
                "it must be above 0 and below the upper bound",
            );
        }
        if bounds.sector {
            return refuse(
                "sector",
                1.0,
                "a smooth gait crosses its sides; leave it out",
            );
        }
        if bounds.clearance.is_nan() || bounds.clearance < 0.0 || bounds.clearance >= links.middle {
            return refuse(
                "clearance",
                bounds.clearance,
                "it must be 0 or above, and below the middle link's length",
            );
        }
        Ok(Wall::all(bounds, &links))
    }
}

/// ξ of a quarter: `c_t L x_f²/E_f`, `t_f = 1`.
fn lighthill(model: &Model<f64>, path: &Path) -> f64 {
    lighthill_of(model, path.final_x, path.final_energy)
}

fn lighthill_of(model: &Model<f64>, x: f64, energy: f64) -> f64 {
    model.side_drag() * model.swimmer().total_length() * x * x / energy
}

/// Solves from a guess, and refines the mesh until the tolerance is met. A guess that leaves the bounds is shrunk, and if
/// that leads nowhere, clipped.
///
/// # Errors
/// [`CollocationError`]: what is wrong with the problem or the guess, where the iteration stopped, or that the mesh could
/// not be made fine enough. A gait that does not survive its own re-integration is never returned.
///
/// ```
/// use collocation::{CollocationProblem, QuarterGuess, solve};
/// use swimmer_model::{Model, Swimmer};
///
/// let model = Model::new(&Swimmer::purcell()).unwrap();
/// let found = solve(&CollocationProblem::new(&model, 1.0), &QuarterGuess::circle(1.3)?)?;
/// assert!((found.efficiency - 0.012364154624).abs() < 1e-10);
/// let within = CollocationProblem::new(&model, 1.0).with_max_angle(1.2);
/// assert!(solve(&within, &found.guess()?)?.efficiency < found.efficiency);
/// # Ok::<(), collocation::CollocationError>(())
/// ```
pub fn solve(
    problem: &CollocationProblem<'_>,
    guess: &QuarterGuess,
) -> Result<CollocationSolution, CollocationError> {
    let walls = problem.validate()?;
    let shrunk = refined(problem, guess, &walls, Fit::Shrunk);
    if shrunk.is_ok() || guess.lies_inside(&walls) {
        return shrunk;
    }
    refined(problem, guess, &walls, Fit::Clipped).or(shrunk)
}

/// Mesh after mesh, from the guess on the first.
fn refined(
    problem: &CollocationProblem<'_>,
    guess: &QuarterGuess,
    walls: &[Wall],
    fit: Fit,
) -> Result<CollocationSolution, CollocationError> {
    let mut mesh = Mesh::even(problem.elements, problem.degree);
    let mut phi = guess.on(problem.model, &mesh, walls, fit)?;
    let mut barrier = FIRST_BARRIER;
    let mut rounds = Vec::new();
    loop {
        let newton = Newton::new(problem.model, &mesh, walls, problem.sign, HORIZON, phi);
        let optimum = newton.run(barrier)?;
        let again = reintegration::again(problem.model, &mesh, walls, &optimum.path);
        rounds.push(MeshRound {
            elements: mesh.elements.len(),
            nodes: mesh.len(),
            error: again.error(),
            uneven_power: again.uneven_power(),
            overstepped: again.overstepped(),
            efficiency: lighthill(problem.model, &optimum.path),
            iterations: optimum.iterations,
        });
        let (efficiency, swum) = (
            lighthill(problem.model, &optimum.path),
            lighthill_of(problem.model, again.final_x, again.final_energy),
        );
        // Refining a spurious optimum would only wake up somewhere else.
        let real =
            again.final_x * problem.sign > 0.0 && (swum / efficiency - 1.0).abs() <= SPURIOUS;
        if !real {
            return Err(CollocationError::Spurious {
                efficiency,
                again: swum,
                points: mesh.len(),
            });
        }
        let verdict = if problem.tolerance > 0.0 {
            // Where a few rounds did not settle the kinks, halving will.
            let kinks = if rounds.len() < KINK_ROUNDS {
                refine::kinks(&mesh, walls, &optimum)
            } else {
                Vec::new()
            };
            let pace = if rounds.len() <= 2 { 1.0 } else { 0.5 };
            refine::judge(&mesh, &kinks, pace, &again, problem.tolerance)
        } else {
            Verdict::Good
        };
        match verdict {
            Verdict::Good => {
                return Ok(solution::finish(
                    problem, &mesh, walls, optimum, &again, rounds,
                ));
            }
            Verdict::Finer(finer) if rounds.len() < MOST_ROUNDS && finer.len() <= MOST_POINTS => {
                barrier = AGAIN_BARRIER;
                phi = carried_over(&mesh, &finer, &optimum, walls, barrier);
                mesh = finer;
            }
            Verdict::Finer(_) => {
                return Err(CollocationError::NotResolved {
                    points: mesh.len(),
                    error: rounds.last().map_or(f64::NAN, |round| round.error),
                    uneven_power: rounds.last().map_or(f64::NAN, |round| round.uneven_power),
                    tolerance: problem.tolerance,
                });
            }
        }
    }
}

/// The shapes on a finer mesh, as near to the walls as the multipliers there want them.
fn carried_over(
    mesh: &Mesh,
    finer: &Mesh,
    optimum: &Optimum,
    walls: &[Wall],
    barrier: f64,
) -> Vec<Vector2<f64>> {
    let count = walls.len();
    finer
        .times
        .iter()
        .map(|&t| {
            let mut shape = mesh.shape(&optimum.path.phi, t);
            let (before, after, share) = mesh.between(t);
            for (k, wall) in walls.iter().enumerate() {
                let multiplier = optimum.multipliers[before * count + k] * (1.0 - share)
                    + optimum.multipliers[after * count + k] * share;
                let near = barrier / multiplier;
                if near < NEAR_WALL || wall.value(&shape) < barrier {
                    wall.draw(&mut shape, near.clamp(barrier, NEAR_WALL));
                }
            }
            shape
        })
        .collect()
}
