//! Height maps against known numbers, against finite differences of another discretisation, and against swimming.
#![allow(
    clippy::doc_markdown,
    reason = "formulas in the docs read like the paper's: b_x, H_x"
)]

use gait_optimizer::{DisplacementProblem, HeightMap, HeightMapError, Row, displacement};
use nalgebra::{Matrix2, Vector2, Vector3};
use swimmer_files::AnyGait;
use swimmer_model::{Links, Model, Swimmer};

const ROWS: [Row; 3] = [Row::X, Row::Y, Row::Theta];

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

#[test]
fn numbers_known_of_purcell() {
    for (half_width, zero) in [(2.5, 1.41638), (std::f64::consts::PI, 1.41519)] {
        let map = HeightMap::new(&Swimmer::purcell(), half_width).unwrap();
        let at_origin = map.height(Row::X, &Vector2::zeros());
        assert!((at_origin - 0.020_576_131_7).abs() < 5e-11, "{at_origin}");
        let zeros = map.zeros_on_diagonal(Row::X);
        assert!((zeros[0] - zero).abs() < 5e-6, "{half_width}: {zeros:?}");
        assert!(map.convergence().inner_change < 1e-9);
    }
}

/// The definition itself: the connection in the new frame is A^v + ∇b + A^θ ⊗ J b turned by −b_θ, and its curvature, with
/// the frame's slopes by differences, is the height.
#[test]
fn the_height_is_the_curvature_of_the_carried_connection() {
    for swimmer in [Swimmer::purcell(), Swimmer::robot(), uneven()] {
        let map = HeightMap::new(&swimmer, 2.2).unwrap();
        let model = Model::new(&swimmer).unwrap();
        let length = swimmer.total_length();
        let carried = |phi: &Vector2<f64>| {
            let mut a = model.local_connection(phi);
            a.row_mut(0).scale_mut(1.0 / length);
            a.row_mut(1).scale_mut(1.0 / length);
            let b = map.frame(phi).b;
            let h = 1e-4;
            [0, 1].map(|k| {
                let mut step = Vector2::zeros();
                step[k] = h;
                let slope = (map.frame(&(phi + step)).b - map.frame(&(phi - step)).b) / (2.0 * h);
                let a = a.column(k);
                let v = Vector2::new(a.x + slope.x - a.z * b.y, a.y + slope.y + a.z * b.x);
                let (sin, cos) = b.z.sin_cos();
                let v = Matrix2::new(cos, sin, -sin, cos) * v;
                Vector3::new(v.x, v.y, a.z + slope.z)
            })
        };
        for phi in [
            Vector2::new(0.3, -0.8),
            Vector2::new(-1.4, 1.1),
            Vector2::new(1.0, 0.9),
        ] {
            let h = 1e-3;
            let along = |k: usize| {
                let mut step = Vector2::zeros();
                step[k] = h;
                let (above, below) = (carried(&(phi + step)), carried(&(phi - step)));
                [0, 1].map(|column| (above[column] - below[column]) / (2.0 * h))
            };
            let [a1, a2] = carried(&phi);
            // [a1, a2] = (ω1 J v2 − ω2 J v1, 0)
            let bracket = Vector3::new(-a1.z * a2.y + a2.z * a1.y, a1.z * a2.x - a2.z * a1.x, 0.0);
            let curvature = along(0)[1] - along(1)[0] + bracket;
            assert!(
                (curvature - map.heights(&phi)).norm() < 1e-7,
                "{phi}: {curvature} {}",
                map.heights(&phi)
            );
        }
    }
}

#[test]
fn gradients_are_exact() {
    let map = HeightMap::new(&uneven(), 2.8).unwrap();
    for phi in [
        Vector2::new(0.3, -0.8),
        Vector2::new(-2.1, 1.9),
        Vector2::new(2.7, 2.6),
    ] {
        for row in ROWS {
            let (value, gradient) = map.height_and_gradient(row, &phi);
            assert!((value - map.height(row, &phi)).abs() < 1e-15);
            let h = 1e-4;
            for k in 0..2 {
                let mut step = Vector2::zeros();
                step[k] = h;
                let numeric =
                    (map.height(row, &(phi + step)) - map.height(row, &(phi - step))) / (2.0 * h);
                assert!(
                    (numeric - gradient[k]).abs() < 1e-7,
                    "{row:?} {phi}: {numeric} {}",
                    gradient[k]
                );
            }
        }
    }
}

/// Its integrals are least, since they are convex and no wave changes them to first order, not even where it does not vanish on the
/// square's edge.
#[test]
fn no_wave_lowers_what_the_frame_makes_least() {
    const CELLS: usize = 48;
    let half_width = 2.5;
    let lopsided = Swimmer {
        links: Links {
            middle: 1.0,
            front: 1.2,
            back: 0.8,
        },
        ..Swimmer::purcell()
    };
    let ends = (0..CELLS).map(|cell| (2.0 * cell as f64 + 1.0) / CELLS as f64 - 1.0);
    let gauss = [(-0.6_f64.sqrt(), 5.0), (0.0, 8.0), (0.6_f64.sqrt(), 5.0)];
    let points = ends.flat_map(|middle| {
        gauss.map(|(s, weight)| (half_width * (middle + s / CELLS as f64), weight))
    });
    let points: Vec<(f64, f64)> = points.collect();
    let area = (half_width / (9.0 * CELLS as f64)).powi(2);
    for swimmer in [Swimmer::purcell(), lopsided] {
        let map = HeightMap::new(&swimmer, half_width).unwrap();
        assert!(map.frame(&Vector2::zeros()).b.z.abs() < 1e-14);
        let model = Model::new(&swimmer.of_unit_length()).unwrap();
        let waves = [[0.3, 0.2], [-0.9, 0.4], [1.1, 1.3], [0.1, -2.2], [2.7, 1.9]];
        // For each wave: what it changes as b_x, b_y and b_θ, and what it would change in the middle link's own frame.
        let mut changes = waves.map(|_| [Vector3::<f64>::zeros(); 2]);
        for (x, across) in &points {
            for (y, along) in &points {
                let phi = Vector2::new(*x, *y);
                let a = model.local_connection(&phi);
                let frame = map.frame(&phi);
                let rows = |b: Vector3<f64>, slopes: [Vector3<f64>; 2]| {
                    [0, 1, 2].map(|k| {
                        let slope = Vector2::new(a[(k, 0)], a[(k, 1)])
                            + Vector2::new(slopes[0][k], slopes[1][k]);
                        let turned = Vector2::new(a[(2, 0)], a[(2, 1)]) * [-b.y, b.x, 0.0][k];
                        slope + turned
                    })
                };
                let still = rows(Vector3::zeros(), [Vector3::zeros(); 2]);
                for (wave, changes) in waves.iter().zip(&mut changes) {
                    let wave = Vector2::from(*wave);
                    let (sin, cos) = (wave.dot(&phi) + 0.7).sin_cos();
                    let slope = -sin * wave;
                    let turning = cos * Vector2::new(a[(2, 0)], a[(2, 1)]);
                    for (change, [x, y, theta]) in
                        changes.iter_mut().zip([rows(frame.b, frame.slopes), still])
                    {
                        let place = [
                            x.dot(&slope) + y.dot(&turning),
                            y.dot(&slope) - x.dot(&turning),
                        ];
                        let weight = area * across * along;
                        *change += Vector3::new(place[0], place[1], theta.dot(&slope)) * weight;
                    }
                }
            }
        }
        for [change, own] in changes {
            println!("{change:?} {own:?}");
            assert!(change.amax() < 1e-7 && own.amax() > 1e-2, "{change} {own}");
        }
    }
}

#[test]
fn zero_curves_lie_on_zero_and_meet_the_symmetry() {
    for swimmer in [Swimmer::purcell(), Swimmer::robot()] {
        let map = HeightMap::new(&swimmer, 2.8).unwrap();
        for row in ROWS {
            let curves = map.zero_curves(row);
            assert!(!curves.is_empty());
            for curve in &curves {
                assert!(curve.residual <= 1e-12);
                for phi in &curve.points {
                    assert!(phi.amax() <= 2.8 && map.height(row, phi).abs() <= 1e-12);
                }
                let (first, last) = (curve.points[0], curve.points[curve.points.len() - 1]);
                if curve.closed {
                    assert_eq!(first, last);
                } else {
                    assert_eq!((first.amax(), last.amax()), (2.8, 2.8));
                }
                // The image under Φ → −Φ is a zero-level curve too, so lengths come in pairs or map onto themselves.
                let mut images = curve.points.iter().map(|phi| map.height(row, &-phi));
                assert!(images.all(|height| height.abs() < 1e-11));
            }
        }
    }
    let map = HeightMap::new(&Swimmer::purcell(), 2.8).unwrap();
    let counts = ROWS.map(|row| map.zero_curves(row).len());
    assert_eq!(counts, [7, 2, 3]);
}

/// Every sign change on a grid much finer than the search's lies next to a curve.
#[test]
fn no_zero_curve_is_missed() {
    for swimmer in [Swimmer::purcell(), Swimmer::robot(), uneven()] {
        let map = HeightMap::new(&swimmer, 3.4).unwrap();
        for row in ROWS {
            let vertices: Vec<Vector2<f64>> = map
                .zero_curves(row)
                .into_iter()
                .flat_map(|curve| curve.points)
                .collect();
            let grid = map.grid(row, 480);
            let at = |i: usize, j: usize| Vector2::new(grid.angles[i], grid.angles[j]);
            for j in 0..480 {
                for i in 1..480 {
                    if (grid.heights[(i, j)] > 0.0) != (grid.heights[(i - 1, j)] > 0.0) {
                        let near = vertices.iter().any(|phi| (phi - at(i, j)).norm() < 0.05);
                        assert!(near, "{row:?} {}", at(i, j));
                    }
                }
            }
        }
    }
}

/// Rotations commute, so the row θ of the area rule is exact, also for gaits that cross themselves or run clockwise.
#[test]
fn the_area_rule_is_exact_for_rotation_and_close_for_small_gaits() {
    let map = HeightMap::new(&uneven(), 2.8).unwrap();
    // A limaçon: its inner loop is enclosed twice.
    let count = 400;
    let u: Vec<f64> = (0..=count)
        .map(|k| f64::from(k) / f64::from(count))
        .collect();
    let curve: Vec<Vector2<f64>> = u
        .iter()
        .map(|u| {
            let t = u * std::f64::consts::TAU;
            Vector2::new(0.4, -0.2) + Vector2::new(t.cos(), t.sin()) * (0.5 + 1.2 * t.cos())
        })
        .collect();
    let limacon = AnyGait::from_samples(&u, &curve, &[]).unwrap();
    for gait in [
        limacon.clone(),
        limacon.reversed_if(true),
        AnyGait::circle(2.6),
        AnyGait::square(1.9).reversed_if(true),
    ] {
        let rule = map.area_rule(&gait).unwrap();
        assert!(rule.deviation().z.abs() < 1e-9, "{rule:?}");
    }
    // The rule's error is of higher order in the gait's size than the displacement.
    let error = |amplitude: f64| {
        let rule = map.area_rule(&AnyGait::circle(amplitude)).unwrap();
        rule.deviation().xy().norm() / rule.swum.xy().norm()
    };
    assert!(
        error(0.4) < 0.02 && error(0.1) < 0.3 * error(0.4),
        "{} {}",
        error(0.1),
        error(0.4)
    );
}

/// The gaits of the paper's figure: how far the area rule is off where gaits are large.
#[test]
fn the_area_rule_for_gait_b() {
    let gait =
        displacement(&DisplacementProblem::new(Swimmer::robot()).with_max_angle(2.8)).unwrap();
    let map = HeightMap::new(&Swimmer::robot(), 2.8).unwrap();
    let rule = map.area_rule(&gait.gait().unwrap()).unwrap();
    assert!((rule.swum.x - gait.displacement_over_length).abs() < 1e-9);
    let off = rule.deviation().x / rule.swum.x;
    println!("{rule:?} {off}");
    assert!(off.abs() < 0.05, "{off}");
    assert!(rule.deviation().yz().norm() < 1e-9);
}

#[test]
fn what_makes_no_map_is_refused() {
    let purcell = Swimmer::purcell();
    for half_width in [0.0, -1.0, 1e-9, f64::NAN, f64::INFINITY, 100.0] {
        assert!(matches!(
            HeightMap::new(&purcell, half_width),
            Err(HeightMapError::HalfWidth { .. })
        ));
    }
    let broken = Swimmer {
        chi: -1.0,
        ..purcell
    };
    assert!(matches!(
        HeightMap::new(&broken, 2.0),
        Err(HeightMapError::Swimmer(_))
    ));
    let map = HeightMap::new(&purcell, 2.0).unwrap();
    assert!(matches!(
        map.area_rule(&AnyGait::circle(2.1)),
        Err(HeightMapError::GaitBeyondMap { reach, .. }) if (reach - 2.1).abs() < 1e-3
    ));
    // Beyond π the map goes on.
    let wide = HeightMap::new(&purcell, 6.0).unwrap();
    assert!(wide.convergence().inner_change < 1e-6);
}
