//! The state equations integrated again, with the control that the polynomials make, by a method that knows no mesh.
//!
//! φ̇ = u holds for polynomials whatever the mesh. What a coarse mesh gets wrong are θ, x and E, and a spurious optimum of
//! the discretisation lives on just that; so each element is integrated again from where it starts, and the whole quarter
//! from its beginning.

use nalgebra::Vector2;
use swimmer_model::Model;

use super::mesh::{Element, Mesh};
use super::path::Path;
use super::walls::Wall;
use crate::runge_kutta::{Point, StepControl, advance};

/// Errors of each element and the quarter swum again.
#[derive(Debug, Clone)]
pub(crate) struct Reintegration {
    /// Of each element: the largest error at its nodes of θ \[rad\], of x over `x_f` and of E over `E_f`.
    pub(crate) errors: Vec<f64>,
    /// Of each element: least and largest P/`E_f` − 1 between the nodes. The power of an optimum is constant.
    pub(crate) power: Vec<[f64; 2]>,
    /// Of each element: how far it is beyond a bound between the nodes, where nothing keeps it, in rad or over L.
    pub(crate) overstepped: Vec<f64>,
    pub(crate) final_x: f64,
    pub(crate) final_energy: f64,
    /// y at every point of the mesh.
    pub(crate) y: Vec<f64>,
}

/// Time, x, y, θ, E.
type State = [f64; 5];

/// Places between two nodes where the power is looked at.
const LOOKS: usize = 2;

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

/// Integrates again; none where the integrator gives up.
pub(crate) fn again(
    model: &Model<f64>,
    mesh: &Mesh,
    walls: &[Wall],
    path: &Path,
) -> Option<Reintegration> {
    let rates: Vec<Vector2<f64>> = path.nodes.iter().map(|node| node.rate).collect();
    let collocated = path.distance_and_energy(mesh);
    let (of_x, of_energy) = (1.0 / path.final_x.abs(), 1.0 / path.final_energy);
    let control = StepControl {
        tolerance: 1e-13,
        longest: 1.0,
    };
    let mut found = Reintegration {
        errors: Vec::with_capacity(mesh.elements.len()),
        power: Vec::with_capacity(mesh.elements.len()),
        overstepped: Vec::with_capacity(mesh.elements.len()),
        final_x: 0.0,
        final_energy: 0.0,
        y: vec![0.0; mesh.len()],
    };
    let mut whole: State = [0.0; 5];
    for element in &mesh.elements {
        let rate = |z: &State| rate(model, element, &path.phi, &rates, z);
        let first = element.first;
        // The element by itself starts from the collocated θ.
        let turn = path.nodes[first].theta - whole[3];
        let (sin, cos) = turn.sin_cos();
        let start = whole;
        let mut error: f64 = 0.0;
        for j in 1..=element.rule.degree {
            let length = mesh.times[first + j] - mesh.times[first + j - 1];
            whole = advance(&rate, Point::new(&rate, whole), length, control)?.z;
            let (dx, dy) = (whole[1] - start[1], whole[2] - start[2]);
            let x = collocated[first + j].0 - collocated[first].0;
            let energy = collocated[first + j].1 - collocated[first].1;
            let theta = path.nodes[first + j].theta - path.nodes[first].theta;
            error = error
                .max((cos * dx - sin * dy - x).abs() * of_x)
                .max((whole[4] - start[4] - energy).abs() * of_energy)
                .max((whole[3] - start[3] - theta).abs());
            found.y[first + j] = whole[2];
        }
        found.errors.push(error);
        let (power, overstepped) = between_nodes(model, walls, element, path, &rates);
        found.power.push(power.map(|power| power * of_energy - 1.0));
        found.overstepped.push(overstepped);
    }
    (found.final_x, found.final_energy) = (whole[1], whole[4]);
    Some(found)
}

fn rate(
    model: &Model<f64>,
    element: &Element,
    phi: &[Vector2<f64>],
    rates: &[Vector2<f64>],
    z: &State,
) -> State {
    let shape = element.shape(phi, z[0]);
    let u = element.rate_between(rates, z[0]);
    let (connection, power) = model.connection_and_power(&shape);
    let body = connection * u;
    let (sin, cos) = z[3].sin_cos();
    [
        1.0,
        cos * body.x - sin * body.y,
        sin * body.x + cos * body.y,
        body.z,
        u.dot(&(power * u)),
    ]
}

/// Least and largest power between the nodes, and how far the shapes there are beyond a wall.
fn between_nodes(
    model: &Model<f64>,
    walls: &[Wall],
    element: &Element,
    path: &Path,
    rates: &[Vector2<f64>],
) -> ([f64; 2], f64) {
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    let mut overstepped: f64 = 0.0;
    for sides in element.rule.points.windows(2) {
        for look in 0..LOOKS {
            let share = (look as f64 + 0.5) / LOOKS as f64;
            let t = element.start + element.length * (sides[0] + (sides[1] - sides[0]) * share);
            let u = element.rate_between(rates, t);
            let phi = element.shape(&path.phi, t);
            let power = u.dot(&(model.power_matrix(&phi) * u));
            range = [range[0].min(power), range[1].max(power)];
            for wall in walls {
                overstepped = overstepped.max(-wall.value(&phi));
            }
        }
    }
    (range, overstepped)
}
