//! Bounded efficiency gaits by Pontryagin's principle and by direct collocation, which share only A and W.

use collocation::{CollocationProblem, CollocationSolution, solve};
use gait_optimizer::{
    ArcKind, Bounds, Branch, EfficiencyError, EfficiencyProblem, OptimalGait, efficiency,
};
use swimmer_files::AnyGait;
use swimmer_model::{Model, Swimmer};

fn bounded(
    swimmer: Swimmer<f64>,
    branch: Branch,
    max_angle: Option<f64>,
    no_overlap: bool,
) -> Result<OptimalGait, EfficiencyError> {
    efficiency(&EfficiencyProblem {
        bounds: Bounds {
            max_angle,
            no_overlap,
            ..Bounds::default()
        },
        ..EfficiencyProblem::new(swimmer, branch)
    })
}

fn by_collocation(
    swimmer: Swimmer<f64>,
    gait: &OptimalGait,
    max_angle: f64,
) -> CollocationSolution {
    let model = Model::new(&swimmer.of_unit_length()).unwrap();
    let sign = gait.displacement_over_length.signum();
    let problem = CollocationProblem::new(&model, sign).with_max_angle(max_angle);
    // Every eighth sample, to two digits, is the initial guess.
    let (u, phi): (Vec<_>, Vec<_>) = gait
        .u()
        .iter()
        .zip(gait.phi())
        .step_by(8)
        .map(|(u, phi)| (*u, phi.map(|angle| (angle * 100.0).round() / 100.0)))
        .unzip();
    let guess = AnyGait::from_samples(&u, &phi, &[]).unwrap();
    solve(&problem, &guess).unwrap()
}

#[test]
fn arcs_and_collocation_agree() {
    let (purcell, robot) = (Swimmer::purcell(), Swimmer::robot());
    for (swimmer, branch, max_angle, known) in [
        (purcell, Branch::Small, 1.2, 0.011_704_961_724),
        (purcell, Branch::Small, 0.8, 0.007_986_651_547),
        (purcell, Branch::Large, 2.8, 0.015_274_504_664),
        (purcell, Branch::Large, 2.4, 0.004_998_469_054),
        (robot, Branch::Small, 2.0, 0.000_388_530_396),
        (robot, Branch::Small, 1.6, 0.000_338_991_541),
        (robot, Branch::Small, 1.2, 0.000_203_316_117),
        (robot, Branch::Small, 0.8, 0.000_068_789_986),
        (robot, Branch::Large, 2.8, 0.000_429_501_699),
    ] {
        let gait = bounded(swimmer, branch, Some(max_angle), false).unwrap();
        assert!(gait.certificate.pass());
        assert!(gait.arcs.iter().any(|arc| arc.kind == ArcKind::Upper));
        assert!(gait.efficiency_figures.unwrap().residual <= 1e-10);
        let farthest = gait.phi().iter().map(nalgebra::Vector2::amax);
        assert!(farthest.fold(0.0, f64::max) <= max_angle + 1e-9);
        let CollocationSolution {
            efficiency: direct,
            overstepped,
            ..
        } = by_collocation(swimmer, &gait, max_angle);
        assert!(
            branch == Branch::Large || overstepped < 1e-5,
            "{max_angle}: {overstepped}"
        );
        let (to_known, to_direct) = (gait.efficiency / known, gait.efficiency / direct);
        assert!(
            (to_known - 1.0).abs() < 1e-8 && (to_direct - 1.0).abs() < 1e-6,
            "{branch} {max_angle}: {} {direct}",
            gait.efficiency
        );
    }
}

#[test]
fn where_a_branch_ends_is_said() {
    let ends = |swimmer, max_angle, no_overlap| {
        let error = bounded(swimmer, Branch::Large, max_angle, no_overlap).unwrap_err();
        match error {
            EfficiencyError::BranchEnds {
                reached, reason, ..
            } => (reached, reason),
            other => panic!("{other}"),
        }
    };
    let (reached, reason) = ends(Swimmer::robot(), Some(2.4), false);
    assert!((reached.max_angle - 2.730_04).abs() < 1e-5, "{reached}");
    assert!(reason.contains("folds"), "{reason}");
    let (reached, reason) = ends(Swimmer::purcell(), Some(1.6), false);
    assert!((reached.max_angle - 2.02).abs() < 0.01, "{reached}");
    assert!(reason.contains("fades"), "{reason}");
    let (reached, reason) = ends(Swimmer::robot(), None, true);
    assert!(
        (reached.tips_meet.unwrap()[0] - 2.089_96).abs() < 1e-4,
        "{reached}"
    );
    assert!(reason.contains("folds"), "{reason}");
}

#[test]
fn links_are_kept_from_crossing() {
    let gait = bounded(Swimmer::purcell(), Branch::Large, None, true).unwrap();
    assert!(gait.certificate.pass());
    // It bends round the shape where the tips meet, and leaves along the bound.
    let tips = (-0.5_f64).acos();
    assert!((gait.start_angle - tips).abs() < 1e-7);
    assert_eq!(gait.arcs[0].kind, ArcKind::Clearance);
    assert!(gait.links_cross.abs() < 1e-12, "{}", gait.links_cross);
    assert!((gait.efficiency / 0.013_052_615 - 1.0).abs() < 1e-6);
    let small = bounded(Swimmer::robot(), Branch::Small, None, true).unwrap();
    let free = bounded(Swimmer::robot(), Branch::Small, None, false).unwrap();
    assert!((small.efficiency - free.efficiency).abs() < 1e-15);
}
