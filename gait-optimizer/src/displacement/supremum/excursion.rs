//! Ways off a polygon: slits to places that it would gain by going round, or by leaving out.

use std::collections::BTreeMap;

use swimmer_model::Pose;

use super::curve::{Ground, Mesh, Shape, along, neighbours, right, whole};
use crate::momentum::Momentum;

/// Shapes looked at lie this far apart \[rad\].
const GRID: f64 = 0.1;

/// A way off the polygon, from one of its corners.
#[derive(Debug, Clone, Copy)]
pub(super) struct Excursion {
    from: usize,
    to: Shape,
    /// For each unit of area.
    gain: f64,
}

impl Excursion {
    /// The polygon with a slit to this place, and once round it.
    pub(super) fn taken(&self, corners: &[Shape], mesh: Mesh) -> Vec<Shape> {
        const ROUND: usize = 10;
        let Some(&base) = corners.get(self.from) else {
            return corners.to_vec();
        };
        let [before, _, after] = neighbours(corners, self.from);
        let way = self.to - base;
        let out = way.normalize();
        let mut aside = right(&out);
        if aside.dot(&(after - before)) < 0.0 {
            aside = -aside;
        }
        let half = aside * (0.6 * mesh.gap);
        let radius = (2.0 * mesh.gap).max(1.2 * mesh.side);
        let straight = way.norm() - radius;
        let steps = whole(straight / mesh.side).max(1);
        let place = |k: i32| base + out * (straight * f64::from(k) / f64::from(steps));
        let mut path: Vec<Shape> = corners[..self.from].to_vec();
        path.extend((0..=steps).map(|k| place(k) - half));
        for k in 1..ROUND {
            let turn = std::f64::consts::TAU * k as f64 / ROUND as f64;
            path.push(self.to - out * (radius * turn.cos()) - aside * (radius * turn.sin()));
        }
        path.extend((0..=steps).rev().map(|k| place(k) + half));
        path.extend_from_slice(&corners[self.from + 1..]);
        path
    }
}

impl Ground<'_> {
    /// Places off the polygon which it would gain by going round, or by leaving out, seen from the nearest corner: best first.
    pub(super) fn excursions(&self, corners: &[Shape], mesh: Mesh) -> Vec<Excursion> {
        let poses = self.poses(corners);
        let Some(end) = poses.last() else {
            return Vec::new();
        };
        let momentum = Momentum::of_quarter(self.sign, end.y);
        let reach = self.region.reach();
        let mut seen = BTreeMap::new();
        for j in 0..whole(reach / GRID) {
            for i in -whole(reach / GRID)..whole(reach / GRID) {
                let phi = Shape::new(f64::from(i) + 0.5, f64::from(j) + 0.5) * GRID;
                if self.region.overstepped(&phi) <= -2.0 * mesh.gap
                    && let Some(found) = self.excursion((corners, &poses), &momentum, phi, mesh)
                {
                    seen.insert((i, j), found);
                }
            }
        }
        let around = (-1..=1).flat_map(|a| (-1..=1).map(move |b| (a, b)));
        let mut best: Vec<Excursion> = seen
            .iter()
            .filter(|((i, j), here)| {
                let mut near = around
                    .clone()
                    .filter_map(|(a, b)| seen.get(&(i + a, j + b)));
                here.gain > 0.0 && near.all(|there| there.gain <= here.gain)
            })
            .map(|(_, here)| *here)
            .collect();
        best.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        best
    }

    /// The way to a shape from the nearest corner; none where it is too short for a slit.
    fn excursion(
        &self,
        (corners, poses): (&[Shape], &[Pose<f64>]),
        momentum: &Momentum,
        to: Shape,
        mesh: Mesh,
    ) -> Option<Excursion> {
        let from = (1..corners.len() - 1).min_by(|&a, &b| {
            let [a, b] = [a, b].map(|k| (corners[k] - to).norm_squared());
            a.total_cmp(&b)
        })?;
        let way = to - corners[from];
        if way.norm() < 2.0 * mesh.side + 4.0 * mesh.gap {
            return None;
        }
        let [before, _, after] = neighbours(corners, from);
        let is_left = (after - before).perp(&way) > 0.0;
        let steps = whole(way.norm() / 0.2).max(1);
        let place = |k: i32| corners[from] + way * (f64::from(k) / f64::from(steps));
        let pose = (0..steps).fold(poses[from], |pose, k| {
            pose * along(self.model, &place(k), &place(k + 1))
        });
        let height = self.height(momentum, &to, &pose).value;
        let gain = if is_left { -height } else { height };
        Some(Excursion { from, to, gain })
    }
}
