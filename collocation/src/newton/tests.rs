//! First and second derivatives of the whole barrier function, by differences.

use super::*;
use swimmer_files::Bounds;
use swimmer_model::{Circle, Gait, Swimmer};

const SIZE: f64 = 1e-4;

fn gradient_along(newton: &mut Newton<'_>, barrier: f64, change: &[Vector2<f64>]) -> f64 {
    newton.assemble(barrier);
    newton.slope(change)
}

/// A gait that is no optimum, on a mesh of mixed degrees.
fn somewhere(mesh: &Mesh, amplitude: f64) -> Vec<Vector2<f64>> {
    let circle = Circle { amplitude };
    mesh.times
        .iter()
        .map(|t| circle.at(0.25 * t).phi * (1.0 + 0.05 * (std::f64::consts::PI * t).sin()))
        .collect()
}

/// The step solves H Δ = −g: the gradient, itself checked by differences, changes along Δ by −g.
#[test]
fn gradient_and_hessian_are_exact() {
    let model = Model::new(&Swimmer::purcell()).unwrap();
    let mesh = Mesh::new(&[0.0, 0.3, 0.4, 0.75, 1.0], &[4, 2, 7, 3]);
    let bounds = Bounds {
        max_angle: Some(1.7),
        no_overlap: true,
        clearance: 0.1,
        ..Bounds::default()
    };
    let walls = Wall::all(&bounds, &model.swimmer().links);
    let barrier = 1e-2;
    let make = |phi| {
        let mut newton = Newton::new(&model, &mesh, &walls, 1.0, 10.0, phi);
        newton.reset_multipliers(barrier);
        newton
    };
    let phi = somewhere(&mesh, 1.3);
    let mut newton = make(phi.clone());
    let mut shift = 0.0;
    let step = newton.step(barrier, &mut shift).unwrap();
    assert!(step.convex, "shift {shift}");
    // Any change of the shapes that keeps both ends on their lines.
    let waves: Vec<Vec<Vector2<f64>>> = (0..6)
        .map(|k| {
            let mut wave: Vec<_> = mesh
                .times
                .iter()
                .map(|t| {
                    let angle = f64::from(k) * 2.1 * t + f64::from(k);
                    Vector2::new(angle.sin(), angle.cos())
                })
                .collect();
            wave[0].fill(0.7);
            *wave.last_mut().unwrap() = Vector2::new(-0.4, 0.4);
            wave
        })
        .collect();
    let moved = |by: &[Vector2<f64>], size: f64| -> Vec<Vector2<f64>> {
        phi.iter().zip(by).map(|(p, b)| p + b * size).collect()
    };
    for wave in &waves {
        let here = gradient_along(&mut newton, barrier, wave);
        let merit = |size: f64| {
            let moved = make(moved(wave, size));
            moved.merit(&moved.path, barrier).unwrap()
        };
        let difference = (merit(SIZE) - merit(-SIZE)) / (2.0 * SIZE);
        assert!(
            (here - difference).abs() < 1e-5 * (1.0 + here.abs()),
            "{here} {difference}"
        );
        // On the central path the primal–dual matrix is the barrier function's Hessian.
        let along = |size: f64| gradient_along(&mut make(moved(&step.shapes, size)), barrier, wave);
        let change = (along(SIZE) - along(-SIZE)) / (2.0 * SIZE);
        assert!(
            (change + here).abs() < 1e-5 * (1.0 + here.abs()),
            "{change} {here}"
        );
    }
}
