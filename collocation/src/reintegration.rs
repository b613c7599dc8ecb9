//! The state equations integrated again along the same polynomials, by a rule of the highest degree.
//!
//! φ̇ = u holds for polynomials whatever the mesh. What a coarse mesh gets wrong are θ, x and E, and a spurious optimum of
//! the discretisation lives on just that.

use gait_optimizer::region::Bound;
use nalgebra::Matrix2xX;
use swimmer_model::Model;

use super::mesh::Mesh;
use super::path::Path;
use super::radau::HIGHEST_DEGREE;

/// The quarter swum again.
#[derive(Debug, Clone)]
pub(crate) struct Reintegration {
    pub(crate) final_x: f64,
    pub(crate) final_energy: f64,
    /// How far it is beyond a bound between the nodes, where nothing keeps it, in rad or over L.
    pub(crate) overstepped: f64,
}

impl Reintegration {
    pub(crate) fn new(model: &Model<f64>, mesh: &Mesh, walls: &[Bound], path: &Path) -> Self {
        let fine = Mesh::new(mesh.elements, HIGHEST_DEGREE);
        let mut phi = Matrix2xX::zeros(fine.len());
        for (mut column, &t) in phi.column_iter_mut().zip(&fine.times) {
            column.copy_from(&mesh.shape(&path.phi, t));
        }
        let swum = Path::new(model, &fine, phi);
        let beyond = |wall: &Bound| {
            let shapes = swum.phi.column_iter();
            shapes.fold(0.0, |most: f64, phi| {
                most.max(-wall.smooth_level(&phi.into_owned()).value)
            })
        };
        Self {
            final_x: swum.final_x,
            final_energy: swum.final_energy,
            overstepped: walls.iter().map(beyond).fold(0.0, f64::max),
        }
    }
}
