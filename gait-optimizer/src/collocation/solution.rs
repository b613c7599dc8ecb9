//! What direct collocation returns: the quarter gait with its costates, its active bounds, and what it was checked against.

use nalgebra::Vector2;

use super::again::Again;
use super::mesh::Mesh;
use super::newton::Optimum;
use super::walls::Wall;
use super::{CollocationProblem, lighthill, lighthill_of};

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
    /// Multiplier density of the bound, per φᵢ: of φᵢ ≤ `φ_max` if positive, of φᵢ ≥ −`φ_max` if negative. In units of λ̇.
    pub bound_multiplier: [f64; 2],
    /// y from the integration again; `λ₄ = λ₃(y − y_f)` holds at an optimum.
    pub y: f64,
}

/// An interval of time along a bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundArc {
    /// Which joint is held, 0 for φ₁.
    pub joint: usize,
    /// +1 at `φ_max`, −1 at −`φ_max`.
    pub side: f64,
    /// First time on the bound, to within a node's distance.
    pub from: f64,
    /// Last time on the bound.
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

    /// Newton steps on all meshes together.
    pub fn iterations(&self) -> usize {
        self.rounds.iter().map(|round| round.iterations).sum()
    }

    /// Largest error of an element of the last mesh, integrated again.
    pub fn error(&self) -> f64 {
        self.rounds.last().map_or(f64::NAN, |round| round.error)
    }
}

/// Share of the largest multiplier above which a bound counts as active.
const ACTIVE: f64 = 1e-4;

pub(crate) fn finish(
    problem: &CollocationProblem<'_>,
    mesh: &Mesh,
    walls: &[Wall],
    optimum: Optimum,
    again: &Again,
    rounds: Vec<MeshRound>,
) -> CollocationSolution {
    let Optimum {
        path,
        multipliers,
        lambda_theta,
        last_step,
        ..
    } = optimum;
    let along = path.distance_and_energy(mesh);
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
            let mut bound_multiplier = [0.0; 2];
            for (wall, multiplier) in walls.iter().zip(&multipliers[point * walls.len()..]) {
                let Wall::Angle { joint, sign, .. } = *wall;
                bound_multiplier[joint] += sign * multiplier * merit;
            }
            CollocationNode {
                t: mesh.times[point],
                state: [phi.x, phi.y, along[point].0, node.theta, along[point].1],
                control: node.rate.into(),
                costate: [of_phi.x, of_phi.y, of_x, of_theta, of_energy],
                bound_multiplier,
                y: again.y[point],
            }
        })
        .collect();
    extrapolate_first(mesh, &mut nodes);
    let rounds_efficiency = lighthill(problem.model, &path);
    CollocationSolution {
        bound_arcs: bound_arcs(&nodes),
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

/// Runs of nodes with an active multiplier.
fn bound_arcs(nodes: &[CollocationNode]) -> Vec<BoundArc> {
    let largest = nodes
        .iter()
        .flat_map(|node| node.bound_multiplier)
        .fold(0.0, |most: f64, value| most.max(value.abs()));
    let mut arcs: Vec<BoundArc> = Vec::new();
    for joint in 0..2 {
        let mut open: Option<BoundArc> = None;
        for node in nodes {
            let value = node.bound_multiplier[joint];
            let active = value.abs() > ACTIVE * largest && largest > 1e-9;
            let side = value.signum();
            match &mut open {
                Some(arc) if active && arc.side.to_bits() == side.to_bits() => arc.to = node.t,
                _ => {
                    arcs.extend(open.take());
                    open = active.then_some(BoundArc {
                        joint,
                        side,
                        from: node.t,
                        to: node.t,
                    });
                }
            }
        }
        arcs.extend(open);
    }
    arcs.sort_by(|a, b| a.from.total_cmp(&b.from));
    arcs
}
