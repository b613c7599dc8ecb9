use swimmer_files::{Bounds, Objective};
use swimmer_model::{Model, Swimmer, Tolerance, swim};

use super::{AtlasError, AtlasProblem, atlas};

fn problem(swimmer: Swimmer<f64>) -> AtlasProblem {
    AtlasProblem {
        bounds: Bounds {
            max_angle: Some(2.8),
            ..Bounds::default()
        },
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
        bounds: Bounds {
            max_angle: Some(2.8),
            no_overlap: true,
            ..Bounds::default()
        },
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

/// What the quarter solver certifies is in the atlas too, even where the polish of its coarse curve fails.
#[test]
fn no_certified_gait_is_lost() {
    let bounds = Bounds {
        max_angle: Some(3.5),
        ..Bounds::default()
    };
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
    assert_eq!(with(sector), Err(AtlasError::QuarterBound));
    let max = Bounds {
        max_angle: Some(-1.0),
        ..Bounds::default()
    };
    assert!(matches!(with(max), Err(AtlasError::MaxAngle { .. })));
    let none = atlas(&AtlasProblem { starts: 0, ..good });
    assert!(matches!(none, Err(AtlasError::Size { .. })));
}
