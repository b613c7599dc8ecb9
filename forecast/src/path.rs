//! The way of the joints at each stage between a designed gait and a servo's shaft, as gaits that the model can swim: the
//! table's interpolant, and chains of straight pieces.

use nalgebra::Vector2;
use swimmer_model::{Gait, GaitPoint};

/// A closed curve through evenly spaced knots, by the periodic cubic of the robot's table
/// ([`gait_player::GaitTable`]) in double precision and without its rounding.
#[derive(Debug, Clone, PartialEq)]
pub struct TableCurve {
    knots: Vec<Vector2<f64>>,
}

impl TableCurve {
    /// Through these knots \[rad\], knot i at u = i/n.
    pub fn new(knots: Vec<Vector2<f64>>) -> Self {
        Self { knots }
    }

    fn knot(&self, index: usize) -> Vector2<f64> {
        let count = self.knots.len().max(1);
        self.knots.get(index % count).copied().unwrap_or_default()
    }
}

/// The piece that holds u, of so many, with the place in it from 0 to 1.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a share of the pieces; NaN becomes 0"
)]
fn piece(u: f64, pieces: usize) -> (usize, f64) {
    let scaled = (u - u.floor()) * pieces as f64;
    let index = (scaled as usize).min(pieces.saturating_sub(1));
    (index, scaled - index as f64)
}

impl Gait<f64> for TableCurve {
    fn at(&self, u: f64) -> GaitPoint<f64> {
        let count = self.knots.len();
        let (interval, t) = piece(u, count);
        // Six knots around the interval give its slopes: central differences of fourth order.
        let near: [Vector2<f64>; 6] =
            std::array::from_fn(|i| self.knot(interval + 2 * count + i - 2));
        let [k0, k1, k2, k3, k4, k5] = near;
        let start = (8.0 * (k3 - k1) - (k4 - k0)) / 12.0;
        let end = (8.0 * (k4 - k2) - (k5 - k1)) / 12.0;
        let rise = k3 - k2;
        let (c, d) = (3.0 * rise - 2.0 * start - end, start + end - 2.0 * rise);
        GaitPoint {
            phi: k2 + t * (start + t * (c + t * d)),
            rate: (start + t * (2.0 * c + t * 3.0 * d)) * count as f64,
        }
    }

    fn pieces(&self) -> usize {
        self.knots.len()
    }

    fn piece_end(&self, i: usize) -> f64 {
        (i + 1) as f64 / self.knots.len().max(1) as f64
    }
}

/// A chain of straight pieces, each given the same share of u: only its shape means something, not its timing.
#[derive(Debug, Clone, PartialEq)]
pub struct Polyline {
    vertices: Vec<Vector2<f64>>,
}

impl Polyline {
    /// Through these shapes \[rad\]; repeated ones are left out.
    pub fn new(vertices: impl IntoIterator<Item = Vector2<f64>>) -> Self {
        let mut kept: Vec<Vector2<f64>> = Vec::new();
        for vertex in vertices {
            if kept.last() != Some(&vertex) {
                kept.push(vertex);
            }
        }
        Self { vertices: kept }
    }

    /// Its corners \[rad\].
    pub fn vertices(&self) -> &[Vector2<f64>] {
        &self.vertices
    }
}

impl Gait<f64> for Polyline {
    fn at(&self, u: f64) -> GaitPoint<f64> {
        let pieces = self.vertices.len().saturating_sub(1);
        let (index, t) = piece(u, pieces);
        match (self.vertices.get(index), self.vertices.get(index + 1)) {
            (Some(from), Some(to)) => GaitPoint {
                phi: from + (to - from) * t,
                rate: (to - from) * pieces as f64,
            },
            _ => GaitPoint {
                phi: self.vertices.first().copied().unwrap_or_default(),
                rate: Vector2::zeros(),
            },
        }
    }

    fn pieces(&self) -> usize {
        self.vertices.len().saturating_sub(1).max(1)
    }

    fn piece_end(&self, i: usize) -> f64 {
        (i + 1) as f64 / self.pieces() as f64
    }

    fn corner_at_end(&self, _i: usize) -> bool {
        true
    }
}

#[cfg(test)]
#[allow(
    clippy::cast_possible_truncation,
    reason = "the robot's own arithmetic is in single precision"
)]
mod tests {
    use super::*;
    use gait_player::{GaitTable, table::Phase};
    use swimmer_model::Circle;

    #[test]
    fn the_table_curve_is_the_robots_interpolant() {
        for knots in [7, 64, 512] {
            let gait = Circle { amplitude: 1.9 };
            let table =
                GaitTable::from_fn(knots, |u| Gait::<f64>::at(&gait, u).phi.into()).unwrap();
            let rounded = (0..knots)
                .map(|i| Vector2::from(table.knot(i).map(|units| f64::from(units) * 1e-4)))
                .collect();
            let curve = TableCurve::new(rounded);
            for i in 0..997_usize {
                let scaled = i as f64 / 997.0 * knots as f64;
                let interval = i * knots / 997;
                let fraction = scaled - interval as f64;
                let robot = table.at(Phase {
                    interval,
                    fraction: fraction as f32,
                });
                let ours = curve.at(i as f64 / 997.0).phi;
                for joint in 0..2 {
                    assert!((f64::from(robot.angles[joint]) - ours[joint]).abs() < 2e-6);
                }
            }
        }
    }

    #[test]
    fn rates_are_the_slopes_of_the_curves() {
        let corners = [[0.0, 0.0], [1.0, 0.2], [0.3, 0.9]].map(Vector2::from);
        let gaits: [&dyn Gait<f64>; 2] = [
            &TableCurve::new(corners.to_vec()),
            &Polyline::new([corners[0], corners[1], corners[1], corners[2], corners[0]]),
        ];
        assert_eq!(gaits[1].pieces(), 3);
        for gait in gaits {
            for i in 0..50 {
                let u = (f64::from(i) + 0.5) / 50.0;
                let slope = (gait.at(u + 1e-6).phi - gait.at(u - 1e-6).phi) / 2e-6;
                assert!((slope - gait.at(u).rate).norm() < 1e-6, "{u}");
            }
            assert!((gait.at(0.0).phi - corners[0]).norm() < 1e-15);
        }
    }
}
