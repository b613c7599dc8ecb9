//! What direct collocation returns: the quarter gait with its costates, its active bounds, and what it was checked against.

use nalgebra::Vector2;
use swimmer_files::{AnyGait, ArcKind};

use super::mesh::Mesh;
use super::newton::Optimum;
use super::reintegration::Reintegration;
use super::walls::Wall;
use super::{ACTIVE, ACTIVE_AT_ALL, CollocationProblem, lighthill, lighthill_of};
use super::{CollocationError, QuarterGuess};

/// Samples of a quarter as a gait.
const SAMPLES: usize = 256;

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

/// One mesh of the refinement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshRound {
    /// Elements.
    pub elements: usize,
    /// Points, the first included.
    pub nodes: usize,
    /// Largest error of an element: θ \[rad\], x over `x_f`, E over `E_f`, integrated again.
    pub error: f64,
    /// Largest |P/`E_f` − 1| between nodes.
    pub uneven_power: f64,
    /// Largest overstepping of a bound between nodes, in rad, or over L for the distance of links.
    pub overstepped: f64,
    /// ξ.
    pub efficiency: f64,
    /// Newton steps.
    pub iterations: usize,
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
    /// Each mesh that was solved; the last is that of the solution.
    pub rounds: Vec<MeshRound>,
    /// Largest last Newton step \[rad\].
    pub last_step: f64,
    pub(crate) mesh: Mesh,
}

impl CollocationSolution {
    /// Joint angles at a time 0 … 1, on the solution's own polynomials.
    pub fn phi(&self, t: f64) -> Vector2<f64> {
        let Some(element) = self.mesh.holding(t) else {
            return Vector2::zeros();
        };
        let phi: Vec<Vector2<f64>> = self
            .nodes
            .iter()
            .map(|node| Vector2::new(node.state[0], node.state[1]))
            .collect();
        element.shape(&phi, t)
    }

    /// The quarter as a guess for another problem, such as a neighbouring bound.
    ///
    /// # Errors
    /// As [`QuarterGuess::from_samples`]; never for a solution that this module made.
    pub fn guess(&self) -> Result<QuarterGuess, CollocationError> {
        let nodes = self.nodes.iter();
        let samples: Vec<_> = nodes
            .map(|node| (node.t, [node.state[0], node.state[1]]))
            .collect();
        QuarterGuess::from_samples(&samples)
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

    /// Newton steps on all meshes together.
    pub fn iterations(&self) -> usize {
        self.rounds.iter().map(|round| round.iterations).sum()
    }

    /// Largest error of an element of the last mesh, integrated again.
    pub fn error(&self) -> f64 {
        self.rounds.last().map_or(f64::NAN, |round| round.error)
    }
}

pub(crate) fn finish(
    problem: &CollocationProblem<'_>,
    mesh: &Mesh,
    walls: &[Wall],
    optimum: Optimum,
    again: &Reintegration,
    rounds: Vec<MeshRound>,
) -> CollocationSolution {
    let Optimum {
        path,
        multipliers,
        lambda_theta,
        last_step,
        ..
    } = optimum;
    let along = path.travelled(mesh);
    let (x, energy) = (path.final_x, path.final_energy);
    // J = exp(−objective): its costates are those of the objective times −J.
    let merit = x * x / energy;
    let (of_x, of_energy) = (2.0 * x / energy, -merit / energy);
    let mut nodes: Vec<CollocationNode> = (0..mesh.len())
        .map(|point| {
            let node = &path.nodes[point];
            let phi = path.phi[point];
            let of_theta = of_x * lambda_theta[point];
            // H_u = 0, which the multipliers of φ̇ = u obey at every node.
            let carry = nalgebra::Vector3::new(of_x * node.cos, -of_x * node.sin, of_theta);
            let of_phi =
                -(node.connection.tr_mul(&carry) + node.power * node.rate * (2.0 * of_energy));
            let mut force = Vector2::zeros();
            for (wall, multiplier) in walls.iter().zip(&multipliers[point * walls.len()..]) {
                force -= wall.margin(&phi).gradient * (multiplier * merit);
            }
            CollocationNode {
                t: mesh.times[point],
                state: [phi.x, phi.y, along[point][0], node.theta, along[point][2]],
                control: node.rate.into(),
                costate: [of_phi.x, of_phi.y, of_x, of_theta, of_energy],
                bound_force: force.into(),
                y: again.y[point],
            }
        })
        .collect();
    extrapolate_first(mesh, &mut nodes);
    let rounds_efficiency = lighthill(problem.model, &path);
    CollocationSolution {
        turning_number: turning_number(&nodes),
        bound_arcs: bound_arcs(&nodes, walls, &multipliers),
        nodes,
        final_x: x,
        final_energy: energy,
        efficiency: rounds_efficiency,
        efficiency_again: lighthill_of(problem.model, again.final_x, again.final_energy),
        rounds,
        last_step,
        mesh: mesh.clone(),
    }
}

/// Control and costates at t = 0 on the polynomials of the first element's nodes.
fn extrapolate_first(mesh: &Mesh, nodes: &mut [CollocationNode]) {
    let Some(element) = mesh.elements.first() else {
        return;
    };
    let mut shares = super::radau::NO_SHARES;
    element.rule.rate_shares(0.0, &mut shares);
    let (mut control, mut costate) = ([0.0; 2], [0.0; 5]);
    for (node, share) in nodes.iter().zip(shares).skip(1) {
        for (sum, value) in control.iter_mut().zip(node.control) {
            *sum += share * value;
        }
        for (sum, value) in costate.iter_mut().zip(node.costate) {
            *sum += share * value;
        }
    }
    if let Some(first) = nodes.first_mut() {
        (first.control, first.costate) = (control, costate);
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
fn bound_arcs(nodes: &[CollocationNode], walls: &[Wall], multipliers: &[f64]) -> Vec<BoundArc> {
    let count = walls.len();
    let mut arcs: Vec<BoundArc> = Vec::new();
    for (k, wall) in walls.iter().enumerate() {
        let multiplier = |point: usize| multipliers[point * count + k];
        let largest = (0..nodes.len()).map(multiplier).fold(0.0, f64::max);
        let mut open: Option<BoundArc> = None;
        for (point, node) in nodes.iter().enumerate() {
            if largest < ACTIVE_AT_ALL || multiplier(point) < ACTIVE * largest {
                arcs.extend(open.take());
                continue;
            }
            let normal = -wall
                .margin(&Vector2::new(node.state[0], node.state[1]))
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
