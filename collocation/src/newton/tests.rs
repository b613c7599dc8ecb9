//! Checks of the first and second derivatives of the barrier function by finite differences.

use super::*;
use gait_optimizer::region::Region;
use nalgebra::Vector2;
use swimmer_files::Bounds;
use swimmer_model::{Circle, Gait, Model, Swimmer};

const SIZE: f64 = 1e-4;

/// Shapes that are not optimal.
fn somewhere(mesh: &Mesh, amplitude: f64) -> Matrix2xX<f64> {
    let circle = Circle { amplitude };
    let shapes: Vec<_> = mesh
        .times
        .iter()
        .map(|t| circle.at(0.25 * t).phi * (1.0 + 0.05 * (std::f64::consts::PI * t).sin()))
        .collect();
    Matrix2xX::from_columns(&shapes)
}

/// The step solves H Δ = −g: along Δ the gradient changes by −g. The gradient itself is checked by differences.
#[test]
fn gradient_and_hessian_are_exact() {
    let model = Model::new(&Swimmer::purcell()).unwrap();
    let mesh = Mesh::new(5, 4);
    let bounds = Bounds::within(1.7).apart(0.1);
    let walls: Vec<_> = Region::new(&bounds, &model.swimmer().links)
        .bounds()
        .collect();
    let barrier = 1e-2;
    let problem = CollocationProblem::new(&model, 1.0);
    let make = |phi| Newton::new(&problem, &mesh, &walls, phi, barrier);
    let gradient = |newton: &Newton<'_>| newton.gradient(&newton.path.slope(&mesh));
    let phi = somewhere(&mesh, 1.3);
    let newton = make(phi.clone());
    let (_, step, convex) = newton.step(1e-6);
    assert!(convex);
    // A change of the shapes that keeps both ends on their symmetry lines.
    for k in 0..6 {
        let mut wave = Matrix2xX::zeros(mesh.len());
        for (mut shape, t) in wave.column_iter_mut().zip(&mesh.times) {
            let angle = f64::from(k) * 2.1 * t + f64::from(k);
            shape.copy_from(&Vector2::new(angle.sin(), angle.cos()));
        }
        bind_ends(&mut wave);
        let here = gradient(&newton).dot(&wave);
        let merit = |size: f64| {
            let moved = make(&phi + &wave * size);
            moved.merit(&moved.path).unwrap()
        };
        let difference = (merit(SIZE) - merit(-SIZE)) / (2.0 * SIZE);
        assert!(
            (here - difference).abs() < 1e-5 * (1.0 + here.abs()),
            "{here} {difference}"
        );
        let along = |size: f64| gradient(&make(&phi + &step * size)).dot(&wave);
        let change = (along(SIZE) - along(-SIZE)) / (2.0 * SIZE);
        assert!(
            (change + here).abs() < 1e-5 * (1.0 + here.abs()),
            "{change} {here}"
        );
    }
}
