//! Active bounds at the nodes of a gait: the bound of each arc, its side, and kinks at corners of the bounds.

use nalgebra::Vector2;

use super::Subject;
use super::limits::Limit;
use crate::certificate::Condition;

/// Distance from the curve at which the two sides of a bound are distinguished \[rad\].
const ASIDE: f64 = 1e-6;

impl Subject<'_> {
    /// All bounds at a node.
    pub(super) fn limits_at(&self, node: usize) -> Vec<Limit> {
        self.limits(&self.shapes.get(node).copied().unwrap_or_default(), node)
    }

    /// All bounds at a shape near a node.
    fn limits(&self, shape: &Vector2<f64>, node: usize) -> Vec<Limit> {
        Limit::all(&self.region, shape, self.quarter(node))
    }

    /// Quarter of the cycle that contains a node; where two meet, that of the node's piece.
    pub(super) fn quarter(&self, node: usize) -> usize {
        let u = |node: usize| self.grid.nodes.get(node).map_or(0.0, |node| node.u);
        let beside = if self.grid.before(node).is_some() {
            node - 1
        } else {
            node + 1
        };
        let inside = f64::midpoint(u(node), u(beside));
        (0..3)
            .find(|&quarter| inside < 0.25 * (quarter + 1) as f64)
            .unwrap_or(3)
    }

    /// Active bound at a node of a bound arc: near, and tangent to the motion, with its index among the bounds.
    pub(super) fn bound_followed(&self, node: usize) -> Option<(usize, Limit)> {
        let rate = self.path.places.get(node)?.rate;
        // At a corner between two bounds the normal may be that of the other one; a more distant bound is still not active.
        let askew = |limit: &Limit| {
            let far = if limit.margin.abs() > Condition::OnClearance.tolerance() + self.written {
                1.0 + limit.margin.abs()
            } else {
                0.0
            };
            far + (limit.normal.dot(&rate) / rate.norm()).abs()
        };
        let limits = self.limits_at(node).into_iter().enumerate();
        limits.min_by(|(_, a), (_, b)| askew(a).total_cmp(&askew(b)))
    }

    /// Side of the motion on which the active bound of an arc is: 1 for the right, −1 for the left. At the end of an arc the bound may
    /// have a corner, so the neighbouring node is evaluated.
    pub(super) fn bound_side(&self, node: usize) -> Option<f64> {
        let inside = if self.grid.before(node).is_none() {
            node + 1
        } else if self.grid.before(node + 1).is_none() {
            node - 1
        } else {
            node
        };
        // Exactly on the clearance bound the direction of its slope depends on rounding, so both sides are evaluated.
        let place = self.path.places.get(inside)?;
        let right = place.right() * ASIDE;
        let (bound, _) = self.bound_followed(inside)?;
        let margin = |shape: Vector2<f64>| {
            let limits = self.limits(&shape, inside);
            limits.get(bound).map(|limit| limit.margin)
        };
        let (on_right, on_left) = (margin(place.phi + right)?, margin(place.phi - right)?);
        Some(if on_right < on_left { 1.0 } else { -1.0 })
    }

    /// Returns `true` if the curve bends around a corner of the forbidden shapes between these nodes, the end of a piece and the start
    /// of the next. Like a string around an edge it may have a kink there, towards the corner.
    pub(super) fn bent_round_a_corner(&self, end: usize, start: usize) -> bool {
        const BESIDE: f64 = 1e-5;
        let (Some(before), Some(after)) = (self.path.places.get(end), self.path.places.get(start))
        else {
            return false;
        };
        let (into, out) = (before.rate.normalize(), after.rate.normalize());
        let curved = |shape: Vector2<f64>, node: usize| {
            let limits = self.limits(&shape, node);
            limits.into_iter().find(|limit| limit.curved)
        };
        let (Some(here), Some(first), Some(second)) = (
            curved(before.phi, end),
            curved(before.phi - into * BESIDE, end),
            curved(after.phi + out * BESIDE, start),
        ) else {
            return false;
        };
        let corner = first.normal.perp(&second.normal).abs() > 1e-3;
        let towards = (out - into) * BESIDE;
        let inside = curved(before.phi + towards, end);
        here.margin.abs() <= Condition::OnClearance.tolerance() + self.written
            && corner
            && inside.is_some_and(|limit| limit.margin < 0.0)
    }
}
