//! The state equations integrated again, along the same polynomials, by a rule of high degree between any two nodes.
//!
//! φ̇ = u holds for polynomials whatever the mesh. What a coarse mesh gets wrong are θ, x and E, and a spurious optimum of
//! the discretisation lives on just that; so each element is integrated again from where it starts, and the whole quarter
//! from its beginning.

use swimmer_model::Model;

use super::mesh::Mesh;
use super::path::Path;
use super::walls::Wall;

/// Errors of each element and the quarter swum again.
#[derive(Debug, Clone)]
pub(crate) struct Reintegration {
    /// Of each element: the largest error at its nodes of θ \[rad\], of x over `x_f` and of E over `E_f`.
    pub(crate) errors: Vec<f64>,
    /// Of each element: least and largest P/`E_f` − 1. The power of an optimum is constant.
    pub(crate) power: Vec<[f64; 2]>,
    /// Of each element: how far it is beyond a bound between the nodes, where nothing keeps it, in rad or over L.
    pub(crate) overstepped: Vec<f64>,
    pub(crate) final_x: f64,
    pub(crate) final_energy: f64,
    /// y at every point of the mesh.
    pub(crate) y: Vec<f64>,
}

/// Degree of the rule between two nodes.
const FINE: usize = 12;

impl Reintegration {
    /// Largest error of an element.
    pub(crate) fn error(&self) -> f64 {
        self.errors.iter().copied().fold(0.0, f64::max)
    }

    /// Largest |P/`E_f` − 1|.
    pub(crate) fn uneven_power(&self) -> f64 {
        self.power
            .iter()
            .flatten()
            .fold(0.0, |most, off| most.max(off.abs()))
    }

    /// Largest overstepping of a bound.
    pub(crate) fn overstepped(&self) -> f64 {
        self.overstepped.iter().copied().fold(0.0, f64::max)
    }
}

/// Integrates a path again.
pub(crate) fn again(model: &Model<f64>, mesh: &Mesh, walls: &[Wall], path: &Path) -> Reintegration {
    let fine = Mesh::new(&mesh.times, &vec![FINE; mesh.len() - 1]);
    let shapes = fine.times.iter().map(|&t| mesh.shape(&path.phi, t));
    let swum = Path::new(model, &fine, shapes.collect());
    let (collocated, again) = (path.travelled(mesh), swum.travelled(&fine));
    let (of_x, of_energy) = (1.0 / path.final_x.abs(), 1.0 / path.final_energy);
    let mut found = Reintegration {
        errors: Vec::with_capacity(mesh.elements.len()),
        power: Vec::with_capacity(mesh.elements.len()),
        overstepped: Vec::with_capacity(mesh.elements.len()),
        final_x: swum.final_x,
        final_energy: swum.final_energy,
        y: again.iter().step_by(FINE).map(|state| state[1]).collect(),
    };
    for element in &mesh.elements {
        let first = element.first;
        let (here, there) = (collocated[first], again[first * FINE]);
        // The element by itself starts from the collocated θ.
        let turn = path.nodes[first].theta - swum.nodes[first * FINE].theta;
        let (sin, cos) = turn.sin_cos();
        let mut error: f64 = 0.0;
        for point in element.points().skip(1) {
            let [dx, dy, energy] = std::array::from_fn(|i| again[point * FINE][i] - there[i]);
            let [x, _, spent] = std::array::from_fn(|i| collocated[point][i] - here[i]);
            let turned = swum.nodes[point * FINE].theta + turn;
            error = error
                .max((cos * dx - sin * dy - x).abs() * of_x)
                .max((energy - spent).abs() * of_energy)
                .max((turned - path.nodes[point].theta).abs());
        }
        found.errors.push(error);
        let within = first * FINE + 1..=(first + element.rule.degree) * FINE;
        let mut power = [f64::INFINITY, f64::NEG_INFINITY];
        let mut overstepped: f64 = 0.0;
        for (node, phi) in swum.nodes[within.clone()].iter().zip(&swum.phi[within]) {
            let off = node.power_spent() * of_energy - 1.0;
            power = [power[0].min(off), power[1].max(off)];
            for wall in walls {
                overstepped = overstepped.max(-wall.value(phi));
            }
        }
        found.power.push(power);
        found.overstepped.push(overstepped);
    }
    found
}
