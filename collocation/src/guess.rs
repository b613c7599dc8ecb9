//! Where the iteration starts: the first quarter of any gait.

use gait_optimizer::region::Bound;
use nalgebra::{Matrix2xX, Vector2};
use swimmer_model::Gait;

use super::mesh::Mesh;
use super::{CollocationError, levels};

/// Share of the room inside the bounds that a guess is shrunk to.
const INSIDE: f64 = 0.98;

/// The shapes of a gait's first quarter at the points of a mesh, its ends moved on to the symmetry lines, and brought
/// inside the bounds.
pub(crate) fn on_mesh<G: Gait<f64> + ?Sized>(
    gait: &G,
    mesh: &Mesh,
    walls: &[Bound],
) -> Result<Matrix2xX<f64>, CollocationError> {
    let refuse = |problem| Err(CollocationError::Guess { problem });
    let samples: Vec<_> = mesh.times.iter().map(|t| gait.at(0.25 * t).phi).collect();
    let mut shapes = Matrix2xX::from_columns(&samples);
    if !shapes.iter().all(|angle| angle.abs() < 1e3) {
        return refuse("a shape is not finite, or an angle beyond 1000 rad");
    }
    if samples.iter().all(|phi| *phi == samples[0]) {
        return refuse("it spends no power");
    }
    bind_ends(&mut shapes);
    if !is_inside(walls, &(&shapes / INSIDE)) {
        shapes = shrunk(&shapes, walls);
    }
    if is_inside(walls, &shapes) {
        Ok(shapes)
    } else {
        refuse("it does not fit inside the bounds")
    }
}

/// Brought inside the bounds as a whole.
fn shrunk(shapes: &Matrix2xX<f64>, walls: &[Bound]) -> Matrix2xX<f64> {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if is_inside(walls, &(shapes * middle)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    shapes * (INSIDE * low)
}

fn is_inside(walls: &[Bound], shapes: &Matrix2xX<f64>) -> bool {
    levels(walls, shapes).all(|(_, level)| level.value > 0.0)
}

/// Moves the first shape to φ₁ = φ₂ and the last to φ₁ = −φ₂.
pub(crate) fn bind_ends(shapes: &mut Matrix2xX<f64>) {
    let last = shapes.ncols() - 1;
    let (first, end) = (shapes.column(0).mean(), shapes.column(last));
    let half = 0.5 * (end.y - end.x);
    shapes.set_column(0, &Vector2::new(first, first));
    shapes.set_column(last, &Vector2::new(-half, half));
}
