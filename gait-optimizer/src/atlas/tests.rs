use nalgebra::Vector2;
use swimmer_files::{AnyGait, Bounds, Objective};
use swimmer_model::{Links, Model, Swimmer, TangentialDrag, Tolerance, swim, trajectory};

use super::{AtlasError, AtlasProblem, InvalidProblem, atlas};
use crate::certify::{certified, ways_up};
use crate::efficiency::best_symmetric;
use crate::{Branch, Condition, EfficiencyProblem, OptimalGait};

fn problem(swimmer: Swimmer<f64>) -> AtlasProblem {
    AtlasProblem {
        bounds: Bounds::within(2.8),
        starts: 16,
        ..AtlasProblem::new(swimmer, Objective::Displacement)
    }
}

/// The quarter solver finds the paper's gait (b) by quite another way; its own results are not among these starts.
#[test]
fn the_best_displacement_of_the_robot_is_the_papers_gait_b() {
    let found = atlas(&problem(Swimmer::robot())).unwrap();
    let best = found.optima.first().unwrap();
    assert!((best.distance_over_length - 0.079_697_972_2).abs() < 1e-9);
    assert!(best.gait.symmetric && best.simple && best.gait.certificate.pass());
    assert!(best.found > 8);
    assert!((best.gait.start_angle - 1.401_83).abs() < 1e-4);
    assert!(best.gait.lateral_over_length.abs() < 1e-9);
}

/// Without the double symmetry there are far better gaits than the paper's, also within what the robot can play.
#[test]
fn without_symmetry_the_robot_swims_more_efficiently_within_its_bounds() {
    let found = atlas(&AtlasProblem {
        bounds: Bounds::within(2.8).apart(0.0),
        starts: 24,
        ..AtlasProblem::new(Swimmer::robot(), Objective::Efficiency)
    })
    .unwrap();
    assert!(found.optima.iter().all(|one| one.gait.certificate.pass()));
    let best = found.optima.first().unwrap();
    assert!(!best.gait.symmetric && best.simple && best.gait.links_cross == 0.0);
    let small = found.optima.iter();
    let mut small = small.filter(|one| one.gait.symmetric && one.gait.arcs.len() == 1);
    let small = small.next().unwrap();
    assert!((small.gait.start_angle - 1.38).abs() < 1e-2);
    assert!(best.gait.efficiency > 1.6 * small.gait.efficiency);
    // Swum again by the model alone.
    let model = Model::new(&Swimmer::robot()).unwrap();
    let stroke = swim(&model, &best.gait.gait().unwrap(), &Tolerance::default());
    assert!((stroke.efficiency_constant_power() / best.gait.efficiency - 1.0).abs() < 1e-7);
    assert!(stroke.rotation.abs() < 1e-8);
}

/// Gaits that the quarter solver certifies are in the atlas too, even if the polish of their coarse curve fails.
#[test]
fn no_certified_gait_is_lost() {
    let bounds = Bounds::within(3.5);
    let swimmer = Swimmer::purcell();
    let known = crate::displacement(&crate::DisplacementProblem {
        bounds,
        heading: Some(crate::Heading::Backwards),
        ..crate::DisplacementProblem::new(swimmer)
    })
    .unwrap();
    let found = atlas(&AtlasProblem {
        bounds,
        starts: 4,
        ..problem(swimmer)
    })
    .unwrap();
    let distance = known.displacement_over_length.abs();
    let same = |one: &&super::Optimum| (one.distance_over_length - distance).abs() < 1e-8;
    let listed: Vec<_> = found.optima.iter().filter(same).collect();
    assert_eq!(listed.len(), 1, "{distance}");
    assert!(listed.iter().all(|one| one.simple && one.found >= 1));
    let counted: usize = found.optima.iter().map(|one| one.found).sum();
    let rest = found.unsettled + found.left + found.uncertified;
    assert_eq!(counted + rest, found.starts);
}

fn swimmer(middle: f64, chi: f64) -> Swimmer<f64> {
    Swimmer {
        links: Links {
            middle,
            front: 1.0,
            back: 1.0,
        },
        chi,
        ..Swimmer::purcell()
    }
}

/// A gait that is best among gaits with the paper's symmetries and a saddle among all closed curves is not listed. The adaptive
/// integrator confirms that a push out of the symmetry gains.
#[test]
fn what_is_best_of_its_symmetry_only_is_not_listed() {
    let bounds = Bounds::within(2.895);
    let swimmer = swimmer(0.302, 1.8425);
    let problem_of_quarters = crate::DisplacementProblem {
        bounds,
        ..crate::DisplacementProblem::new(swimmer)
    };
    let known = crate::displacement::best_symmetric(
        &problem_of_quarters,
        crate::Heading::Backwards,
        &|_| (),
    )
    .unwrap();
    let certificate = &known.certificate;
    assert!(certificate.holds_among_symmetric() && !certificate.pass());
    let found = atlas(&AtlasProblem {
        bounds,
        starts: 4,
        ..problem(swimmer)
    })
    .unwrap();
    let distance = |one: &OptimalGait| one.displacement_over_length.abs();
    let model = Model::new(&known.swimmer.of_unit_length()).unwrap();
    let tolerance = Tolerance::new(1e-10);
    let mut y = 0.0;
    trajectory(&model, &known.gait().unwrap(), &tolerance, 4, |point| {
        if point.u.to_bits() == 0.25_f64.to_bits() {
            y = point.pose.position().y;
        }
    });
    // The multiplier of rotation pays for what a push turns.
    let c = -known.displacement_over_length.signum() * y;
    let asked = certified(known.clone()).certificate;
    assert!(asked.value(Condition::NoAscentWithoutSymmetry) > Some(0.0));
    for pushed in ways_up(&model, &known).iter().take(2) {
        let mut pushed = pushed.clone();
        pushed.dedup_by(|a, b| a.0.to_bits() == b.0.to_bits());
        let (u, phi): (Vec<f64>, Vec<Vector2<f64>>) = pushed.into_iter().unzip();
        let curve = AnyGait::from_samples(&u, &phi, &corners(&known, &u)).unwrap();
        let stroke = swim(&model, &curve, &tolerance);
        let gained = stroke.displacement.norm() + c * stroke.rotation - distance(&known);
        assert!(gained > 1e-5, "{gained:e}");
    }
    let listed = |one: &super::Optimum| (one.distance_over_length - distance(&known)).abs() < 1e-6;
    assert!(!found.optima.is_empty() && !found.optima.iter().any(listed));
}

/// Indices of the corners of a gait among these u.
fn corners(gait: &OptimalGait, among: &[f64]) -> Vec<usize> {
    let place = |corner: &f64| among.iter().position(|u| (u - corner).abs() < 1e-12);
    gait.corners().iter().filter_map(place).collect()
}

/// The loop that this swimmer's starts run into is a saddle; above it lies an optimum.
#[test]
fn the_search_goes_on_from_a_saddle() {
    let found = atlas(&AtlasProblem {
        bounds: Bounds::within(2.864).apart(0.0),
        starts: 4,
        order: 4,
        ..problem(Swimmer {
            tangential_drag: TangentialDrag::HalfThickness(0.01324),
            sphere_radius: 1.24273,
            ..swimmer(2.72859, 1.88721)
        })
    })
    .unwrap();
    let best = found.optima.first().unwrap();
    let ascents = best.gait.certificate.value(Condition::NoAscent);
    assert_eq!(ascents, Some(0.0));
    // The saddle has 0.001178.
    assert!(best.distance_over_length > 0.0013 && best.found >= 4);
}

/// The large gait of long side links is the best with its symmetries, and no optimum: a gait without them lies near and is better.
#[test]
fn a_saddle_of_efficiency_is_not_listed_but_what_lies_beside_it() {
    let swimmer = swimmer(0.4, 2.6);
    let saddle = best_symmetric(&EfficiencyProblem::new(swimmer, Branch::Large), &|_| ()).unwrap();
    let failed = saddle.certificate.failures();
    assert!(
        failed.starts_with("ascent_directions_without_symmetry = 1") && !failed.contains(','),
        "{failed}"
    );
    let found = atlas(&AtlasProblem {
        starts: 24,
        order: 8,
        ..AtlasProblem::new(swimmer, Objective::Efficiency)
    })
    .unwrap();
    let listed = |gait: &OptimalGait| (gait.efficiency / saddle.efficiency - 1.0).abs() < 1e-6;
    assert!(!found.optima.iter().any(|one| listed(&one.gait)));
    let beside = found.optima.iter().find(|one| {
        let gait = &one.gait;
        one.simple && !gait.symmetric && gait.displacement_over_length < 0.0
    });
    let better = beside.unwrap().gait.efficiency / saddle.efficiency;
    assert!((1.05..1.5).contains(&better), "{better}");
}

#[test]
fn the_same_seed_gives_the_same_atlas_on_any_number_of_threads() {
    let one = atlas(&problem(Swimmer::purcell())).unwrap();
    let three = atlas(&AtlasProblem {
        threads: 3,
        ..problem(Swimmer::purcell())
    })
    .unwrap();
    assert_eq!(one, three);
}

#[test]
fn senseless_problems_are_refused() {
    let good = problem(Swimmer::purcell());
    let with = |bounds| atlas(&AtlasProblem { bounds, ..good });
    let sector = Bounds {
        sector: true,
        ..Bounds::default()
    };
    let quarter = InvalidProblem::QuarterBound { name: "sector" };
    assert_eq!(with(sector), Err(quarter.into()));
    let max = Bounds::within(-1.0);
    assert!(matches!(
        with(max),
        Err(AtlasError::Problem(InvalidProblem::Bound { .. }))
    ));
    let none = atlas(&AtlasProblem { starts: 0, ..good });
    assert!(matches!(none, Err(AtlasError::Size { .. })));
}
