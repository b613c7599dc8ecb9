//! The solver as a whole: known gaits, the maximum principle, bounds, and what it must refuse.

use std::cell::Cell;

use nalgebra::Vector2;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use swimmer_files::AnyGait;
use swimmer_model::{
    Circle, Links, Model, Swimmer, SymmetricFourier, TangentialDrag, Tolerance, swim,
};

use super::*;

fn purcell() -> Model<f64> {
    Model::new(&Swimmer::purcell()).unwrap()
}

/// The robot preset; L is not 1, which ξ must not notice.
fn robot() -> Model<f64> {
    Model::new(&Swimmer::robot()).unwrap()
}

fn circle(amplitude: f64) -> Circle<f64> {
    Circle { amplitude }
}

fn solved(model: &Model<f64>, sign: f64, amplitude: f64) -> CollocationSolution {
    let problem = CollocationProblem::new(model, sign);
    solve(&problem, &circle(amplitude)).unwrap()
}

/// Shapes of the quarter, evenly in time.
fn shapes(solution: &CollocationSolution) -> Vec<Vector2<f64>> {
    let times = (0..=1000).map(|step| f64::from(step) / 1000.0);
    times.map(|t| solution.phi(t)).collect()
}

/// How often the direction turns round in a cycle, which crosses the symmetry lines square: 1 for a simple counter-clockwise curve.
fn turns(solution: &CollocationSolution) -> f64 {
    let shapes = shapes(solution);
    let mut sides: Vec<Vector2<f64>> = shapes.array_windows().map(|[a, b]| b - a).collect();
    sides.insert(0, Vector2::new(-1.0, 1.0));
    sides.push(Vector2::new(-1.0, -1.0));
    let pairs = sides.array_windows();
    let turned = pairs.map(|[a, b]| a.perp(b).atan2(a.dot(b)));
    4.0 * turned.sum::<f64>() / std::f64::consts::TAU
}

/// The numbers of both optima of Purcell's swimmer, from circles.
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

/// Section V of the paper: the large gait beats the small one by 45 %.
#[test]
fn robot_both_gaits_from_circles() {
    let small = solved(&robot(), 1.0, 1.3);
    let large = solved(&robot(), -1.0, 3.3);
    let ratio = large.efficiency / small.efficiency;
    assert!((ratio - 1.453).abs() < 1e-3, "{ratio}");
}

#[test]
fn a_bound_that_does_not_bind_changes_nothing() {
    let model = purcell();
    let free = solved(&model, 1.0, 1.3);
    let problem = CollocationProblem::new(&model, 1.0).with_max_angle(2.4);
    let bounded = solve(&problem, &circle(1.3)).unwrap();
    assert!((bounded.efficiency - free.efficiency).abs() < 1e-12);
}

/// ξ under tightening bounds, each solved from the last, against the same problem on meshes of another degree.
#[test]
fn bounded_gaits_do_not_depend_on_the_mesh() {
    for model in [purcell(), robot()] {
        let mut guess = AnyGait::circle(1.3);
        let mut before = f64::INFINITY;
        for max in [2.8, 2.4, 2.0, 1.6, 1.2] {
            let problem = CollocationProblem::new(&model, 1.0).with_max_angle(max);
            let refined = solve(&problem, &guess).unwrap();
            guess = refined.gait().unwrap();
            let mut even = problem;
            (even.elements, even.degree) = (150, 3);
            let even = solve(&even, &guess).unwrap();
            let off = even.efficiency / refined.efficiency - 1.0;
            assert!(off.abs() < 1e-6, "φ_max = {max}: {off:.1e}");
            assert!((turns(&refined) - 1.0).abs() < 1e-9);
            assert!(refined.overstepped < 1e-5);
            assert!(refined.efficiency <= before * (1.0 + 1e-9));
            before = refined.efficiency;
        }
    }
}

/// The large gait crosses its links. Kept from it, it gives up efficiency, touches, and stays out of the forbidden zone.
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

/// From a circle far off, in a box much too tight for it: whatever comes out must be a gait.
#[test]
fn spurious_optima_are_not_returned() {
    let model = robot();
    let mut solved = 0;
    for max in [2.4, 2.6, 2.8, 3.0] {
        let mut problem = CollocationProblem::new(&model, -1.0).with_max_angle(max);
        problem.elements = 20;
        if let Ok(solution) = solve(&problem, &circle(3.3)) {
            assert!((solution.efficiency_again / solution.efficiency - 1.0).abs() < 0.02);
            solved += 1;
        }
    }
    assert!(solved > 0, "nothing was solved");
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
    let mut coarse = CollocationProblem::new(&model, 1.0);
    (coarse.elements, coarse.degree) = (2, 2);
    if let Ok(solution) = solve(&coarse, &start) {
        assert!((solution.efficiency_again / solution.efficiency - 1.0).abs() < 0.02);
    }
}

/// Any swimmer, any quarter curve, any bound: an answer that its own re-integration confirms, or a reason.
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
