//! Samples of a gait, split into smooth pieces, with rules for differentiation and integration along them.

use std::ops::RangeInclusive;

use nalgebra::Vector2;
use swimmer_files::{ArcKind, GaitFile};

use super::stencil::{self, Weights};

/// Kind of a piece of the curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Along {
    /// Free arc.
    Free,
    /// Arc along a bound.
    Bound,
}

/// Smooth piece: its nodes and its kind.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub(super) nodes: RangeInclusive<usize>,
    pub(super) along: Along,
}

/// Sample within a piece; where two pieces meet there is one node for each.
#[derive(Debug, Clone)]
pub(super) struct Node {
    /// Fraction of the period.
    pub(super) u: f64,
    pub(super) along: Along,
    /// Rules for the first and second derivative by each [`Degree`].
    slope_and_bend: [[Rule; 2]; 2],
    /// Rules for the integral from the previous node by each degree; `None` for the first node of a piece.
    integral: Option<[Rule; 2]>,
}

/// Linear rule from a polynomial through neighbouring nodes.
#[derive(Debug, Clone, Copy)]
struct Rule {
    /// Node of the first weight.
    low: usize,
    weights: Weights,
}

impl Rule {
    /// Applies the rule to the values at the nodes and adds the result to a sum.
    fn added<T>(&self, sum: T, values: &[T]) -> T
    where
        T: Copy + std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T>,
    {
        let values = values.get(self.low..).unwrap_or_default();
        let terms = self.weights.iter().zip(values);
        terms.fold(sum, |sum, (&weight, &value)| sum + value * weight)
    }
}

/// Nodes, pieces and rules of a sampled cycle.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    pub(super) nodes: Vec<Node>,
    pub(super) pieces: Vec<Piece>,
}

/// Polynomial degree, as an index of the rules.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Degree {
    Fine,
    Coarse,
}

/// Distance in u below which two knots are equal.
const SAME: f64 = 1e-12;

impl Grid {
    /// Returns the grid of a gait file and the shapes at its nodes. `along` has the kind of each interval between knots.
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
        };
        let mut shapes = Vec::with_capacity(last + 2 * cut.len());
        for &[from, to] in cut.array_windows() {
            if let (Some(u), Some(phi)) = (file.u.get(from..=to), file.phi.get(from..=to)) {
                grid.append(u, along.get(from).copied().unwrap_or(Along::Free));
                shapes.extend_from_slice(phi);
            }
        }
        (grid, shapes)
    }

    fn append(&mut self, u: &[f64], along: Along) {
        let (first, count) = (self.nodes.len(), u.len());
        let windows = |from: usize, to: usize| {
            [0, stencil::FEWER].map(|fewer| stencil::around(from, to, count, fewer))
        };
        let places = |low: usize, width: usize| u.get(low..low + width).unwrap_or_default();
        let even = even_before(u);
        // For uniform samples the rules are those of the previous node, shifted by one.
        let goes_on = |i: usize| {
            let [before, here] = [i - 1, i].map(|i| (windows(i, i), windows(i - 1, i)));
            let moved = |(low, width): (usize, usize)| (low + 1, width);
            let same = before.0.map(moved) == here.0 && before.1.map(moved) == here.1;
            let (low, width) = here.1[0].min(here.0[0]);
            let high = (low + width).min(count - 1);
            same && even.get(high).is_some_and(|even| *even > high - low)
        };
        for (i, &at) in u.iter().enumerate() {
            if i > 1
                && goes_on(i)
                && let Some(before) = self.nodes.last()
            {
                let mut node = before.clone();
                node.u = at;
                let rules = node.slope_and_bend.iter_mut().flatten();
                for rule in rules.chain(node.integral.iter_mut().flatten()) {
                    rule.low += 1;
                }
                self.nodes.push(node);
                continue;
            }
            let rule = |low: usize, weights: Weights| Rule {
                low: first + low,
                weights,
            };
            let slope_and_bend = windows(i, i).map(|(low, width)| {
                let [_, slope, bend] = stencil::derivatives(places(low, width), at);
                [slope, bend].map(|weights| rule(low, weights))
            });
            let integral = i.checked_sub(1).map(|before| {
                let from = u.get(before).copied().unwrap_or(at);
                windows(before, i)
                    .map(|(low, width)| rule(low, stencil::integral(places(low, width), from, at)))
            });
            self.nodes.push(Node {
                u: at,
                along,
                slope_and_bend,
                integral,
            });
        }
        self.pieces.push(Piece {
            nodes: first..=first + count - 1,
            along,
        });
    }

    /// First derivative dΦ/du at every node.
    pub(super) fn slopes(&self, shapes: &[Vector2<f64>], degree: Degree) -> Vec<Vector2<f64>> {
        self.derived(shapes, degree, 0)
    }

    /// Second derivative d²Φ/du² at every node.
    pub(super) fn bends(&self, shapes: &[Vector2<f64>], degree: Degree) -> Vec<Vector2<f64>> {
        self.derived(shapes, degree, 1)
    }

    fn derived(&self, shapes: &[Vector2<f64>], degree: Degree, of: usize) -> Vec<Vector2<f64>> {
        let rules = self
            .nodes
            .iter()
            .map(|node| node.slope_and_bend[degree as usize][of]);
        rules
            .map(|rule| rule.added(Vector2::zeros(), shapes))
            .collect()
    }

    /// Integral from u = 0 to every node of a function with these values at the nodes.
    pub(super) fn integrals<T>(&self, values: &[T], zero: T, degree: Degree) -> Vec<T>
    where
        T: Copy + std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T>,
    {
        let mut sum = zero;
        let mut sums = Vec::with_capacity(values.len());
        for node in &self.nodes {
            if let Some(rules) = &node.integral {
                sum = rules[degree as usize].added(sum, values);
            }
            sums.push(sum);
        }
        sums
    }

    /// Previous node. Returns `None` at the start of a piece.
    pub(super) fn before(&self, node: usize) -> Option<usize> {
        self.nodes.get(node)?.integral.as_ref()?;
        node.checked_sub(1)
    }

    /// First and last node of the stencil for the interval that ends at this node.
    pub(super) fn stencil(&self, node: usize) -> Option<RangeInclusive<usize>> {
        let [Rule { low, .. }, _] = *self.nodes.get(node)?.integral.as_ref()?;
        let piece = self
            .pieces
            .iter()
            .find(|piece| piece.nodes.contains(&node))?;
        let high = (low + stencil::MOST - 1).min(*piece.nodes.end());
        Some(low..=high)
    }

    /// Fractions of the period at these nodes.
    pub(super) fn places(&self, nodes: &RangeInclusive<usize>) -> Vec<f64> {
        let nodes = self.nodes.get(nodes.clone()).unwrap_or_default();
        nodes.iter().map(|node| node.u).collect()
    }

    /// Interpolates a function with these values at the nodes at u.
    pub(super) fn interpolated(&self, values: &[f64], u: f64) -> f64 {
        let node = self.nodes.partition_point(|node| node.u < u).max(1);
        let Some(stencil) = self.stencil(node) else {
            // Boundary of two pieces.
            return values.get(node).copied().unwrap_or(f64::NAN);
        };
        let [weights] = stencil::derivatives(&self.places(&stencil), u);
        let values = values.get(stencil).unwrap_or_default();
        weights.iter().zip(values).map(|(w, v)| w * v).sum()
    }
}

/// Number of equal intervals before each point.
fn even_before(u: &[f64]) -> Vec<usize> {
    let mut even = vec![0; u.len()];
    for i in 1..u.len() {
        let (here, before) = (u[i] - u[i - 1], u[i - 1] - u[i.saturating_sub(2)]);
        even[i] = if (here - before).abs() <= 1e-9 * here {
            even[i - 1] + 1
        } else {
            1
        };
    }
    even
}

/// Index of the knot at u.
pub(super) fn knot(file: &GaitFile, u: f64) -> Option<usize> {
    let after = file.u.partition_point(|&knot| knot < u - SAME);
    (file.u.get(after)? - u).abs().le(&SAME).then_some(after)
}

/// Kind of each interval between knots, from the arcs of the file.
pub(super) fn along_arcs(file: &GaitFile) -> Vec<Along> {
    let intervals = file.u.array_windows();
    let middles = intervals.map(|&[from, to]| f64::midpoint(from, to));
    let along = |u: f64| {
        let arc = file.arcs.iter().find(|arc| arc.from <= u && u <= arc.to);
        match arc.map(|arc| arc.kind) {
            None | Some(ArcKind::Singular | ArcKind::Regular | ArcKind::Extreme) => Along::Free,
            Some(_) => Along::Bound,
        }
    };
    middles.map(along).collect()
}
