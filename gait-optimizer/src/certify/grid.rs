//! The samples of a gait cut into pieces within which the curve is smooth, with the rules that differentiate and integrate
//! along them.

use std::ops::RangeInclusive;

use nalgebra::Vector2;
use swimmer_files::{ArcKind, GaitFile};

use super::stencil::{self, Weights};

/// What a piece of the curve runs along.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Along {
    /// Nothing: the gait chose its way.
    Free,
    /// A bound.
    Bound,
}

/// A smooth piece: its nodes, and what it runs along.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub(super) nodes: RangeInclusive<usize>,
    pub(super) along: Along,
}

/// A sample as the end of the pieces it belongs to: where two pieces meet there is one node for each.
#[derive(Debug, Clone)]
pub(super) struct Node {
    /// Fraction of the period.
    pub(super) u: f64,
    pub(super) along: Along,
    /// First node of the stencil.
    low: usize,
    slope: Weights,
    bend: Weights,
    coarse_low: usize,
    coarse_slope: Weights,
    coarse_bend: Weights,
}

/// The stretch from a node to the next within a piece.
#[derive(Debug, Clone)]
struct Interval {
    low: usize,
    weights: Weights,
    coarse_low: usize,
    coarse: Weights,
}

/// Nodes, pieces and rules of a sampled cycle.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    pub(super) nodes: Vec<Node>,
    pub(super) pieces: Vec<Piece>,
    /// For each node but the first of a piece: the interval that ends there.
    intervals: Vec<Option<Interval>>,
}

/// Which of the two polynomials.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Degree {
    Fine,
    Coarse,
}

/// Knots this close in u are the same.
const SAME: f64 = 1e-12;

impl Grid {
    /// The grid of a gait file, and the shapes at its nodes. `along` tells of each interval between knots what it runs along.
    pub(super) fn new(file: &GaitFile, along: &[Along]) -> (Self, Vec<Vector2<f64>>) {
        let last = file.u.len().saturating_sub(1);
        let mut cut: Vec<usize> = vec![0, last];
        cut.extend(file.corners.iter().filter_map(|&u| knot(file, u)));
        cut.extend(
            file.arcs
                .iter()
                .flat_map(|arc| [arc.from, arc.to])
                .filter_map(|u| knot(file, u)),
        );
        cut.extend((1..last).filter(|&knot| along.get(knot - 1) != along.get(knot)));
        cut.sort_unstable();
        cut.dedup();
        let mut grid = Self {
            nodes: Vec::with_capacity(last + 2 * cut.len()),
            pieces: Vec::with_capacity(cut.len()),
            intervals: Vec::with_capacity(last + 2 * cut.len()),
        };
        let mut shapes = Vec::with_capacity(last + 2 * cut.len());
        for pair in cut.windows(2) {
            if let [from, to] = *pair
                && let (Some(u), Some(phi)) = (file.u.get(from..=to), file.phi.get(from..=to))
            {
                grid.append(u, along.get(from).copied().unwrap_or(Along::Free));
                shapes.extend_from_slice(phi);
            }
        }
        (grid, shapes)
    }

    fn append(&mut self, u: &[f64], along: Along) {
        let (first, count) = (self.nodes.len(), u.len());
        let places = |(low, width): (usize, usize)| u.get(low..low + width).unwrap_or_default();
        for (i, &at) in u.iter().enumerate() {
            let fine = stencil::around(i, i, count);
            let coarse = stencil::coarsely_around(i, i, count);
            let [_, slope, bend] = stencil::derivatives(places(fine), at);
            let [_, coarse_slope, coarse_bend] = stencil::derivatives(places(coarse), at);
            self.nodes.push(Node {
                u: at,
                along,
                low: first + fine.0,
                slope,
                bend,
                coarse_low: first + coarse.0,
                coarse_slope,
                coarse_bend,
            });
            self.intervals.push(i.checked_sub(1).map(|before| {
                let from = u.get(before).copied().unwrap_or(at);
                let fine = stencil::around(before, i, count);
                let coarse = stencil::coarsely_around(before, i, count);
                Interval {
                    low: first + fine.0,
                    weights: stencil::integral(places(fine), from, at),
                    coarse_low: first + coarse.0,
                    coarse: stencil::integral(places(coarse), from, at),
                }
            }));
        }
        self.pieces.push(Piece {
            nodes: first..=first + count - 1,
            along,
        });
    }

    /// Slope dΦ/du at every node.
    pub(super) fn slopes(&self, shapes: &[Vector2<f64>], degree: Degree) -> Vec<Vector2<f64>> {
        let slope = |node: &Node| match degree {
            Degree::Fine => weigh(&node.slope, shapes, node.low),
            Degree::Coarse => weigh(&node.coarse_slope, shapes, node.coarse_low),
        };
        self.nodes.iter().map(slope).collect()
    }

    /// Bend d²Φ/du² at every node.
    pub(super) fn bends(&self, shapes: &[Vector2<f64>], degree: Degree) -> Vec<Vector2<f64>> {
        let bend = |node: &Node| match degree {
            Degree::Fine => weigh(&node.bend, shapes, node.low),
            Degree::Coarse => weigh(&node.coarse_bend, shapes, node.coarse_low),
        };
        self.nodes.iter().map(bend).collect()
    }

    /// Integral from u = 0 to every node of what has these values at the nodes.
    pub(super) fn integrals<T>(&self, values: &[T], zero: T, degree: Degree) -> Vec<T>
    where
        T: Copy + std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T>,
    {
        let mut sum = zero;
        let mut sums = Vec::with_capacity(values.len());
        for interval in &self.intervals {
            if let Some(interval) = interval {
                let (weights, low) = interval.by(degree);
                let values = values.get(low..).unwrap_or_default();
                sum = weights
                    .iter()
                    .zip(values)
                    .fold(sum, |sum, (&weight, &value)| sum + value * weight);
            }
            sums.push(sum);
        }
        sums
    }

    /// What each node counts for in an integral round the whole cycle.
    pub(super) fn weights(&self, degree: Degree) -> Vec<f64> {
        let mut sums = vec![0.0; self.nodes.len()];
        for interval in self.intervals.iter().flatten() {
            let (weights, low) = interval.by(degree);
            for (sum, weight) in sums.iter_mut().skip(low).zip(weights) {
                *sum += weight;
            }
        }
        sums
    }

    /// The node before this one, where it belongs to the same piece.
    pub(super) fn before(&self, node: usize) -> Option<usize> {
        self.intervals.get(node)?.as_ref()?;
        node.checked_sub(1)
    }

    /// First and last node of the stencil for the stretch that ends at this node.
    pub(super) fn stencil(&self, node: usize) -> Option<RangeInclusive<usize>> {
        let interval = self.intervals.get(node)?.as_ref()?;
        let piece = self
            .pieces
            .iter()
            .find(|piece| piece.nodes.contains(&node))?;
        let high = (interval.low + stencil::MOST - 1).min(*piece.nodes.end());
        Some(interval.low..=high)
    }

    /// Fractions of the period at these nodes.
    pub(super) fn places(&self, nodes: &RangeInclusive<usize>) -> Vec<f64> {
        let nodes = self.nodes.get(nodes.clone()).unwrap_or_default();
        nodes.iter().map(|node| node.u).collect()
    }

    /// What has these values at the nodes, at u.
    pub(super) fn interpolated(&self, values: &[f64], u: f64) -> f64 {
        let node = self.nodes.partition_point(|node| node.u < u).max(1);
        let Some(stencil) = self.stencil(node) else {
            // Two pieces meet here.
            return values.get(node).copied().unwrap_or(f64::NAN);
        };
        let [weights] = stencil::derivatives(&self.places(&stencil), u);
        let values = values.get(stencil).unwrap_or_default();
        weights.iter().zip(values).map(|(w, v)| w * v).sum()
    }
}

impl Interval {
    /// Weights, and the node of the first.
    fn by(&self, degree: Degree) -> (&Weights, usize) {
        match degree {
            Degree::Fine => (&self.weights, self.low),
            Degree::Coarse => (&self.coarse, self.coarse_low),
        }
    }
}

fn weigh(weights: &Weights, values: &[Vector2<f64>], low: usize) -> Vector2<f64> {
    let values = values.get(low..).unwrap_or_default();
    weights
        .iter()
        .zip(values)
        .fold(Vector2::zeros(), |sum, (&weight, value)| {
            sum + value * weight
        })
}

/// The knot at u.
fn knot(file: &GaitFile, u: f64) -> Option<usize> {
    let after = file.u.partition_point(|&knot| knot < u - SAME);
    (file.u.get(after)? - u).abs().le(&SAME).then_some(after)
}

/// What each interval between knots runs along, as the file's arcs tell.
pub(super) fn told_by_arcs(file: &GaitFile) -> Vec<Along> {
    let middles = file.u.windows(2).map(|pair| match *pair {
        [from, to] => f64::midpoint(from, to),
        _ => 0.0,
    });
    let along = |u: f64| {
        let arc = file.arcs.iter().find(|arc| arc.from <= u && u <= arc.to);
        match arc.map(|arc| arc.kind) {
            None | Some(ArcKind::Singular | ArcKind::Regular | ArcKind::Extreme) => Along::Free,
            Some(_) => Along::Bound,
        }
    };
    middles.map(along).collect()
}
