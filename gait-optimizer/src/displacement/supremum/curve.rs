//! A quarter as a polygon that climbs on what it carries and never touches itself.
//!
//! Each corner moves along its normal as the height says, so the polygon comes to rest where the height vanishes, where a bound
//! is in its way or where it would meet itself: strands that press against each other are held a gap apart, and move as their
//! heights pull them together. Polygons that come to rest at a smaller gap carry farther.

use nalgebra::Vector2;
use swimmer_model::{Model, Pose};

use crate::certificate::crossings;
use crate::displacement::DisplacementProblem;
use crate::momentum::{Height, Momentum};
use crate::region::{Bound, Region};

pub(super) type Shape = Vector2<f64>;

/// What a polygon climbs on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ground<'a> {
    /// The swimmer with L = 1.
    pub(super) model: &'a Model<f64>,
    /// With the sector's sides among its bounds: a quarter stays between its images.
    pub(super) region: &'a Region,
    /// 1 for X > 0, −1 for X < 0.
    pub(super) sign: f64,
}

/// How fine a polygon is \[rad\].
#[derive(Debug, Clone, Copy)]
pub(super) struct Mesh {
    /// Between strands that would touch.
    pub(super) gap: f64,
    /// About the length of a side.
    pub(super) side: f64,
}

/// Longest move of a corner, as a share of the gap: strands must not pass through each other.
const STRIDE: f64 = 0.3;
/// Moves between two looks for strands that are near.
const LOOK: usize = 3;
/// Rounds of bounds and gaps after each move.
const SWEEPS: usize = 4;
/// Strands nearer than this share of the gap are about to pass through each other.
const TOO_NEAR: f64 = 0.02;
/// Corners farther beyond a bound than this share of the gap go through it.
const ASTRAY: f64 = 0.25;
/// Looks after which a start's own strands have come apart.
const SETTLED: usize = 10;
/// Strands are parts of the polygon this many gaps apart along it.
const TIP: f64 = 4.0;
/// Moves between two looks at what is carried, and its least growth.
const WATCH: usize = 7;
const GROWTH: f64 = 1e-7;

/// The pose that a straight side brings: one Magnus step of order four.
pub(super) fn along(model: &Model<f64>, from: &Shape, to: &Shape) -> Pose<f64> {
    let (way, half_gap) = (to - from, 3.0_f64.sqrt() / 6.0);
    let velocity = |s: f64| model.local_connection(&(from + way * s)) * way;
    let (a, b) = (velocity(0.5 - half_gap), velocity(0.5 + half_gap));
    let bracket = nalgebra::Vector3::new(b.z * a.y - a.z * b.y, a.z * b.x - b.z * a.x, 0.0);
    Pose::exp(&((a + b) * 0.5 + bracket * (0.5 * half_gap)))
}

/// To the right of a direction.
pub(super) fn right(way: &Shape) -> Shape {
    Shape::new(way.y, -way.x)
}

impl<'a> Ground<'a> {
    pub(super) fn new(
        problem: &DisplacementProblem,
        model: &'a Model<f64>,
        region: &'a Region,
    ) -> Self {
        Self {
            model,
            region,
            sign: problem.heading().sign(),
        }
    }

    /// Poses at all corners.
    pub(super) fn poses(&self, corners: &[Shape]) -> Vec<Pose<f64>> {
        let mut pose = Pose::identity();
        let mut poses = vec![pose];
        for [from, to] in corners.array_windows() {
            pose = pose * along(self.model, from, to);
            poses.push(pose);
        }
        poses
    }

    /// X over L of the whole cycle, positive the way asked for.
    pub(super) fn carried(&self, corners: &[Shape]) -> f64 {
        let poses = self.poses(corners);
        poses.last().map_or(0.0, |end| 4.0 * self.sign * end.x)
    }

    pub(super) fn height(&self, momentum: &Momentum, phi: &Shape, pose: &Pose<f64>) -> Height {
        momentum
            .evaluate(self.model, phi, &[pose.x, pose.y, pose.theta])
            .0
    }

    /// Climbs from a polygon until what it carries grows no more, in at most so many moves; the best one met within the bounds, and
    /// what it carries; the start and 0 of none.
    pub(super) fn climbed(
        &self,
        corners: &[Shape],
        mesh: Mesh,
        most_moves: usize,
    ) -> (Vec<Shape>, f64) {
        let mut here = corners.to_vec();
        let mut inside = self.allows(&here);
        let mut best = (here.clone(), 0.0);
        if self.is_member(&here, mesh) {
            best.1 = self.carried(&here).max(0.0);
        }
        remesh(&mut here, mesh);
        let (mut sound, mut stride) = (here.clone(), STRIDE);
        let mut near = strands(&here, mesh.gap);
        for look in 0..most_moves / LOOK {
            for _ in 0..LOOK {
                self.climb(&mut here, stride * mesh.gap);
                for _ in 0..SWEEPS {
                    let free = self.mobilities(&here);
                    keep_apart(&mut here, &near, mesh.gap, &free);
                    self.confine(&mut here);
                }
            }
            remesh(&mut here, mesh);
            near = strands(&here, mesh.gap);
            let too_near = look > SETTLED && nearest(&here, &near) < TOO_NEAR * mesh.gap;
            let strayed = inside && self.overstepped(&here) > ASTRAY * mesh.gap;
            if too_near || strayed || crossings(&here) > 0 {
                // A strand went through another, or through a bound.
                stride *= 0.5;
                here.clone_from(&sound);
                near = strands(&here, mesh.gap);
                if stride < 1e-2 * STRIDE {
                    break;
                }
                continue;
            }
            inside = inside || self.allows(&here);
            sound.clone_from(&here);
            stride = (1.1 * stride).min(STRIDE);
            if look % WATCH == WATCH - 1 {
                let carried = self.carried(&here);
                let grown = carried - best.1;
                if grown > 0.0 && self.allows(&here) {
                    best = (here.clone(), carried);
                }
                if grown < GROWTH * carried.abs() {
                    break;
                }
            }
        }
        best
    }

    /// One move.
    fn climb(&self, corners: &mut [Shape], longest: f64) {
        let poses = self.poses(corners);
        let Some(end) = poses.last() else { return };
        let momentum = Momentum::of_quarter(self.sign, end.y);
        let heights: Vec<Height> = corners
            .iter()
            .zip(&poses)
            .map(|(phi, pose)| self.height(&momentum, phi, pose))
            .collect();
        let steepest = heights
            .iter()
            .map(|height| height.gradient.norm())
            .fold(1e-9, f64::max);
        let moves: Vec<Shape> = (0..corners.len())
            .map(|at| {
                let [before, here, after] = neighbours(corners, at);
                let lengths = (here - before).norm() + (after - here).norm();
                let push = right(&(after - before)) / lengths.max(1e-12);
                let step = push * (heights[at].value / steepest);
                step * (longest / step.norm().max(1e-300)).min(1.0)
            })
            .collect();
        for (corner, step) in corners.iter_mut().zip(moves) {
            *corner += step;
        }
    }

    /// How freely each corner gives way to another strand: hardly where it lies on a bound.
    fn mobilities(&self, corners: &[Shape]) -> Vec<f64> {
        corners
            .iter()
            .map(|phi| {
                if self.region.overstepped(phi) > -1e-6 {
                    1e-2
                } else {
                    1.0
                }
            })
            .collect()
    }

    /// Back within the bounds, the ends on the diagonals.
    fn confine(&self, corners: &mut [Shape]) {
        if let Some(first) = corners.first_mut() {
            *first = Shape::repeat(0.5 * (first.x + first.y));
        }
        if let Some(last) = corners.last_mut() {
            let m = 0.5 * (last.y - last.x);
            *last = Shape::new(-m, m);
        }
        for bound in self.region.bounds() {
            for corner in corners.iter_mut() {
                if bound.margin(corner) < 0.0 {
                    *corner = bound.onto(corner);
                }
            }
            // A side between two shapes on the curved bound would cut across it.
            if matches!(bound, Bound::Clearance(_)) {
                for at in 1..corners.len() {
                    let middle = (corners[at - 1] + corners[at]) * 0.5;
                    if bound.margin(&middle) < 0.0 {
                        let back = bound.onto(&middle) - middle;
                        corners[at - 1] += back;
                        corners[at] += back;
                    }
                }
            }
        }
    }

    /// Whether a polygon is a gait's quarter: within the bounds, and strictly simple but for what runs along a bound.
    pub(super) fn is_member(&self, corners: &[Shape], mesh: Mesh) -> bool {
        let near = strands(corners, mesh.gap);
        self.allows(corners)
            && crossings(corners) == 0
            && nearest(corners, &near) > TOO_NEAR * mesh.gap
    }

    /// Whether no corner and no middle of a side oversteps a bound.
    fn allows(&self, corners: &[Shape]) -> bool {
        const SLACK: f64 = 1e-9;
        self.overstepped(corners) < SLACK
    }

    /// The most that a corner or a middle of a side oversteps a bound.
    fn overstepped(&self, corners: &[Shape]) -> f64 {
        let middles = corners.array_windows().map(|[a, b]| (a + b) * 0.5);
        let places = corners.iter().copied().chain(middles);
        let overstepped = places.map(|phi| self.region.overstepped(&phi));
        overstepped.fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Rounded up.
#[expect(
    clippy::cast_possible_truncation,
    reason = "a few hundred sides or shapes at most"
)]
pub(super) fn whole(count: f64) -> i32 {
    count.ceil() as i32
}

/// A corner between its neighbours; at the ends one of them is an image.
pub(super) fn neighbours(corners: &[Shape], at: usize) -> [Shape; 3] {
    let here = corners[at];
    let before = if at > 0 {
        corners[at - 1]
    } else {
        Shape::new(corners[1].y, corners[1].x)
    };
    let after = if at + 1 < corners.len() {
        corners[at + 1]
    } else {
        Shape::new(-before.y, -before.x)
    };
    [before, here, after]
}

/// Splits long sides and takes corners away that are not needed.
fn remesh(corners: &mut Vec<Shape>, mesh: Mesh) {
    let mut kept: Vec<Shape> = Vec::with_capacity(corners.len() + 16);
    for at in 0..corners.len() {
        let here = corners[at];
        if at > 0 && at + 1 < corners.len() {
            let (before, after) = (kept[kept.len() - 1], corners[at + 1]);
            let (a, b) = ((here - before).norm(), (after - here).norm());
            let chord = after - before;
            let off = chord.perp(&(here - before)).abs() / chord.norm().max(1e-12);
            let straight = (here - before).dot(&(after - here)) > 0.0;
            if a + b < 1.2 * mesh.side && straight && off < 0.1 * mesh.gap
                || a.min(b) < 0.1 * mesh.gap
            {
                continue;
            }
        }
        if let Some(before) = kept.last().copied() {
            let parts = whole((here - before).norm() / (1.4 * mesh.side)).max(1);
            kept.extend(
                (1..parts).map(|k| before + (here - before) * (f64::from(k) / f64::from(parts))),
            );
        }
        kept.push(here);
    }
    uncurl(&mut kept);
    *corners = kept;
}

/// Cuts off small loops, which would grow to a second way round.
fn uncurl(corners: &mut Vec<Shape>) {
    /// Sides that a small loop may have.
    const MOST: usize = 8;
    let mut at = 0;
    while at + 3 < corners.len() {
        let last = (at + MOST).min(corners.len() - 2);
        let met = (at + 2..=last).rev().find_map(|other| {
            let ways = [at, other].map(|k| [corners[k], corners[k + 1]]);
            Some((other, crossing(&ways)?))
        });
        if let Some((other, place)) = met {
            corners.splice(at + 1..=other, [place]);
        }
        at += 1;
    }
}

/// Where two segments cross.
fn crossing([[a, b], [c, d]]: &[[Shape; 2]; 2]) -> Option<Shape> {
    let (along, other, between) = (b - a, d - c, c - a);
    let across = along.perp(&other);
    let (s, t) = (between.perp(&other) / across, between.perp(&along) / across);
    let inside = |share: f64| share > 0.0 && share < 1.0;
    (inside(s) && inside(t)).then(|| a + along * s)
}

/// Corners and sides that may come too near before the next look.
fn strands(corners: &[Shape], gap: f64) -> Vec<(usize, usize)> {
    let reach = gap * (1.0 + 2.0 * STRIDE * LOOK as f64 + 0.5);
    let mut way = vec![0.0];
    for [from, to] in corners.array_windows() {
        way.push(way[way.len() - 1] + (to - from).norm());
    }
    let mut near = Vec::new();
    for side in 0..corners.len().saturating_sub(1) {
        let (from, to) = (corners[side], corners[side + 1]);
        let (low, high) = (from.inf(&to), from.sup(&to));
        for (at, phi) in corners.iter().enumerate() {
            let apart = (way[side] - way[at]).max(way[at] - way[side + 1]);
            if apart > TIP * gap
                && phi.x > low.x - reach
                && phi.x < high.x + reach
                && phi.y > low.y - reach
                && phi.y < high.y + reach
            {
                near.push((at, side));
            }
        }
    }
    near
}

/// From a corner to the nearest place on a side.
fn apart(corners: &[Shape], at: usize, side: usize) -> (Shape, f64) {
    let (phi, from, to) = (corners[at], corners[side], corners[side + 1]);
    let along = to - from;
    let share = ((phi - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
    (phi - (from + along * share), share)
}

fn nearest(corners: &[Shape], near: &[(usize, usize)]) -> f64 {
    near.iter()
        .map(|&(at, side)| apart(corners, at, side).0.norm())
        .fold(f64::INFINITY, f64::min)
}

/// Pushes corners and sides that are too near away from each other.
fn keep_apart(corners: &mut [Shape], near: &[(usize, usize)], gap: f64, free: &[f64]) {
    for &(at, side) in near {
        let (away, share) = apart(corners, at, side);
        let distance = away.norm();
        if distance >= gap || distance <= 0.0 {
            continue;
        }
        let (from, to) = (free[side] * (1.0 - share), free[side + 1] * share);
        let push = away * ((gap / distance - 1.0) / (free[at] + from * (1.0 - share) + to * share));
        corners[at] += push * free[at];
        corners[side] -= push * from;
        corners[side + 1] -= push * to;
    }
}
