//! Turning gaits: against brute force, over swimmers and bounds of all kinds, and the way through a file.

use crate::swimmers;

use std::path::Path;

use gait_optimizer::{
    Bounds, InvalidProblem, Objective, Turning, TurningError, TurningProblem, certify, turning,
};
use nalgebra::Vector2;
use swimmer_files::{AnyGait, GaitFile};
use swimmer_model::{
    Fourier, Gait as _, Harmonic, Links, Model, Swimmer, TangentialDrag, Tolerance, swim,
};

fn uneven() -> Swimmer<f64> {
    Swimmer {
        links: Links {
            middle: 0.09,
            front: 0.14,
            back: 0.11,
        },
        ..Swimmer::robot()
    }
}

fn found(swimmer: Swimmer<f64>, bounds: Bounds) -> Turning {
    match turning(&TurningProblem { swimmer, bounds }) {
        Ok(turning) => turning,
        Err(error) => panic!("{swimmer:?} {bounds}: {error}"),
    }
}

/// The numbers of the note; each is also checked below: by its area integral, by circles and by brute force.
#[test]
fn purcell_and_robot() {
    let close = |turning: &Turning, rotation: f64| {
        let have = turning.gait.rotation;
        assert!((have - rotation).abs() < 1e-9, "{have} {rotation}");
    };
    for (swimmer, max_angle, rotation) in [
        (Swimmer::purcell(), 2.0, 0.590_238_913_2),
        (Swimmer::purcell(), 2.8, 1.479_779_773_5),
        (Swimmer::robot(), 2.8, 0.396_738_842_3),
    ] {
        close(&found(swimmer, Bounds::within(max_angle)), rotation);
    }
    // Where links must not cross, the region round φ₁ = φ₂ loses its core, and the one round the straight shape wins.
    let playable = found(Swimmer::robot(), Bounds::within(2.8).apart(0.0));
    close(&playable, 0.254_612_354_9);
    assert!(playable.gait.links_cross.abs() < 1e-12);
    let mut shapes = playable.gait.phi().iter();
    assert!(shapes.all(|phi| phi.amax() <= 2.8 + 1e-12));
}

/// Largest sum over the connected cells of a square grid with positive values.
fn largest_island(cells: &[f64], count: usize) -> f64 {
    let mut seen = vec![false; cells.len()];
    let mut largest = 0.0;
    for first in 0..cells.len() {
        let (mut open, mut sum) = (vec![first], 0.0);
        while let Some(cell) = open.pop() {
            if seen[cell] || cells[cell] <= 0.0 {
                continue;
            }
            seen[cell] = true;
            sum += cells[cell];
            let (i, j) = (cell / count, cell % count);
            let below = [(i > 0, count), (j > 0, 1)];
            let above = [(i + 1 < count, count), (j + 1 < count, 1)];
            open.extend(below.iter().filter(|next| next.0).map(|next| cell - next.1));
            open.extend(above.iter().filter(|next| next.0).map(|next| cell + next.1));
        }
        largest = f64::max(largest, sum);
    }
    largest
}

/// The curvature of θ where it is positive, summed over the nodes of a grid: the gait turns as much as the largest connected region.
#[test]
fn the_largest_region_by_brute_force() {
    for (swimmer, bounds) in [
        (Swimmer::purcell(), Bounds::within(2.3)),
        (Swimmer::robot(), Bounds::within(2.8)),
        (Swimmer::robot(), Bounds::within(2.8).apart(0.0)),
        (uneven(), Bounds::within(2.5)),
        (Swimmer::perfect_fluid(), Bounds::within(2.0)),
    ] {
        let turning = found(swimmer, bounds);
        let model = Model::new(&swimmer).unwrap();
        let max = bounds.max_angle.unwrap();
        let count = 600_u32;
        let cell = 2.0 * max / f64::from(count);
        let middle = |k: u32| -max + (f64::from(k) + 0.5) * cell;
        let shapes = (0..count).flat_map(|i| (0..count).map(move |j| (i, j)));
        let shapes = shapes.map(|(i, j)| Vector2::new(middle(i), middle(j)));
        let height = |phi: Vector2<f64>| {
            if bounds.no_overlap && swimmer.links.cross(&phi) {
                return 0.0;
            }
            model.first_derivatives(&phi).curvature().z * cell * cell
        };
        let cells: Vec<f64> = shapes.map(height).collect();
        let largest = largest_island(&cells, count as usize);
        let off = turning.gait.rotation / largest - 1.0;
        println!(
            "{bounds}: {off:e} off {largest} rad, {} regions",
            turning.regions
        );
        // A cell cut by the bound of crossing links counts whole or not at all.
        let tolerance = if bounds.no_overlap { 2e-3 } else { 1e-4 };
        assert!(off.abs() < tolerance, "{bounds}: {off}");
    }
}

/// ∬ `F_θ` over what a gait encloses, as ∮ G dφ₂ with ∂G/∂φ₁ = `F_θ`, is what it turns; and no circle inside it turns more.
#[test]
fn the_rotation_is_the_area_integral_and_no_circle_inside_turns_more() {
    for (swimmer, bounds) in [
        (Swimmer::purcell(), Bounds::within(2.3)),
        (Swimmer::robot(), Bounds::within(2.8).apart(0.0)),
        (uneven(), Bounds::within(2.5)),
    ] {
        let gait = found(swimmer, bounds).gait;
        let model = Model::new(&swimmer).unwrap();
        let curve = gait.gait().unwrap();
        // From φ₁ = 0, by Simpson's rule.
        let potential = |phi: &Vector2<f64>| -> f64 {
            let (panels, weight) = (256, |k: u32| if k % 2 == 1 { 4.0 } else { 2.0 });
            let at = |k: u32| {
                let there = Vector2::new(phi.x * f64::from(k) / f64::from(panels), phi.y);
                model.first_derivatives(&there).curvature().z
            };
            let inner: f64 = (1..panels).map(|k| weight(k) * at(k)).sum();
            phi.x * (at(0) + inner + at(panels)) / (3.0 * f64::from(panels))
        };
        let node = 0.5 * 0.6_f64.sqrt();
        let mut enclosed = 0.0;
        for [from, to] in gait.u().array_windows() {
            let step = to - from;
            for (place, weight) in [(0.5 - node, 5.0), (0.5, 8.0), (0.5 + node, 5.0)] {
                let point = curve.at(from + place * step);
                enclosed += weight / 18.0 * step * potential(&point.phi) * point.rate.y;
            }
        }
        let off = (enclosed - gait.rotation).abs();
        assert!(off < 1e-8, "{bounds}: {enclosed} {}", gait.rotation);
        let mut tried = 0;
        for (i, j) in (0..81).map(|k| (k % 9 + 1, k / 9 + 1)) {
            let place = |k: i32| bounds.max_angle.unwrap() * (0.2 * f64::from(k) - 1.0);
            let centre = Vector2::new(place(i), place(j));
            let sides = gait.phi().array_windows();
            let crossed = sides.filter(|[a, b]| {
                let along = (centre.y - a.y) / (b.y - a.y);
                (a.y > centre.y) != (b.y > centre.y) && centre.x < a.x + along * (b.x - a.x)
            });
            if crossed.count() % 2 == 0 {
                continue;
            }
            let near = gait.phi().iter().map(|phi| (phi - centre).norm());
            let radius = 0.999 * near.fold(f64::INFINITY, f64::min);
            let circle = Fourier {
                mean: centre,
                harmonics: [Harmonic {
                    cos: Vector2::new(radius, 0.0),
                    sin: Vector2::new(0.0, radius),
                }],
            };
            tried += 1;
            assert!(swim(&model, &circle, &Tolerance::new(1e-9)).rotation < gait.rotation);
        }
        assert!(tried > 3, "{bounds}: {tried} circles");
    }
}

#[test]
fn the_gait_file_swims_the_same_and_is_certified_from_its_samples() {
    for (swimmer, bounds) in [
        (Swimmer::robot(), Bounds::within(2.8).apart(0.005)),
        (Swimmer::purcell(), Bounds::within(2.0)),
        (uneven(), Bounds::within(2.4)),
    ] {
        let turning = found(swimmer, bounds);
        let text = turning.gait.gait_file("one").to_text();
        let file = GaitFile::parse(&text, Path::new("one.gait")).unwrap();
        assert_eq!((file.objective, file.bounds), (Objective::Turning, bounds));
        let gait = AnyGait::from_file(&file).unwrap();
        let model = Model::new(&swimmer).unwrap();
        let rotation = |gait: &AnyGait| swim(&model, gait, &Tolerance::default()).rotation;
        assert!((rotation(&gait) - turning.gait.rotation).abs() < 1e-11);
        // Turned round, or mirrored, it turns right.
        assert!((rotation(&gait.clone().reversed_if(true)) + turning.gait.rotation).abs() < 1e-9);
        let mirrored: Vec<_> = file.phi.iter().map(|phi| -phi).collect();
        let corners: Vec<usize> = file
            .corners
            .iter()
            .filter_map(|corner| file.u.iter().position(|u| u.to_bits() == corner.to_bits()))
            .collect();
        let mirrored = AnyGait::from_samples(&file.u, &mirrored, &corners).unwrap();
        assert!((rotation(&mirrored) + turning.gait.rotation).abs() < 1e-9);
        let certificate = certify(&swimmer, &file, Objective::Turning, &bounds).unwrap();
        assert!(certificate.pass(), "{bounds}: {}", certificate.failures());
    }
}

#[test]
fn without_a_bound_joints_stay_within_a_half_turn() {
    let turning = found(Swimmer::robot(), Bounds::default());
    assert_eq!(turning.gait.bounds, Bounds::within(std::f64::consts::PI));
    let mut shapes = turning.gait.phi().iter();
    assert!(shapes.all(|phi| phi.amax() < std::f64::consts::PI + 1e-9));
}

#[test]
fn nonsense_is_refused() {
    let refused = |bounds: Bounds| {
        turning(&TurningProblem {
            swimmer: Swimmer::robot(),
            bounds,
        })
        .unwrap_err()
    };
    for value in [0.0, -1.0, f64::NAN, 7.0, f64::INFINITY] {
        assert!(matches!(
            refused(Bounds::within(value)),
            TurningError::Problem(InvalidProblem::Bound { .. })
        ));
    }
    for value in [-0.1, f64::NAN, 0.08, f64::INFINITY] {
        assert!(matches!(
            refused(Bounds::within(2.0).apart(value)),
            TurningError::Problem(InvalidProblem::Clearance { .. })
        ));
    }
    for bounds in [
        Bounds {
            min_angle: Some(1.0),
            ..Bounds::within(2.0)
        },
        Bounds {
            sector: true,
            ..Bounds::within(2.0)
        },
    ] {
        assert!(matches!(
            refused(bounds),
            TurningError::Problem(InvalidProblem::QuarterBound { .. })
        ));
    }
    let broken = Swimmer {
        chi: f64::NAN,
        ..Swimmer::robot()
    };
    let problem = TurningProblem {
        swimmer: broken,
        bounds: Bounds::within(2.0),
    };
    assert!(matches!(
        turning(&problem),
        Err(TurningError::Problem(InvalidProblem::Swimmer(_)))
    ));
}

#[test]
fn all_kinds_of_swimmers_get_a_gait_or_a_reason() {
    let (mut gaits, count) = (0, 36);
    for (k, case) in swimmers::random(20_260_703, count).into_iter().enumerate() {
        let (mut swimmer, bounds) = (case.swimmer, case.bounds);
        if k % 3 == 0 {
            swimmer.links.back *= 0.5 + 0.04 * k as f64;
        }
        let max_angle = bounds.max_angle.unwrap();
        match turning(&TurningProblem { swimmer, bounds }) {
            Ok(turning) => {
                gaits += 1;
                let gait = &turning.gait;
                assert!(gait.certificate.pass() && gait.rotation > 0.0);
                assert!(gait.phi().iter().all(|phi| phi.amax() <= max_angle + 1e-9));
            }
            Err(error) => println!("{swimmer:?} {bounds}: {error}"),
        }
    }
    println!("{gaits} of {count}");
    assert!(gaits >= count * 9 / 10, "{gaits} of {count}");
}

/// A gait that starts in a corner, however blunt, is as long as one sampled more closely: the corner is no bend.
#[test]
fn a_blunt_corner_at_the_start_is_a_corner() {
    let swimmer = Swimmer {
        links: Links {
            middle: 0.05,
            front: 0.14,
            back: 0.14,
        },
        chi: 2.5,
        tangential_drag: TangentialDrag::OverViscosity(1.38),
        sphere_radius: 0.02,
        ..Swimmer::purcell()
    };
    let bounds = Bounds::within(2.0).apart(0.0);
    let found = turning(&TurningProblem { swimmer, bounds }).unwrap();
    assert!(
        found.gait.corners().contains(&0.0),
        "{:?}",
        found.gait.corners()
    );
    // Between the samples, too, the tips are where the links touch: their height over the other link is zero.
    let gait = found.gait.gait().unwrap();
    let heights = (1..190)
        .map(|k| gait.at(1e-4 * f64::from(k)).phi)
        .map(|phi| {
            let both: f64 = 0.14 * (phi.x + phi.y).sin();
            (0.05 * phi.y.sin() + both)
                .max(0.05 * phi.x.sin() + both)
                .abs()
        });
    let off = heights.fold(0.0, f64::max);
    assert!(off < 1e-8, "{off:.1e}");
}

/// The start of the cycle does not depend on the rounding of the corner of the links' clearance on φ₁ = φ₂: all results are those
/// of the smooth bound, whose clearance goes to zero.
#[test]
fn a_cycle_that_meets_the_diagonal_begins_there() {
    for swimmer in [Swimmer::robot_slender(), Swimmer::purcell()] {
        for max in [2.0, 2.4, 2.8] {
            let begun = |bounds| {
                let gait = found(swimmer, bounds).gait;
                let [one, two] = gait.arcs[0].from;
                assert!((one - two).abs() < 1e-9, "{bounds}: {one} {two}");
                gait.displacement_over_length
            };
            begun(Bounds::within(max));
            let (corner, smooth) = (
                begun(Bounds::within(max).apart(0.0)),
                begun(Bounds::within(max).apart(1e-6)),
            );
            assert!((corner - smooth).abs() < 1e-4, "{max}: {corner} {smooth}");
        }
    }
}
