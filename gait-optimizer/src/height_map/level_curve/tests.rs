//! Tests with curves of known shape.

use super::*;

fn find(f: impl Fn(&Vector2<f64>) -> (f64, Vector2<f64>)) -> Vec<LevelCurve> {
    let level = Level(f);
    level_curves(&level, &LevelSearch::new(2.0), |first, second| {
        DMatrix::from_fn(first.len(), second.len(), |i, j| {
            level.at(&(Vector2::new(first[i], second[j]) * 2.0)).0
        })
    })
}

#[test]
fn circles_are_closed_and_on_the_level() {
    // A circle, and a loop far smaller than a cell.
    let curves = find(|p| {
        let small = Vector2::new(1.301, -1.507);
        let (a, b) = (p.norm_squared() - 0.49, (p - small).norm_squared() - 4e-4);
        (a * b, p * (2.0 * b) + (p - small) * (2.0 * a))
    });
    assert_eq!(curves.len(), 2, "{curves:?}");
    assert!(
        curves
            .iter()
            .all(|curve| curve.closed && curve.residual <= 1e-12)
    );
    let length = |curve: &LevelCurve| -> f64 {
        curve
            .points
            .array_windows()
            .map(|[a, b]| (b - a).norm())
            .sum()
    };
    let mut lengths: Vec<f64> = curves.iter().map(length).collect();
    lengths.sort_by(f64::total_cmp);
    assert!(
        (lengths[0] / (0.04 * std::f64::consts::PI) - 1.0).abs() < 0.01,
        "{lengths:?}"
    );
    assert!(
        (lengths[1] / (1.4 * std::f64::consts::PI) - 1.0).abs() < 1e-3,
        "{lengths:?}"
    );
}

#[test]
fn curves_go_straight_through_their_crossings_and_end_on_the_edge() {
    // φ₁ = −φ₂, and a parabola that crosses it twice.
    let curves = find(|p| {
        let (a, b) = (p.x + p.y, p.y - p.x * p.x + 0.7);
        (a * b, Vector2::new(b - 2.0 * p.x * a, b + a))
    });
    assert_eq!(curves.len(), 2);
    for curve in &curves {
        assert!(!curve.closed);
        for end in [curve.points[0], curve.points[curve.points.len() - 1]] {
            assert!((end.amax() - 2.0).abs() < 1e-15, "{end}");
        }
        let straight = curve.points.iter().all(|p| (p.x + p.y).abs() < 1e-9);
        let parabola = curve
            .points
            .iter()
            .all(|p| (p.y - p.x * p.x + 0.7).abs() < 1e-9);
        assert!(straight || parabola);
    }
}
