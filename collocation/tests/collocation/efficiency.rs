//! Collocation from circles against shooting from Fourier series: both must find the same gaits, and share only A and W.

use gait_optimizer::{Bounds, Branch, EfficiencyProblem, efficiency};
use swimmer_model::Swimmer;

#[test]
fn both_ways_find_the_same_gaits() {
    for swimmer in [
        Swimmer::purcell(),
        Swimmer::robot(),
        Swimmer::robot_slender(),
    ] {
        for branch in [Branch::Small, Branch::Large] {
            let problem = EfficiencyProblem::new(swimmer, branch);
            let shot = efficiency(&problem).unwrap();
            let gait = collocation::efficiency(&problem, &|_| ()).unwrap();
            assert!((gait.efficiency / shot.efficiency - 1.0).abs() < 1e-10);
            assert!((gait.start_angle - shot.start_angle).abs() < 1e-8);
            assert!(gait.certificate.pass(), "{:?}", gait.certificate.failures());
            let figures = gait.efficiency_figures.unwrap();
            assert!(figures.residual <= 1e-10, "{branch}: {}", figures.residual);
            assert!(figures.power_variation < 1e-8, "{branch}");
            // The efficiency of the collocation itself, before the polish by shooting.
            let direct = figures.direct_efficiency.unwrap();
            assert!(
                (direct / shot.efficiency - 1.0).abs() < 1e-6,
                "{branch}: {direct} {}",
                shot.efficiency
            );
        }
    }
}

/// A bound is followed from the free gait, whichever way that was found.
#[test]
fn a_bound_is_followed_from_either() {
    let problem = EfficiencyProblem {
        bounds: Bounds::within(1.2),
        ..EfficiencyProblem::new(Swimmer::robot(), Branch::Small)
    };
    let (shot, ours) = (
        efficiency(&problem).unwrap(),
        collocation::efficiency(&problem, &|_| ()).unwrap(),
    );
    assert!((ours.efficiency / shot.efficiency - 1.0).abs() < 1e-10);
}
