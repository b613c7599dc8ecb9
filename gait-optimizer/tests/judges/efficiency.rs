//! Efficiency gaits against the known numbers, each by two methods.

use crate::paper_shooting;

use gait_optimizer::{
    Branch, EfficiencyError, EfficiencyFigures, EfficiencyProblem, InvalidProblem, Method,
    OptimalGait, efficiency,
};
use nalgebra::Vector4;
use swimmer_files::{AnyGait, ArcKind, GaitFile};
use swimmer_model::{Model, Swimmer, Tolerance, swim, trajectory};

fn optimum(swimmer: Swimmer<f64>, branch: Branch) -> OptimalGait {
    efficiency(&EfficiencyProblem::new(swimmer, branch)).unwrap()
}

fn figures(gait: &OptimalGait) -> EfficiencyFigures {
    gait.efficiency_figures.unwrap()
}

#[test]
fn purcells_gaits_are_the_known_ones() {
    let small = optimum(Swimmer::purcell(), Branch::Small);
    assert!((small.efficiency - 0.012_364_154_624).abs() < 1e-12);
    assert!((small.start_angle - 1.044_257_42).abs() < 1e-8);
    assert!((small.end_angle - 0.840_201_02).abs() < 1e-8);
    let large = optimum(Swimmer::purcell(), Branch::Large);
    assert!((large.efficiency / 0.018_102_560_473 - 1.0).abs() < 1e-9);
    assert!((large.start_angle - 2.635_472_13).abs() < 1e-8);
    assert!((large.efficiency / small.efficiency - 1.4641).abs() < 1e-4);
    assert!(small.displacement_over_length > 0.0 && large.displacement_over_length < 0.0);
}

/// The paper's backward shooting stays where the gaits are, and Jacobi's test proves them maxima among symmetric gaits.
#[test]
fn the_papers_own_method_agrees() {
    for swimmer in [Swimmer::purcell(), Swimmer::robot()] {
        let model = Model::new(&swimmer.of_unit_length()).unwrap();
        for branch in [Branch::Small, Branch::Large] {
            let gait = optimum(swimmer, branch);
            let mut theta = f64::NAN;
            let samples = gait.gait().unwrap();
            trajectory(&model, &samples, &Tolerance::new(1e-12), 4, |point| {
                if point.u < 0.3 {
                    theta = point.pose.theta;
                }
            });
            let x = 0.25 * gait.displacement_over_length;
            let energy = x * x / gait.efficiency;
            let start = Vector4::new(-gait.end_angle, x, theta, energy);
            let shot = paper_shooting::shoot(&model, start).unwrap();
            assert!(shot.residual < 1e-10, "{branch}: {shot:?}");
            assert!((shot.at_end - start).amax() < 1e-7, "{branch}: {shot:?}");
            let efficiency = shot.at_end[1] * shot.at_end[1] / shot.at_end[3];
            assert!((efficiency / gait.efficiency - 1.0).abs() < 1e-8);
            assert!(shot.least_determinant > 0.5, "{branch}: {shot:?}");
            assert!(shot.bend < -1.0, "{branch}: {shot:?}");
        }
    }
}

/// Fourier series of an order where they have converged, before and after the polish, against multiple shooting from order 4.
#[test]
fn both_methods_find_the_same_gaits() {
    for swimmer in [
        Swimmer::purcell(),
        Swimmer::robot(),
        Swimmer::robot_slender(),
    ] {
        for branch in [Branch::Small, Branch::Large] {
            let by = |method| {
                efficiency(&EfficiencyProblem {
                    method,
                    ..EfficiencyProblem::new(swimmer, branch)
                })
                .unwrap()
            };
            let shot = by(Method::Shooting);
            let fourier = by(Method::Fourier);
            assert!((fourier.efficiency / shot.efficiency - 1.0).abs() < 1e-10);
            assert!((fourier.start_angle - shot.start_angle).abs() < 1e-8);
            // The direct method's own value: it knows nothing of the shooting.
            let direct = figures(&fourier).direct_efficiency.unwrap();
            assert!(
                (direct / shot.efficiency - 1.0).abs() < 1e-6,
                "{branch}: {direct} {}",
                shot.efficiency
            );
            for gait in [&fourier, &shot] {
                assert!(gait.certificate.pass(), "{:?}", gait.certificate.failures());
                let EfficiencyFigures {
                    residual,
                    power_variation,
                    ..
                } = figures(gait);
                assert!(residual <= 1e-10, "{branch}: {residual}");
                assert!(power_variation < 1e-8, "{branch}: {power_variation}");
            }
        }
    }
}

#[test]
fn the_gait_file_swims_the_same() {
    let gait = optimum(Swimmer::robot(), Branch::Large);
    let text = gait.gait_file("robot").to_text();
    let file = GaitFile::parse(&text, std::path::Path::new("large.gait")).unwrap();
    assert_eq!(file.arcs.len(), 1);
    assert_eq!(file.arcs[0].kind, ArcKind::Regular);
    assert!(file.corners.is_empty());
    let model = Model::new(&Swimmer::robot()).unwrap();
    let read = AnyGait::from_file(&file).unwrap();
    let stroke = swim(&model, &read, &Tolerance::new(1e-12));
    assert!((stroke.efficiency_constant_power() / gait.efficiency - 1.0).abs() < 1e-9);
    // Run as sampled, the power is constant.
    assert!((stroke.efficiency() / gait.efficiency - 1.0).abs() < 1e-9);
    assert!(
        (stroke.displacement_over_length().x / gait.displacement_over_length - 1.0).abs() < 1e-8
    );
}

#[test]
fn a_bound_that_does_not_bind_changes_nothing() {
    let free = optimum(Swimmer::purcell(), Branch::Small);
    let mut problem = EfficiencyProblem::new(Swimmer::purcell(), Branch::Small);
    problem.bounds.max_angle = Some(2.8);
    problem.bounds.no_overlap = true;
    let bounded = efficiency(&problem).unwrap();
    assert_eq!(bounded.phi(), free.phi());
    assert_eq!(bounded.bounds, problem.bounds);
}

#[test]
fn problems_that_make_no_sense_are_refused() {
    let mut swimmer = Swimmer::purcell();
    swimmer.links.front = 2.0;
    let error = efficiency(&EfficiencyProblem::new(swimmer, Branch::Small)).unwrap_err();
    assert!(error.is_bad_input(), "{error}");
    let mut problem = EfficiencyProblem::new(Swimmer::purcell(), Branch::Small);
    problem.bounds.max_angle = Some(f64::NAN);
    assert!(matches!(
        efficiency(&problem),
        Err(EfficiencyError::Problem(InvalidProblem::Bound { .. }))
    ));
    problem.bounds.max_angle = None;
    problem.bounds.clearance = -0.1;
    assert!(matches!(
        efficiency(&problem),
        Err(EfficiencyError::Problem(InvalidProblem::Clearance { .. }))
    ));
    problem.bounds.clearance = 0.0;
    problem.bounds.sector = true;
    assert!(efficiency(&problem).unwrap_err().is_bad_input());
}

/// Within small bounds the efficiency grows as the square of the angles.
#[test]
fn small_bounds_admit_a_gait() {
    for swimmer in [Swimmer::purcell(), Swimmer::robot()] {
        let of = |max_angle: f64| {
            let found = efficiency(&EfficiencyProblem {
                bounds: gait_optimizer::Bounds::within(max_angle),
                ..EfficiencyProblem::new(swimmer, Branch::Small)
            });
            found.unwrap().efficiency
        };
        let off = of(1e-3) / of(1e-2) / 1e-2 - 1.0;
        assert!(off.abs() < 1e-3, "{off}");
    }
}
