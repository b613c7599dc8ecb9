//! Initial guess of the iteration: the first quarter of a given gait, sampled on the mesh.

use gait_optimizer::region::Bound;
use nalgebra::{Matrix2xX, Vector2};

use super::error::CollocationError;
use super::mesh::Mesh;
use super::path::levels;

/// Violation of the bounds, relative to the largest angle, above which the whole quarter is scaled down. A smaller violation is
/// corrected point by point.
const HAIR: f64 = 0.01;
const SHRINK: f64 = 0.99;
const SMALLEST: f64 = 1e-6;

/// Returns the shapes of a quarter at the mesh points, with the ends projected onto the symmetry lines and all points inside the
/// bounds by a margin.
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
    while room(&shapes) < -HAIR * shapes.amax() && shapes.amax() > SMALLEST {
        shapes *= SHRINK;
    }
    // Within narrow bounds even the straight swimmer has less margin than requested.
    let margin = margin.min(0.1 * shapes.amax());
    for mut phi in shapes.column_iter_mut() {
        for wall in walls {
            let level = wall.smooth_level(&phi.clone_owned());
            if level.value < margin {
                phi += level.gradient * ((margin - level.value) / level.gradient.norm_squared());
            }
        }
    }
    bind_ends(&mut shapes);
    if room(&shapes) > 0.0 {
        Ok(shapes)
    } else {
        refuse("it does not fit inside the bounds")
    }
}

/// Projects the first shape onto φ₁ = φ₂ and the last onto φ₁ = −φ₂.
pub(crate) fn bind_ends(shapes: &mut Matrix2xX<f64>) {
    let last = shapes.ncols() - 1;
    let (first, end) = (shapes.column(0).mean(), shapes.column(last));
    let half = 0.5 * (end.y - end.x);
    shapes.set_column(0, &Vector2::new(first, first));
    shapes.set_column(last, &Vector2::new(-half, half));
}
