//! What direct collocation returns: the quarter gait with its costates, its active bounds, and what it was checked against.

use gait_optimizer::region::Bound;
use nalgebra::{DMatrix, Matrix2xX, Vector2};
use swimmer_files::{AnyGait, ArcKind};
use swimmer_model::Model;

use super::mesh::Mesh;
use super::newton::Optimum;
use super::reintegration::Reintegration;
use super::{CollocationError, QuarterGuess, lighthill};

/// Samples of a quarter as a gait.
const SAMPLES: usize = 256;
/// Share of the largest multiplier of a bound above which it counts as active.
const ACTIVE: f64 = 1e-3;
/// Multiplier density below which no bound is active, in an objective of order one.
const ACTIVE_AT_ALL: f64 = 1e-6;

/// One point of the solution. The costates are those of the paper's section V, for J = `x_f²/E_f` made greatest, by the
/// covector mapping from the multipliers of the discretised equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CollocationNode {
    /// Time, 0 to 1 over the quarter.
    pub t: f64,
    /// φ₁, φ₂ \[rad\], x, θ \[rad\], E/μ.
    pub state: [f64; 5],
    /// φ̇₁, φ̇₂.
    pub control: [f64; 2],
    /// λ₁ … λ₅.
    pub costate: [f64; 5],
    /// What the bounds add to λ̇₁, λ̇₂: the sum of their multipliers (≥ 0) times their outward gradients. For |φᵢ| ≤ `φ_max`
    /// just the multiplier, with the sign of φᵢ.
    pub bound_force: [f64; 2],
    /// y from the integration again; `λ₄ = λ₃(y − y_f)` holds at an optimum.
    pub y: f64,
}

/// An interval of time along a bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundArc {
    /// What the bound is.
    pub kind: ArcKind,
    /// Unit normal of the bound where the arc begins, out of the region.
    pub normal: [f64; 2],
    /// First point of time on the bound that is a node.
    pub from: f64,
    /// The last one.
    pub to: f64,
}

/// A collocated optimum.
#[derive(Debug, Clone)]
pub struct CollocationSolution {
    /// The points in order of time; the first is no collocation node, its control and costates are extrapolated.
    pub nodes: Vec<CollocationNode>,
    /// Where the quarter runs along a bound.
    pub bound_arcs: Vec<BoundArc>,
    /// `x_f`.
    pub final_x: f64,
    /// `E_f/μ`.
    pub final_energy: f64,
    /// Lighthill's efficiency ξ.
    pub efficiency: f64,
    /// ξ of the whole quarter integrated again with the interpolated control.
    pub efficiency_again: f64,
    /// How often the direction turns round in a whole cycle: 1 for a simple counter-clockwise curve. Others are optima too,
    /// of curves with loops, in which displacement is not worth much.
    pub turning_number: f64,
    /// Largest overstepping of a bound between nodes, in rad, or over L for the distance of links.
    pub overstepped: f64,
    /// Newton steps.
    pub iterations: usize,
    pub(crate) phi: Matrix2xX<f64>,
    pub(crate) mesh: Mesh,
}

impl CollocationSolution {
    /// Joint angles at a time 0 … 1, on the solution's own polynomials.
    pub fn phi(&self, t: f64) -> Vector2<f64> {
        self.mesh.shape(&self.phi, t)
    }

    /// The quarter as a guess for another problem, such as a neighbouring bound.
    pub fn guess(&self) -> QuarterGuess {
        QuarterGuess::of(self.phi.clone())
    }

    /// The whole cycle, by the paper's two symmetries, smooth throughout: of a solution that keeps off the corners of its bounds.
    ///
    /// # Errors
    /// [`CollocationError::Guess`]: its samples make no closed curve; never for a solution that this crate made.
    pub fn gait(&self) -> Result<AnyGait, CollocationError> {
        let quarter: Vec<_> = (0..=SAMPLES)
            .map(|i| self.phi(i as f64 / SAMPLES as f64))
            .collect();
        // On φ₁ = −φ₂ the way back is the way there, mirrored; the second half is the first turned by half a turn.
        let mirrored = quarter.iter().rev().map(|phi| -Vector2::new(phi.y, phi.x));
        let half: Vec<_> = quarter.iter().copied().chain(mirrored.skip(1)).collect();
        let other = half.iter().skip(1).map(|phi| -phi);
        let phi: Vec<_> = half
            .iter()
            .copied()
            .chain(other)
            .take(4 * SAMPLES)
            .collect();
        let u: Vec<_> = (0..phi.len())
            .map(|i| i as f64 / phi.len() as f64)
            .collect();
        AnyGait::from_samples(&u, &phi, &[]).map_err(|_| CollocationError::Guess {
            problem: "its samples make no closed curve",
        })
    }
}

pub(crate) fn finish(
    model: &Model<f64>,
    mesh: Mesh,
    walls: &[Bound],
    optimum: Optimum,
    again: &Reintegration,
) -> CollocationSolution {
    let Optimum {
        path,
        multipliers,
        lambda_theta,
        iterations,
    } = optimum;
    let along = path.travelled(&mesh);
    let (x, energy) = (path.final_x, path.final_energy);
    // J = exp(−objective): its costates are those of the objective times −J.
    let merit = x * x / energy;
    let (of_x, of_energy) = (2.0 * x / energy, -merit / energy);
    let mut nodes: Vec<CollocationNode> = (0..mesh.len())
        .map(|point| {
            let (phi, control) = (
                path.phi.column(point).into_owned(),
                path.control.column(point),
            );
            // H_u = 0, which the multipliers of φ̇ = u obey at every node.
            let carry = path.carry(point, lambda_theta[point]) * of_x;
            let physics = &path.physics[point];
            let of_phi =
                -(physics.connection.tr_mul(&carry) + physics.power * control * (2.0 * of_energy));
            let mut force = Vector2::zeros();
            for (wall, multiplier) in walls.iter().zip(&multipliers.column(point)) {
                force -= wall.smooth_level(&phi).gradient * (multiplier * merit);
            }
            CollocationNode {
                t: mesh.times[point],
                state: [
                    phi.x,
                    phi.y,
                    along[(0, point)],
                    path.theta[point],
                    along[(2, point)],
                ],
                control: control.into_owned().into(),
                costate: [of_phi.x, of_phi.y, of_x, carry.z, of_energy],
                bound_force: force.into(),
                y: again.y[point],
            }
        })
        .collect();
    // At t = 0 on the polynomials of the first element's nodes.
    let shares = mesh.rule.shares_at_start();
    let (first, later) = nodes.split_at_mut(1);
    let at_start = |of: &dyn Fn(&CollocationNode) -> f64| -> f64 {
        later
            .iter()
            .zip(&shares)
            .map(|(node, share)| share * of(node))
            .sum()
    };
    first[0].control = [0, 1].map(|i| at_start(&|node| node.control[i]));
    first[0].costate = [0, 1, 2, 3, 4].map(|i| at_start(&|node| node.costate[i]));
    CollocationSolution {
        turning_number: turning_number(&nodes),
        bound_arcs: bound_arcs(&nodes, walls, &multipliers),
        nodes,
        final_x: x,
        final_energy: energy,
        efficiency: lighthill(model, x, energy),
        efficiency_again: lighthill(model, again.final_x, again.final_energy),
        overstepped: again.overstepped,
        iterations,
        phi: path.phi,
        mesh,
    }
}

/// The turns from node to node, begun and ended square to the symmetry lines as the whole cycle is.
fn turning_number(nodes: &[CollocationNode]) -> f64 {
    let mut before = Vector2::new(-1.0, 1.0);
    let mut turned = 0.0;
    let controls = nodes.iter().skip(1).map(|node| node.control.into());
    for direction in controls.chain([Vector2::new(-1.0, -1.0)]) {
        turned += before.perp(&direction).atan2(before.dot(&direction));
        before = direction;
    }
    4.0 * turned / std::f64::consts::TAU
}

/// Runs of nodes with an active multiplier.
fn bound_arcs(
    nodes: &[CollocationNode],
    walls: &[Bound],
    multipliers: &DMatrix<f64>,
) -> Vec<BoundArc> {
    let mut arcs: Vec<BoundArc> = Vec::new();
    for (k, wall) in walls.iter().enumerate() {
        let multipliers = multipliers.row(k);
        let largest = multipliers.max();
        let mut open: Option<BoundArc> = None;
        for (node, &multiplier) in nodes.iter().zip(multipliers.iter()) {
            if largest < ACTIVE_AT_ALL || multiplier < ACTIVE * largest {
                arcs.extend(open.take());
                continue;
            }
            let normal = -wall
                .smooth_level(&Vector2::new(node.state[0], node.state[1]))
                .gradient
                .normalize();
            open.get_or_insert(BoundArc {
                kind: wall.kind(),
                normal: normal.into(),
                from: node.t,
                to: node.t,
            })
            .to = node.t;
        }
        arcs.extend(open);
    }
    arcs.sort_by(|a, b| a.from.total_cmp(&b.from));
    arcs
}
