//! Where the iteration starts: the first quarter of any gait, at constant power.

use gait_optimizer::region::Bound;
use nalgebra::{Matrix2xX, Vector2};
use swimmer_model::{Gait, Model};

use super::CollocationError;
use super::mesh::Mesh;

/// Samples of the quarter.
const SAMPLES: usize = 512;
/// Share of the room inside the bounds that a guess is shrunk to.
const INSIDE: f64 = 0.98;

/// The shapes of a gait's first quarter at the points of a mesh, its ends moved on to the symmetry lines, timed at constant power
/// and brought inside the bounds.
pub(crate) fn on_mesh<G: Gait<f64> + ?Sized>(
    gait: &G,
    model: &Model<f64>,
    mesh: &Mesh,
    walls: &[Bound],
) -> Result<Matrix2xX<f64>, CollocationError> {
    let refuse = |problem| Err(CollocationError::Guess { problem });
    let place = |i: usize| 0.25 * i as f64 / SAMPLES as f64;
    let samples: Vec<_> = (0..=SAMPLES).map(|i| gait.at(place(i)).phi).collect();
    let mut shapes = Matrix2xX::from_columns(&samples);
    if !shapes.iter().all(|angle| angle.abs() < 1e3) {
        return refuse("a shape is not finite, or an angle beyond 1000 rad");
    }
    bind_ends(&mut shapes);
    if !is_inside(walls, &(&shapes / INSIDE)) {
        shapes = shrunk(&shapes, walls);
    }
    let mut times = vec![0.0];
    let mut total = 0.0;
    for i in 1..shapes.ncols() {
        let step = shapes.column(i) - shapes.column(i - 1);
        let power = model.power_matrix(&((shapes.column(i) + shapes.column(i - 1)) * 0.5));
        total += step.dot(&(power * step)).max(0.0).sqrt();
        times.push(total);
    }
    if !(total > 0.0 && total.is_finite()) {
        return refuse("it spends no power");
    }
    let last = times.len() - 1;
    let mut on_mesh = Matrix2xX::zeros(mesh.len());
    for (mut phi, t) in on_mesh.column_iter_mut().zip(&mesh.times) {
        let after = times
            .partition_point(|time| *time <= t * total)
            .clamp(1, last);
        let share = (t * total - times[after - 1])
            / (times[after] - times[after - 1]).max(f64::MIN_POSITIVE);
        phi.copy_from(
            &shapes
                .column(after - 1)
                .lerp(&shapes.column(after), share.clamp(0.0, 1.0)),
        );
    }
    if is_inside(walls, &on_mesh) {
        Ok(on_mesh)
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
    shapes.column_iter().all(|phi| {
        walls
            .iter()
            .all(|wall| wall.smooth_level(&phi.into_owned()).value > 0.0)
    })
}

/// Moves the first shape to φ₁ = φ₂ and the last to φ₁ = −φ₂.
pub(crate) fn bind_ends(shapes: &mut Matrix2xX<f64>) {
    let last = shapes.ncols() - 1;
    let (first, end) = (shapes.column(0).mean(), shapes.column(last));
    let half = 0.5 * (end.y - end.x);
    shapes.set_column(0, &Vector2::new(first, first));
    shapes.set_column(last, &Vector2::new(-half, half));
}
