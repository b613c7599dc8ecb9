//! Tests of the whole solver: known gaits, Pontryagin's principle, bounds, and refused inputs.

use std::cell::Cell;

use gait_optimizer::region::Region;
use nalgebra::Vector2;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use swimmer_model::{
    Circle, Links, Model, Swimmer, SymmetricFourier, TangentialDrag, Tolerance, swim,
};

use super::*;

fn purcell() -> Model<f64> {
    Model::new(&Swimmer::purcell()).unwrap()
}

fn circle(amplitude: f64) -> Circle<f64> {
    Circle { amplitude }
}

fn solved(model: &Model<f64>, sign: f64, amplitude: f64) -> CollocationSolution {
    let problem = CollocationProblem::new(model, sign);
    solve(&problem, &circle(amplitude)).unwrap()
}

/// Shapes of the quarter at uniform times.
fn shapes(solution: &CollocationSolution) -> Vec<Vector2<f64>> {
    let times = (0..=1000).map(|step| f64::from(step) / 1000.0);
    times.map(|t| solution.phi(t)).collect()
}

/// Reproduces both efficiency optima of Purcell's swimmer from circles.
#[test]
fn purcell_both_gaits_from_circles() {
    let small = solved(&purcell(), 1.0, 1.3);
    assert!(
        (small.efficiency - 0.012_364_154_624).abs() < 1e-12,
        "{}",
        small.efficiency
    );
    let end = small.phi(1.0);
    assert!((end.x.abs() - 0.840_201_02).abs() < 1e-7 && end.sum().abs() < 1e-14);
    assert!((small.phi(0.0).x - 1.044_257_42).abs() < 1e-7);
    let large = solved(&purcell(), -1.0, 3.3);
    assert!(
        (large.efficiency - 0.018_102_560_473).abs() < 1e-11,
        "{}",
        large.efficiency
    );
    assert!((large.phi(0.0).x - 2.635_472_13).abs() < 1e-7);
    assert!((large.efficiency / small.efficiency - 1.4641).abs() < 1e-4);
}

#[test]
fn a_bound_that_does_not_bind_changes_nothing() {
    let model = purcell();
    let free = solved(&model, 1.0, 1.3);
    let problem = CollocationProblem::new(&model, 1.0).with_max_angle(2.4);
    let bounded = solve(&problem, &circle(1.3)).unwrap();
    assert!((bounded.efficiency - free.efficiency).abs() < 1e-12);
}

/// The links of the large gait cross. With the crossing forbidden, its efficiency falls, and it touches the bound of the links.
#[test]
fn links_are_kept_apart() {
    let model = purcell();
    let free = solved(&model, -1.0, 3.3);
    let links = model.swimmer().links;
    assert!(shapes(&free).iter().any(|phi| links.overlap(phi) > 0.0));
    let mut before = free.efficiency;
    for clearance in [0.0, 0.06, 0.3] {
        let mut problem = CollocationProblem::new(&model, -1.0);
        problem.bounds.no_overlap = true;
        problem.bounds.clearance = clearance;
        let apart = solve(&problem, &circle(3.3)).unwrap();
        assert!(
            apart.efficiency < before,
            "{clearance}: {}",
            apart.efficiency
        );
        before = apart.efficiency;
        let region = Region::new(&problem.bounds, &links);
        let nearest = |phi: &Vector2<f64>| {
            let margins = region.bounds().map(|bound| bound.smooth_level(phi).value);
            margins.fold(f64::INFINITY, f64::min)
        };
        let margins = shapes(&apart)
            .iter()
            .map(nearest)
            .fold(f64::INFINITY, f64::min);
        assert!(margins < 1e-4, "{clearance}: {margins}");
        for phi in shapes(&apart) {
            assert!(links.overlap(&phi) < 1e-4, "{clearance}: {phi:?}");
        }
    }
}

#[test]
fn what_is_wrong_is_said() {
    let model = purcell();
    let start = circle(1.3);
    let wrong_way = solve(&CollocationProblem::new(&model, -1.0), &start);
    assert!(matches!(wrong_way, Err(CollocationError::WrongWay { .. })));
    let bound = CollocationProblem::new(&model, 1.0).with_max_angle(-1.0);
    let refused = solve(&bound, &start).unwrap_err().to_string();
    assert!(refused.contains("max_angle = -1 rad"), "{refused}");
    let still = solve(&CollocationProblem::new(&model, 1.0), &circle(0.0));
    assert!(matches!(still, Err(CollocationError::Guess { .. })));
}

/// Any swimmer, curve and bound give either a solution that re-integration confirms, or an error.
#[test]
fn never_a_wrong_gait() {
    let swimmers = (0.3..3.0_f64, 1.05..6.0_f64, 0.0..1.2_f64);
    let coefficients = prop::array::uniform3(prop::array::uniform2(-2.0..4.0_f64));
    let bounds = (prop::option::of(0.3..4.0_f64), any::<bool>());
    let meshes = (any::<bool>(), 1..24_usize, 2..9_usize);
    let mut runner = TestRunner::new(ProptestConfig::with_cases(64));
    let solved = Cell::new(0);
    let problems = (swimmers, coefficients, bounds, meshes);
    let ran = runner.run(&problems, |(swimmer, coefficients, bounds, mesh)| {
        let (ratio, chi, sphere) = swimmer;
        let swimmer = Swimmer {
            links: Links {
                middle: 1.0,
                front: ratio,
                back: ratio,
            },
            chi,
            tangential_drag: TangentialDrag::OverViscosity(1.0),
            sphere_radius: sphere,
            ..Swimmer::purcell()
        };
        let model = Model::new(&swimmer).unwrap();
        let (forwards, elements, degree) = mesh;
        let mut problem = CollocationProblem::new(&model, if forwards { 1.0 } else { -1.0 });
        (problem.bounds.max_angle, problem.bounds.no_overlap) = bounds;
        (problem.elements, problem.degree) = (elements, degree);
        let [a, b, c] = coefficients;
        let series = [a, b.map(|v| 0.2 * v), c.map(|v| 0.05 * v)];
        let gait = SymmetricFourier {
            coefficients: &series,
        };
        if let Ok(solution) = solve(&problem, &gait) {
            solved.set(solved.get() + 1);
            prop_assert!((solution.efficiency_again / solution.efficiency - 1.0).abs() < 1e-4);
            let stroke = swim(&model, &solution.gait().unwrap(), &Tolerance::default());
            prop_assert!(stroke.displacement.x * problem.sign > 0.0);
            let max = problem.bounds.max_angle.unwrap_or(f64::INFINITY);
            prop_assert!(solution.phi.amax() <= max);
        }
        Ok(())
    });
    ran.unwrap();
    println!("{} of 64 solved", solved.get());
    assert!(solved.get() >= 5, "only {} of 64 solved", solved.get());
}
