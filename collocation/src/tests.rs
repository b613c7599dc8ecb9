//! The solver as a whole: known gaits, the maximum principle, bounds, and what it must refuse.

use std::cell::Cell;

use nalgebra::Vector2;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use swimmer_model::{Links, Model, Swimmer, SymmetricFourier, TangentialDrag};

use super::*;

fn purcell() -> Model<f64> {
    Model::new(&Swimmer::purcell()).unwrap()
}

/// The robot preset; L is not 1, which ξ must not notice.
fn robot() -> Model<f64> {
    Model::new(&Swimmer::robot()).unwrap()
}

fn solved(model: &Model<f64>, sign: f64, amplitude: f64) -> CollocationSolution {
    let problem = CollocationProblem::new(model, sign);
    solve(&problem, &QuarterGuess::circle(amplitude).unwrap()).unwrap()
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
    let [phi1, phi2, _, theta, _] = small.nodes.last().unwrap().state;
    assert!((phi1.abs() - 0.840_201_02).abs() < 1e-7 && (phi1 + phi2).abs() < 1e-14);
    assert!((theta.abs() - 0.507_623_64).abs() < 1e-7);
    assert!((small.nodes[0].state[0] - 1.044_257_42).abs() < 1e-7);
    let large = solved(&purcell(), -1.0, 3.3);
    assert!(
        (large.efficiency - 0.018_102_560_473).abs() < 1e-11,
        "{}",
        large.efficiency
    );
    assert!((large.nodes[0].state[0] - 2.635_472_13).abs() < 1e-7);
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

/// The costates by covector mapping obey what the maximum principle says of them, though nothing enforced it between nodes.
#[test]
fn costates_obey_the_maximum_principle() {
    for (model, sign, amplitude) in [
        (purcell(), 1.0, 1.3),
        (purcell(), -1.0, 3.3),
        (robot(), 1.0, 1.3),
        (robot(), -1.0, 3.3),
    ] {
        let solution = solved(&model, sign, amplitude);
        let last = solution.nodes.last().unwrap();
        let first = &solution.nodes[0];
        let [l1, l2, l3, ..] = first.costate;
        let scale = l1.abs();
        assert!((l1 + l2).abs() < 1e-7 * scale, "{l1} {l2}");
        assert!((last.costate[0] - last.costate[1]).abs() < 1e-7 * scale);
        assert!((l3 - 2.0 * solution.final_x / solution.final_energy).abs() < 1e-12 * l3.abs());
        let merit = solution.final_x.powi(2) / solution.final_energy;
        let length = model.swimmer().total_length();
        for node in &solution.nodes {
            let [l1, l2, l3, l4, l5] = node.costate;
            assert!((l5 + l3 * l3 / 4.0).abs() < 1e-12 * l5.abs());
            // λ₄ = λ₃ (y − y_f), with y from another integrator.
            assert!((l4 - l3 * (node.y - last.y)).abs() < 1e-8 * (l3 * length).abs());
            // H ≡ x_f²/(E_f t_f).
            let phi = Vector2::new(node.state[0], node.state[1]);
            let u = Vector2::from(node.control);
            let velocity = model.full_connection(&phi, node.state[3]) * u;
            let power = u.dot(&(model.power_matrix(&phi) * u));
            let h = l1 * u.x + l2 * u.y + l3 * velocity.x + l4 * velocity.z + l5 * power;
            assert!(
                (h / merit - 1.0).abs() < 1e-7,
                "t = {}: {}",
                node.t,
                h / merit
            );
        }
    }
}

/// λ̇ = −∂H/∂φ: the slopes of the costates' own polynomials satisfy the adjoint equation, which was never written down.
#[test]
fn costates_obey_the_adjoint_equation() {
    let model = purcell();
    let solution = solved(&model, -1.0, 3.3);
    let rate = |node: &CollocationNode, i: usize| {
        let [.., l3, l4, l5] = node.costate;
        let phi = Vector2::new(node.state[0], node.state[1]);
        let u = Vector2::from(node.control);
        let first = model.first_derivatives(&phi);
        let slope = first.at_heading(node.state[3]).d_phi[i] * u;
        -(l3 * slope.x + l4 * slope.z + l5 * u.dot(&(first.d_power[i] * u)))
    };
    for i in 0..2 {
        let mesh = &solution.mesh;
        let degree = mesh.rule.degree();
        for (k, first) in mesh.firsts().enumerate().skip(1) {
            let nodes = &solution.nodes[first..=first + degree];
            for j in 1..=degree {
                let slope: f64 = mesh
                    .rule
                    .slopes
                    .column(j - 1)
                    .iter()
                    .zip(nodes)
                    .map(|(share, node)| share * node.costate[i] * mesh.elements as f64)
                    .sum();
                let exact = rate(&nodes[j], i);
                assert!(
                    (slope - exact).abs() < 1e-5 * solution.nodes[0].costate[0].abs(),
                    "element {k}, t = {}: {slope} {exact}",
                    nodes[j].t
                );
            }
        }
    }
}

#[test]
fn a_bound_that_does_not_bind_changes_nothing() {
    let model = purcell();
    let free = solved(&model, 1.0, 1.3);
    let problem = CollocationProblem::new(&model, 1.0).with_max_angle(2.4);
    let bounded = solve(&problem, &QuarterGuess::circle(1.3).unwrap()).unwrap();
    assert!((bounded.efficiency - free.efficiency).abs() < 1e-12);
    assert!(bounded.bound_arcs.is_empty());
}

/// Two resolutions of a binding bound agree; its multiplier is that of the gain in ξ per radian of `φ_max`.
#[test]
fn the_multiplier_is_the_price_of_the_bound() {
    let model = purcell();
    let at = |max: f64| {
        let problem = CollocationProblem::new(&model, 1.0).with_max_angle(max);
        solve(&problem, &QuarterGuess::circle(1.3).unwrap()).unwrap()
    };
    let here = at(1.2);
    assert_eq!(here.bound_arcs.len(), 1, "{:?}", here.bound_arcs);
    assert!(here.bound_arcs[0].normal[1] > 0.999);
    let step = 1e-3;
    let slope = (at(1.2 + step).efficiency - at(1.2 - step).efficiency) / (2.0 * step);
    let mut price = 0.0;
    for (node, weight) in here.nodes.iter().zip(&here.mesh.weights).skip(1) {
        price += weight * node.bound_force[1];
    }
    let price = price * model.side_drag() * model.swimmer().total_length();
    assert!((price / slope - 1.0).abs() < 1e-4, "{price} {slope}");
}

/// ξ under tightening bounds, each solved from the last, against the same problem on meshes of another degree.
#[test]
fn bounded_gaits_do_not_depend_on_the_mesh() {
    for model in [purcell(), robot()] {
        let mut guess = QuarterGuess::circle(1.3).unwrap();
        let mut before = f64::INFINITY;
        for max in [2.8, 2.4, 2.0, 1.6, 1.2] {
            let problem = CollocationProblem::new(&model, 1.0).with_max_angle(max);
            let refined = solve(&problem, &guess).unwrap();
            guess = refined.guess();
            let mut even = problem;
            (even.elements, even.degree) = (150, 3);
            let even = solve(&even, &guess).unwrap();
            let off = even.efficiency / refined.efficiency - 1.0;
            assert!(off.abs() < 1e-6, "φ_max = {max}: {off:.1e}");
            assert!((refined.turning_number - 1.0).abs() < 1e-9);
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
    assert!(
        free.nodes
            .iter()
            .any(|node| { links.overlap(&Vector2::new(node.state[0], node.state[1])) > 0.0 })
    );
    let mut before = free.efficiency;
    for clearance in [0.0, 0.06, 0.3] {
        let mut problem = CollocationProblem::new(&model, -1.0);
        problem.bounds.no_overlap = true;
        problem.bounds.clearance = clearance;
        let apart = solve(&problem, &QuarterGuess::circle(3.3).unwrap()).unwrap();
        assert!(
            apart.efficiency < before,
            "{clearance}: {}",
            apart.efficiency
        );
        before = apart.efficiency;
        assert_eq!(apart.bound_arcs[0].kind, swimmer_files::ArcKind::Clearance);
        for step in 0..=1000 {
            let phi = apart.phi(f64::from(step) / 1000.0);
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
        if let Ok(solution) = solve(&problem, &QuarterGuess::circle(3.3).unwrap()) {
            assert!((solution.efficiency_again / solution.efficiency - 1.0).abs() < 0.02);
            solved += 1;
        }
    }
    assert!(solved > 0, "nothing was solved");
}

#[test]
fn what_is_wrong_is_said() {
    let model = purcell();
    let circle = QuarterGuess::circle(1.3).unwrap();
    let wrong_way = solve(&CollocationProblem::new(&model, -1.0), &circle);
    assert!(matches!(wrong_way, Err(CollocationError::WrongWay { .. })));
    let bound = CollocationProblem::new(&model, 1.0).with_max_angle(-1.0);
    let refused = solve(&bound, &circle).unwrap_err().to_string();
    assert!(refused.contains("max_angle = -1 rad"), "{refused}");
    assert!(matches!(
        QuarterGuess::from_samples(&[(0.0, [1.0, 1.0]); 5]),
        Err(CollocationError::Guess { .. })
    ));
    let mut coarse = CollocationProblem::new(&model, 1.0);
    (coarse.elements, coarse.degree) = (2, 2);
    if let Ok(solution) = solve(&coarse, &circle) {
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
        if let Ok(guess) = QuarterGuess::from_gait(&gait)
            && let Ok(solution) = solve(&problem, &guess)
        {
            solved.set(solved.get() + 1);
            prop_assert!((solution.efficiency_again / solution.efficiency - 1.0).abs() < 1e-4);
            prop_assert!(solution.final_x * problem.sign > 0.0);
            if let Some(max) = problem.bounds.max_angle {
                for node in &solution.nodes {
                    prop_assert!(node.state[0].abs() <= max && node.state[1].abs() <= max);
                }
            }
        }
        Ok(())
    });
    ran.unwrap();
    println!("{} of 64 solved", solved.get());
    assert!(solved.get() >= 5, "only {} of 64 solved", solved.get());
}
