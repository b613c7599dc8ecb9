//! The gaits of the paper and of the efficiency atlas, run as fast as servos of the same rate allow, compared with the fastest
//! gait within the same angles: none is faster.

use gait_optimizer::{
    AtlasProblem, Bounds, Branch, DisplacementProblem, EfficiencyProblem, Objective, SimpleShape,
    SpeedProblem, atlas, best_amplitudes, displacement, efficiency, fastest,
};
use swimmer_files::AnyGait;
use swimmer_model::{Gait as _, Model, Swimmer, Tolerance, swim};

/// Largest |φᵢ|, and the least period at 1 rad/s: the curve's length in the box norm.
fn reach_and_period(gait: &AnyGait) -> (f64, f64) {
    const STEPS: u32 = 100_000;
    (0..STEPS).fold((0.0, 0.0), |(reach, period), k| {
        let point = gait.at((f64::from(k) + 0.5) / f64::from(STEPS));
        (
            point.phi.amax().max(reach),
            period + point.rate.amax() / f64::from(STEPS),
        )
    })
}

/// Holds a gait against the fastest within `max_angle`, or within its own angles; prints a row.
#[track_caller]
fn none_faster(swimmer: &Swimmer<f64>, name: &str, gait: &AnyGait, max_angle: Option<f64>) {
    let model = Model::new(&swimmer.of_unit_length()).unwrap();
    let stroke = swim(&model, gait, &Tolerance::default());
    let (reach, period) = reach_and_period(gait);
    let speed = stroke.displacement.norm() / period;
    let fastest = fastest(&SpeedProblem {
        bounds: Bounds::within(max_angle.unwrap_or(reach + 1e-6)),
        threads: 2,
        ..SpeedProblem::new(*swimmer, [1.0; 2])
    })
    .unwrap()
    .speed_over_length;
    println!(
        "{name:<42} {:.6} |d|/L in {period:>6.3} s: {speed:.8} 1/s; within {:.4} rad the fastest {fastest:.8} 1/s, {:.3} times",
        stroke.displacement.norm(),
        max_angle.unwrap_or(reach),
        fastest / speed,
    );
    // A gait without rotation is one of those that were searched.
    assert!(stroke.rotation.abs() < 1e-6, "{name}");
    assert!(speed <= fastest * (1.0 + 1e-6), "{name}");
}

fn of_the_paper(swimmer: &Swimmer<f64>, who: &str) {
    let model = Model::new(swimmer).unwrap();
    for objective in [Objective::Displacement, Objective::Efficiency] {
        for shape in [SimpleShape::Circle, SimpleShape::Square] {
            // The first: small amplitudes, as in the paper.
            let Some(best) = best_amplitudes(&model, shape, objective, 4.5)
                .first()
                .copied()
            else {
                continue;
            };
            let name = format!(
                "{who}: {shape:?} of {:.4} rad, {objective:?}",
                best.amplitude
            );
            none_faster(swimmer, &name, &shape.gait(best.amplitude), None);
        }
    }
    for branch in [Branch::Small, Branch::Large] {
        let gait = efficiency(&EfficiencyProblem::new(*swimmer, branch)).unwrap();
        let name = format!("{who}: Lighthill, {branch}");
        none_faster(swimmer, &name, &gait.gait().unwrap(), None);
    }
}

#[test]
fn no_gait_of_the_paper_is_faster() {
    let (robot, purcell) = (Swimmer::robot(), Swimmer::purcell());
    of_the_paper(&robot, "robot");
    of_the_paper(&purcell, "purcell");
    let unbounded = displacement(&DisplacementProblem::new(purcell)).unwrap();
    let name = "purcell: most displacement, unbounded";
    none_faster(&purcell, name, &unbounded.gait().unwrap(), None);
    for (name, min_angle, sector) in [
        ("robot: (b)", None, false),
        ("robot: (c), above 1.5 rad", Some(1.5), false),
        ("robot: (d), in the sector", None, true),
    ] {
        let gait = displacement(&DisplacementProblem {
            bounds: Bounds {
                max_angle: Some(2.8),
                min_angle,
                sector,
                ..Bounds::default()
            },
            ..DisplacementProblem::new(robot)
        })
        .unwrap();
        none_faster(&robot, name, &gait.gait().unwrap(), Some(2.8));
    }
}

#[test]
#[ignore = "soak"]
fn no_gait_of_the_efficiency_atlas_is_faster() {
    for (who, swimmer) in [("robot", Swimmer::robot()), ("purcell", Swimmer::purcell())] {
        for max_angle in [2.0, 2.4, 2.6, 2.8, 3.0] {
            let found = atlas(&AtlasProblem {
                bounds: Bounds::within(max_angle),
                threads: 2,
                ..AtlasProblem::new(swimmer, Objective::Efficiency)
            })
            .unwrap();
            assert!(!found.optima.is_empty(), "{who} {max_angle}");
            for (k, optimum) in found.optima.iter().enumerate() {
                let name = format!("{who}: atlas number {}", k + 1);
                none_faster(
                    &swimmer,
                    &name,
                    &optimum.gait.gait().unwrap(),
                    Some(max_angle),
                );
            }
        }
    }
}
