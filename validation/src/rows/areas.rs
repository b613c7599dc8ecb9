//! Rows of section IV.D: areas of the height map that gaits enclose.

use gait_optimizer::{HeightMap, OptimalGait, Row as HeightRow};
use nalgebra::Vector2;

use super::computed::Computed;
use crate::study::Study;

/// Nodes of the grid in each direction.
const NODES: usize = 281;

/// Displacement by area of the height map, in units of the grid's cells.
#[derive(Debug, Default, Clone, Copy)]
struct Areas {
    /// Positive heights within the bound.
    positive: f64,
    /// Positive heights that the gait encloses, in either sense and once.
    positive_inside: f64,
    /// The same of negative heights, as a positive number.
    negative_inside: f64,
}

impl Areas {
    fn of(map: &HeightMap, gait: &OptimalGait) -> Self {
        let grid = map.grid(HeightRow::X, NODES);
        let mut areas = Self::default();
        for (column, &phi_2) in grid.angles.iter().enumerate() {
            let crossings = crossings(gait.phi(), phi_2);
            for (row, &phi_1) in grid.angles.iter().enumerate() {
                let height = grid.heights[(row, column)];
                let inside = winding(&crossings, phi_1) != 0;
                areas.positive += height.max(0.0);
                if inside {
                    areas.positive_inside += height.max(0.0);
                    areas.negative_inside -= height.min(0.0);
                }
            }
        }
        areas
    }

    /// Share of positive heights in what the gait encloses.
    fn share_of_positive(&self) -> f64 {
        self.positive_inside / (self.positive_inside + self.negative_inside)
    }
}

/// φ₁ at which a closed polygon crosses this φ₂, with +1 if it rises there and −1 if it falls.
fn crossings(points: &[Vector2<f64>], phi_2: f64) -> Vec<(f64, i32)> {
    let next = points.iter().cycle().skip(1);
    let sides = points.iter().zip(next);
    let crossed = sides.filter_map(|(a, b)| {
        let sense = i32::from(b.y > phi_2) - i32::from(a.y > phi_2);
        let share = (phi_2 - a.y) / (b.y - a.y);
        (sense != 0).then(|| (a.x + share * (b.x - a.x), sense))
    });
    crossed.collect()
}

/// Number of counter-clockwise turns of a polygon about a point on the line of these crossings.
fn winding(crossings: &[(f64, i32)], phi_1: f64) -> i32 {
    let beyond = crossings.iter().filter(|(at, _)| *at > phi_1);
    beyond.map(|(_, sense)| sense).sum()
}

/// Gaits (b) and (d) on the robot's height map.
pub(super) fn enclosed_areas(study: &Study) -> Vec<Computed> {
    let [b, _, d] = &study.robot_displacement;
    let [b, d] = [b, d].map(|gait| Areas::of(&study.robot_map, gait));
    vec![
        ("area.b.positive", b.positive_inside / b.positive),
        ("area.b.negative", 1.0 - b.share_of_positive()),
        ("area.d.positive", d.share_of_positive()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_of_eight_turns_both_ways() {
        let points = [
            Vector2::new(-2.0, -1.0),
            Vector2::new(2.0, 1.0),
            Vector2::new(2.0, -1.0),
            Vector2::new(-2.0, 1.0),
        ];
        let around = |x: f64, y: f64| winding(&crossings(&points, y), x);
        assert_eq!((around(1.5, 0.1), around(-1.5, 0.1)), (-1, 1));
        assert_eq!((around(0.0, 0.5), around(3.0, 0.1)), (0, 0));
    }
}
