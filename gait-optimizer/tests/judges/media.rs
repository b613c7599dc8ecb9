//! Other media: optima in a perfect fluid against the direct methods, and refusals where nothing is defined.

use gait_optimizer::{
    AtlasProblem, Bounds, Branch, DisplacementError, DisplacementProblem, EfficiencyProblem,
    Heading, HeightMap, InvalidProblem, OptimalGait, SidewaysProblem, SpeedProblem, SteerProblem,
    TurningProblem, atlas, certify, displacement, efficiency, fastest, sideways, steer, turning,
};
use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_files::{AnyGait, GaitFile, Objective};
use swimmer_model::{Link, Links, Medium, Model, Stroke, Swimmer, Tolerance, swim};

use crate::direct::Direct;
use crate::plane::Pose;
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

/// Size of the perturbations \[rad\].
const PUSH: f64 = 0.03;
/// Harmonics of the perturbations.
const HARMONICS: u32 = 3;

/// Compares a gait with random neighbours within its bounds and without net rotation: the model alone swims them, and none is better.
fn no_neighbour_is_better(name: &str, gait: &OptimalGait, value: impl Fn(&Stroke<f64>) -> f64) {
    let model = Model::new(&gait.swimmer).unwrap();
    let file = gait.gait_file("");
    let limit = gait.bounds.max_angle.unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(47);
    let mut wave = || -> Vec<Vector2<f64>> {
        let of_joint = |rng: &mut ChaCha8Rng| -> Vec<[f64; 2]> {
            let mut number = || rng.random_range(-PUSH..PUSH);
            (0..HARMONICS).map(|_| [number(), number()]).collect()
        };
        let joints = [of_joint(&mut rng), of_joint(&mut rng)];
        let at = |u: f64| {
            Vector2::from([0, 1].map(|joint: usize| {
                let terms = joints[joint].iter().zip(1..);
                let terms = terms.map(|([cos, sin], k)| {
                    let (s, c) = (std::f64::consts::TAU * f64::from(k) * u).sin_cos();
                    cos * c + sin * s
                });
                terms.sum::<f64>()
            }))
        };
        file.u.iter().map(|u| at(*u)).collect()
    };
    let swum = |pushes: &[(&[Vector2<f64>], f64)]| {
        let phi = file.phi.iter().enumerate().map(|(at, phi)| {
            let pushed = pushes.iter().map(|(push, times)| push[at] * *times);
            pushed
                .fold(*phi, |sum, push| sum + push)
                .map(|angle| angle.clamp(-limit, limit))
        });
        let file = GaitFile {
            phi: phi.collect(),
            ..file.clone()
        };
        swim(
            &model,
            &AnyGait::from_file(&file).unwrap(),
            &Tolerance::new(1e-9),
        )
    };
    let best = value(&swum(&[]));
    let mut compared = 0;
    for _ in 0..40 {
        let (one, other) = (wave(), wave());
        let at = |times: f64| swum(&[(&one, 1.0), (&other, times)]);
        // Secant method for the share of the second wave that cancels the rotation of the first.
        let (mut before, mut now) = ((0.0, at(0.0)), (0.1, at(0.1)));
        for _ in 0..12 {
            let slope = (now.1.rotation - before.1.rotation) / (now.0 - before.0);
            if now.1.rotation.abs() < 1e-9 || slope == 0.0 {
                break;
            }
            let next = now.0 - now.1.rotation / slope;
            before = now;
            now = (next, at(next));
        }
        let (times, neighbour) = now;
        if times.abs() > 2.0 || neighbour.rotation.abs() > 1e-8 {
            continue;
        }
        compared += 1;
        let value = value(&neighbour);
        assert!(value < best, "{name}: {value} beside {best}");
    }
    println!("{name}: {compared} neighbours, none better than {best}");
    assert!(compared >= 8, "{name}: {compared}");
}

#[test]
fn sideways_gaits_in_a_perfect_fluid() {
    for (name, swimmer) in [("preset", Swimmer::perfect_fluid()), ("wide", wide_robot())] {
        let problem = SidewaysProblem {
            bounds: Bounds::within(1.2),
            starts: 12,
            ..SidewaysProblem::new(swimmer)
        };
        let found = sideways(&problem, &|_| ()).unwrap();
        assert!(found.gait.certificate.pass(), "{name}");
        let first = found.gait.gait().unwrap();
        let stroke = swim(
            &Model::new(&swimmer).unwrap(),
            &first,
            &Tolerance::new(1e-11),
        );
        let across = stroke.displacement_over_length().y;
        assert!((across - found.lateral_over_length).abs() < 1e-6, "{name}");
        no_neighbour_is_better(name, &found.gait, |stroke| {
            stroke.displacement_over_length().norm()
        });
    }
}

/// Three gaits from one shape: forwards, sideways, and a turn; the polygon through each is swum by the model alone.
#[test]
fn gaits_to_steer_by_in_a_perfect_fluid() {
    let swimmer = Swimmer::perfect_fluid();
    let problem = SteerProblem {
        of: SpeedProblem {
            bounds: Bounds::within(1.2),
            starts: 12,
            threads: 2,
            ..SpeedProblem::new(swimmer, [1.0; 2])
        },
        shape: None,
    };
    let steering = steer(&problem, &|_| ()).unwrap();
    let model = Model::new(&swimmer.of_unit_length()).unwrap();
    let shape = Vector2::from(steering.shape);
    for (name, joined) in [
        ("forward", &steering.forward),
        ("left", &steering.left),
        ("turn", &steering.turn),
    ] {
        assert!(joined.gait.certificate.pass(), "{name}");
        let file = joined.gait_file("perfect-fluid", false);
        let ends = [file.phi.first().unwrap(), file.phi.last().unwrap()];
        assert!(
            ends.iter().all(|end| (*end - shape).amax() < 1e-9),
            "{name}"
        );
        let sides = file
            .phi
            .array_windows()
            .map(|side| Pose::along(&model, *side));
        let end = sides.fold(Pose::default(), |pose, side| pose * side);
        let [x, y, theta] = joined.net;
        for (have, told) in [(end.x, x), (end.y, y), (end.theta, theta)] {
            assert!((have - told).abs() < 1e-4, "{name}: {have} {told}");
        }
        // No joint turns faster than 1 rad/s.
        let turns = file.phi.array_windows().zip(file.u.array_windows());
        let fastest = turns.fold(0.0, |most: f64, ([from, to], [start, end])| {
            most.max((to - from).amax() / ((end - start) * joined.period))
        });
        assert!(fastest < 1.0 + 1e-6, "{name}: {fastest} rad/s");
        let carried = if name == "turn" {
            theta.abs()
        } else {
            x.hypot(y)
        };
        assert!(
            (carried / joined.period / joined.rate - 1.0).abs() < 1e-6,
            "{name}"
        );
        assert!(joined.rate <= joined.unjoined_rate * (1.0 + 1e-9), "{name}");
        println!("{name}: {x:.6} {y:.6} {theta:.6} in {:.4} s", joined.period);
    }
    assert!(steering.forward.net[2].abs() < 1e-6 && steering.left.net[2].abs() < 1e-6);
    assert!(steering.turn.net[2] > 0.1);
}

/// Efficiency gaits of swimmers whose side links differ.
#[test]
fn efficient_gaits_with_unequal_side_links() {
    for (name, front, back) in [("shorter behind", 1.0, 0.8), ("longer in front", 1.2, 0.9)] {
        let purcell = Swimmer::purcell();
        let links = Links {
            front,
            back,
            ..purcell.links
        };
        let swimmer = Swimmer { links, ..purcell };
        let found = atlas(&AtlasProblem {
            bounds: Bounds::within(1.2),
            starts: 12,
            threads: 2,
            ..AtlasProblem::new(swimmer, Objective::Efficiency)
        })
        .unwrap();
        let best = &found
            .optima
            .first()
            .unwrap_or_else(|| panic!("{name}"))
            .gait;
        assert!(best.certificate.pass() && !best.symmetric, "{name}");
        no_neighbour_is_better(name, best, Stroke::efficiency_constant_power);
    }
}
