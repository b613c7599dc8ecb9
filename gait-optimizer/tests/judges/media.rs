//! Other media: optima in a perfect fluid against the direct methods, and refusals where nothing is defined.

use gait_optimizer::{
    AtlasProblem, Bounds, Branch, DisplacementError, DisplacementProblem, EfficiencyProblem,
    Heading, HeightMap, InvalidProblem, SpeedProblem, TurningProblem, atlas, certify, displacement,
    efficiency, fastest, turning,
};
use swimmer_files::{AnyGait, GaitFile, Objective};
use swimmer_model::{Link, Links, Medium, Swimmer};

use crate::direct::Direct;
use crate::speed::by_two_methods;

/// Links of the robot in a perfect fluid, twice as wide as the preset's.
fn wide_robot() -> Swimmer<f64> {
    Swimmer {
        medium: Medium::Perfect {
            aspect: 0.2,
            density: 976.0,
        },
        sphere_radius: 0.0,
        ..Swimmer::robot()
    }
}

/// The maximum principle and the direct method meet in a perfect fluid, from arcs moved by 0.05 rad and more.
#[test]
fn farthest_gaits_in_a_perfect_fluid() {
    for (name, problem) in [
        (
            "free, forwards",
            DisplacementProblem::new(Swimmer::perfect_fluid()).heading(Heading::Forwards),
        ),
        (
            "within 1 rad",
            DisplacementProblem::new(Swimmer::perfect_fluid()).with_max_angle(1.0),
        ),
        (
            "robot's links within 1.2 rad",
            DisplacementProblem::new(wide_robot()).with_max_angle(1.2),
        ),
    ] {
        let gait = displacement(&problem).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(gait.certificate.pass(), "{name}");
        assert!(gait.efficiency.is_nan(), "{name}: no drag, no efficiency");
        let mut direct = Direct::off_from(&gait, 0.05, 30);
        let start = direct.carries();
        let (climbed, exact) = (direct.climb(), gait.displacement_over_length);
        println!("{name}: {start} -> {climbed}, arcs {exact}");
        assert!((start - exact).abs() > 1e-5, "{name}: the start is off");
        assert!((climbed - exact).abs() < 1e-6, "{name}: {climbed} {exact}");
    }
}

/// The forward gait from a circle, with no knowledge of the arcs.
#[test]
fn the_forward_gait_in_a_perfect_fluid_from_a_circle() {
    let swimmer = Swimmer::perfect_fluid();
    let problem = DisplacementProblem::new(swimmer).heading(Heading::Forwards);
    let exact = displacement(&problem).unwrap().displacement_over_length;
    let climbed = Direct::from_circle(&swimmer, 1.4, 48).climb();
    println!("from a circle {climbed}, arcs {exact}");
    assert!((climbed - exact).abs() < 1e-6, "{climbed} {exact}");
}

/// The large gait without bounds, on which links cross. It bends more than the others, so its polygon needs more sides.
#[test]
fn the_large_gait_in_a_perfect_fluid() {
    let problem = DisplacementProblem::new(Swimmer::perfect_fluid());
    let gait = displacement(&problem).unwrap();
    let exact = gait.displacement_over_length.abs();
    let climbed = Direct::off_from(&gait, 0.05, 90).climb().abs();
    println!("90 sides {climbed}, arcs {exact}");
    assert!((climbed - exact).abs() < 1e-6, "{climbed} {exact}");
}

#[test]
fn fastest_gaits_in_a_perfect_fluid() {
    by_two_methods(Swimmer::perfect_fluid(), 1.0);
    by_two_methods(wide_robot(), 1.2);
}

/// Displacement does not depend on ρ, which scales W alone.
#[test]
fn density_moves_nothing() {
    let at = |density| {
        let swimmer = Swimmer {
            medium: Medium::Perfect {
                aspect: 0.1,
                density,
            },
            ..Swimmer::purcell()
        };
        displacement(&DisplacementProblem::new(swimmer)).unwrap()
    };
    let (air, water) = (at(1.2), at(1000.0));
    let off = air.displacement_over_length - water.displacement_over_length;
    assert!(off.abs() < 1e-11, "{off:e}");
}

/// Bounds contain the straight snake, at which A is infinite: every search names that shape.
#[test]
fn wheels_are_refused_with_their_singular_shape() {
    let swimmer = Swimmer::<f64>::kinematic_snake();
    let gait = GaitFile::sampled(&AnyGait::circle(1.0), 400);
    let bounds = Bounds::within(1.0);
    let refusals = [
        displacement(&DisplacementProblem::new(swimmer))
            .unwrap_err()
            .to_string(),
        atlas(&AtlasProblem::new(swimmer, Objective::Displacement))
            .unwrap_err()
            .to_string(),
        turning(&TurningProblem { swimmer, bounds })
            .unwrap_err()
            .to_string(),
        fastest(&SpeedProblem::new(swimmer, [1.0; 2]))
            .unwrap_err()
            .to_string(),
        HeightMap::new(&swimmer, 1.0).unwrap_err().to_string(),
        certify(&swimmer, &gait, Objective::Displacement, &bounds)
            .unwrap_err()
            .to_string(),
    ];
    for refusal in refusals {
        assert!(refusal.contains("at the shape (0, 0) rad"), "{refusal}");
    }
}

#[test]
fn efficiency_is_refused_without_drag() {
    let swimmer = Swimmer::<f64>::perfect_fluid();
    let gait = GaitFile::sampled(&AnyGait::circle(1.0), 400);
    let refusals = [
        efficiency(&EfficiencyProblem::new(swimmer, Branch::Small))
            .unwrap_err()
            .to_string(),
        atlas(&AtlasProblem::new(swimmer, Objective::Efficiency))
            .unwrap_err()
            .to_string(),
        certify(&swimmer, &gait, Objective::Efficiency, &Bounds::default())
            .unwrap_err()
            .to_string(),
    ];
    for refusal in refusals {
        assert!(refusal.contains("viscous fluid only"), "{refusal}");
    }
}

/// Side links of one length that differ in drag are not alike; the search over closed curves takes them.
#[test]
fn links_that_differ_in_drag_are_not_alike() {
    let swimmer = Swimmer {
        side_chi: Some([2.0, 3.0]),
        ..Swimmer::purcell()
    };
    let error = displacement(&DisplacementProblem::new(swimmer)).unwrap_err();
    assert!(
        matches!(
            error,
            DisplacementError::Problem(InvalidProblem::Asymmetric { .. })
        ) && error.to_string().contains("in drag, both 1 m long"),
        "{error}"
    );
    let behind = Swimmer {
        sphere_on: Link::Back,
        ..Swimmer::robot()
    };
    let uneven = Swimmer {
        links: Links {
            back: 0.7,
            ..swimmer.links
        },
        ..Swimmer::perfect_fluid()
    };
    for (name, swimmer) in [
        ("own chi", swimmer),
        ("sphere behind", behind),
        ("perfect", uneven),
    ] {
        let found = atlas(&AtlasProblem {
            bounds: Bounds::within(1.5),
            starts: 8,
            threads: 2,
            ..AtlasProblem::new(swimmer, Objective::Displacement)
        })
        .unwrap();
        let best = found.optima.first().unwrap_or_else(|| panic!("{name}"));
        println!("{name}: {}", best.distance_over_length);
        assert!(
            best.gait.certificate.pass() && !best.gait.symmetric,
            "{name}"
        );
    }
}
