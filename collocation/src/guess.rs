//! Where the iteration starts: the first quarter of any gait.

use gait_optimizer::region::Bound;
use nalgebra::{Matrix2xX, Vector2};

use super::mesh::Mesh;
use super::{CollocationError, levels};

/// A quarter that leaves the bounds by more than this \[rad, or over L\] is shrunk; by less, its shapes there are drawn inside.
const HAIR: f64 = 0.02;
const SHRINK: f64 = 0.99;

/// The shapes of a quarter at the points of a mesh, its ends moved on to the symmetry lines, and brought inside the bounds by a
/// margin.
pub(crate) fn on_mesh(
    shape: &dyn Fn(f64) -> Vector2<f64>,
    mesh: &Mesh,
    walls: &[Bound],
    margin: f64,
) -> Result<Matrix2xX<f64>, CollocationError> {
    let refuse = |problem| Err(CollocationError::Guess { problem });
    let samples: Vec<_> = mesh.times.iter().map(|t| shape(*t)).collect();
    let mut shapes = Matrix2xX::from_columns(&samples);
    if !shapes.iter().all(|angle| angle.abs() < 1e3) {
        return refuse("a shape is not finite, or an angle beyond 1000 rad");
    }
    if samples.iter().all(|phi| *phi == samples[0]) {
        return refuse("it spends no power");
    }
    let room = |shapes: &_| {
        let margins = levels(walls, shapes).map(|(_, level)| level.value);
        margins.fold(margin, f64::min)
    };
    while room(&shapes) < -HAIR && shapes.amax() > HAIR {
        shapes *= SHRINK;
    }
    for mut phi in shapes.column_iter_mut() {
        for wall in walls {
            let level = wall.smooth_level(&phi.clone_owned());
            let missing = (margin - level.value).max(0.0);
            phi += level.gradient * (missing / level.gradient.norm_squared());
        }
    }
    bind_ends(&mut shapes);
    if room(&shapes) > 0.0 {
        Ok(shapes)
    } else {
        refuse("it does not fit inside the bounds")
    }
}

/// Moves the first shape to φ₁ = φ₂ and the last to φ₁ = −φ₂.
pub(crate) fn bind_ends(shapes: &mut Matrix2xX<f64>) {
    let last = shapes.ncols() - 1;
    let (first, end) = (shapes.column(0).mean(), shapes.column(last));
    let half = 0.5 * (end.y - end.x);
    shapes.set_column(0, &Vector2::new(first, first));
    shapes.set_column(last, &Vector2::new(-half, half));
}
