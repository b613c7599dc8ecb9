//! A cycle and an image of it, one after the other: where a heading is prescribed that the fastest cycle has not, the two may tack,
//! leading to either side of it in turn.

use nalgebra::Vector2;

use super::interior::Polygon;
use super::problem::SpeedProblem;
use super::selection::rough_groups;
use super::setting::{GaitRequirements, HeadingRule, Setting};
use super::starts::{IMAGES, start};

/// Starts that lead to cycles of any heading, and how many different ones of those are paired.
const STARTS: usize = 64;
const CYCLES: usize = 12;

/// Closed polygons of pairs of the fastest cycles of any heading.
pub(super) fn pairs(problem: &SpeedProblem, setting: &Setting) -> Vec<Vec<Vector2<f64>>> {
    let any = Setting {
        asked: GaitRequirements {
            heading: HeadingRule::Any,
            ..setting.asked
        },
        ..setting.clone()
    };
    let starts =
        (0..STARTS.min(problem.starts)).map(|index| start(setting.region, problem.seed, index));
    let starts: Vec<_> = starts.collect();
    let groups = rough_groups(&any, &starts, problem.threads, &|_| ());
    let cycles = groups
        .iter()
        .take(CYCLES)
        .filter_map(|group| group.chosen.first());
    cycles.flat_map(pairs_of).collect()
}

/// A cycle with each of its images, run either way.
fn pairs_of(cycle: &Polygon) -> Vec<Vec<Vector2<f64>>> {
    let corners: Vec<Vector2<f64>> = (0..cycle.layout.arcs())
        .map(|corner| cycle.layout.corner(&cycle.z, corner))
        .collect();
    let mut all = Vec::with_capacity(2 * IMAGES.len());
    for image in IMAGES {
        let mut other: Vec<Vector2<f64>> = corners.iter().map(image).collect();
        all.push(joined(&corners, &other));
        other.reverse();
        all.push(joined(&corners, &other));
    }
    all
}

/// Two polygons, one after the other, from where they are nearest to each other.
fn joined(one: &[Vector2<f64>], other: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let mut nearest = (f64::INFINITY, 0, 0);
    for (i, a) in one.iter().enumerate() {
        for (j, b) in other.iter().enumerate() {
            let off = (a - b).norm();
            if off < nearest.0 {
                nearest = (off, i, j);
            }
        }
    }
    let (_, i, j) = nearest;
    [&one[i..], &one[..i], &other[j..], &other[..j]].concat()
}
