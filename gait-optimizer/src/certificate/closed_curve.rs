//! Self-crossings and turning number of closed polygons.

use nalgebra::Vector2;

use super::{Check, Condition};

/// Checks that a curve turns once and that no two of its sides cross. `whole` is the closed curve, `simple` the part that must not
/// cross itself (the whole curve, except for gaits that meet their own images).
pub(crate) fn simple_and_turning_once(
    whole: &[Vector2<f64>],
    simple: &[Vector2<f64>],
) -> [Check; 2] {
    let off_one = (turning_number(whole) - 1.0).abs();
    [
        Condition::TurnsOnce.check(off_one),
        Condition::Simple.check(crossings(simple) as f64),
    ]
}

/// Twice the enclosed area of a closed polygon, counter-clockwise positive.
pub(crate) fn double_area(points: &[Vector2<f64>]) -> f64 {
    points.array_windows().map(|[a, b]| a.perp(b)).sum()
}

/// Distance of a point from a side.
pub(crate) fn to_side(point: &Vector2<f64>, a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
    let side = b - a;
    let share = ((point - a).dot(&side) / side.norm_squared()).clamp(0.0, 1.0);
    if share.is_finite() {
        (point - a - side * share).norm()
    } else {
        (point - a).norm()
    }
}

/// Turning number of a closed polygon (last point = first), counter-clockwise positive.
pub(crate) fn turning_number(points: &[Vector2<f64>]) -> f64 {
    let sides = points.array_windows().map(|[a, b]| b - a);
    let sides: Vec<Vector2<f64>> = sides.filter(|side| side.norm() > 0.0).collect();
    let turns = sides
        .iter()
        .zip(sides.iter().cycle().skip(1))
        .map(|(a, b)| a.perp(b).atan2(a.dot(b)));
    turns.sum::<f64>() / std::f64::consts::TAU
}

/// Number of pairs of sides of a polygon that cross. The last point of a closed polygon repeats the first.
pub(crate) fn crossings(points: &[Vector2<f64>]) -> usize {
    let sides: Vec<[Vector2<f64>; 2]> = points.array_windows().copied().collect();
    // In the order of the left ends, a side can only cross sides that start before it ends.
    let mut order: Vec<(f64, f64, usize)> = sides
        .iter()
        .enumerate()
        .map(|(i, [a, b])| (a.x.min(b.x), a.x.max(b.x), i))
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut count = 0;
    for (at, &(_, right, i)) in order.iter().enumerate() {
        for &(left, _, j) in order.iter().skip(at + 1) {
            if left > right {
                break;
            }
            let apart = i.abs_diff(j);
            if apart > 1
                && apart + 1 < sides.len()
                && matches!((sides.get(i), sides.get(j)), (Some(a), Some(b)) if cross(a, b))
            {
                count += 1;
            }
        }
    }
    count
}

/// Returns `true` if two segments cross properly.
fn cross([a, b]: &[Vector2<f64>; 2], [c, d]: &[Vector2<f64>; 2]) -> bool {
    let side = |p: &Vector2<f64>, q: &Vector2<f64>, r: &Vector2<f64>| (q - p).perp(&(r - p));
    let (c_side, d_side) = (side(a, b, c), side(a, b, d));
    let (a_side, b_side) = (side(c, d, a), side(c, d, b));
    c_side * d_side < 0.0 && a_side * b_side < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn closed(curve: impl Fn(f64) -> [f64; 2]) -> Vec<Vector2<f64>> {
        let mut points: Vec<_> = (0..100)
            .map(|k| curve(f64::from(k) / 100.0 * std::f64::consts::TAU))
            .map(Vector2::from)
            .collect();
        points.push(points[0]);
        points
    }

    #[test]
    fn a_circle_is_simple_and_turns_once() {
        let circle = closed(|t| [t.cos(), t.sin()]);
        assert_eq!(crossings(&circle), 0);
        assert!((turning_number(&circle) - 1.0).abs() < 1e-12);
        let clockwise = closed(|t| [t.cos(), -t.sin()]);
        assert!((turning_number(&clockwise) + 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_figure_of_eight_and_a_curl_are_not() {
        let eight = closed(|t| [t.sin(), (2.0 * t + 0.1).sin()]);
        assert!(crossings(&eight) >= 1);
        assert!(turning_number(&eight).abs() < 1e-9);
        // A limaçon with an inner loop.
        let curl = closed(|t| {
            [
                (0.5 + (t + 0.01).cos()) * t.cos(),
                (0.5 + (t + 0.01).cos()) * t.sin(),
            ]
        });
        assert_eq!(crossings(&curl), 1);
        assert!((turning_number(&curl) - 2.0).abs() < 1e-9);
    }
}
