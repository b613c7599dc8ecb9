//! Check that a plan stays within its tank.

use std::sync::OnceLock;

use nalgebra::Vector2;
use swimmer_model::{Model, Pose, trajectory};

use super::Family;
use super::legs::LARGEST;
use super::member::{Member, Nets, SMALLEST};
use crate::losses::tolerance;
use crate::path::Polyline;
use crate::tank::{Tank, meets_wall, touching};

/// Samples of the body per cycle.
const SAMPLES: usize = 72;
/// Ratio of successive cycle sizes at which the swept area is computed.
const RATIO: f64 = 0.9;

/// The walls, and the swimmer between them.
pub(super) struct Walls<'a> {
    model: &'a Model<f64>,
    /// The tank without its margin. `None` if there are no walls.
    tank: Option<Tank>,
}

impl<'a> Walls<'a> {
    pub(super) fn new(model: &'a Model<f64>, tank: Option<Tank>, margin: f64) -> Self {
        let tank = tank.map(|tank| Tank {
            length: tank.length - 2.0 * margin,
            width: tank.width - 2.0 * margin,
        });
        Self { model, tank }
    }

    /// Returns true if the body in this shape and pose stays clear of the walls.
    pub(super) fn fits(&self, pose: &Pose<f64>, phi: &Vector2<f64>) -> bool {
        let touching = |tank: Tank| touching(self.model.swimmer(), &tank, pose, phi);
        self.tank.and_then(touching).is_none()
    }

    /// Returns true if links through these points and spheres around those centres stay clear of the walls.
    fn holds(&self, pose: &Pose<f64>, links: &[Vector2<f64>], spheres: &[Vector2<f64>]) -> bool {
        let Some(tank) = &self.tank else { return true };
        let (sin, cos) = pose.theta.sin_cos();
        let inside = |points: &[Vector2<f64>], radius: f64| {
            points.iter().all(|point| {
                let turned =
                    Vector2::new(cos * point.x - sin * point.y, sin * point.x + cos * point.y);
                tank.holds(&(pose.position() + turned), radius)
            })
        };
        inside(links, 0.0) && inside(spheres, self.model.swimmer().sphere_radius)
    }

    /// Returns true if the servos' path from the straight shape at this pose stays clear of the walls.
    pub(super) fn leaves_played(&self, from: &Pose<f64>, way: &Polyline) -> bool {
        let meets = |tank: Tank| meets_wall(self.model, way, &tank, from);
        self.tank.and_then(meets).is_none()
    }
}

/// Areas swept by the cycles of a family.
pub(super) struct Sweeps<'a> {
    pub(super) walls: &'a Walls<'a>,
    pub(super) nets: &'a Nets,
    pub(super) family: &'a Family,
    swept: &'a SweptAreas,
}

/// Swept areas of one family, computed on first use: kind by kind and size by size.
#[derive(Debug, Clone)]
pub(super) struct SweptAreas([Vec<OnceLock<Swept>>; 3]);

impl Default for SweptAreas {
    fn default() -> Self {
        let cells = || sizes().map(|_| OnceLock::new()).collect();
        Self([cells(), cells(), cells()])
    }
}

/// Area swept during a cycle, in the frame of its start. A tank is convex, so corners of convex hulls are enough.
#[derive(Debug, Clone)]
struct Swept {
    links: Vec<Vector2<f64>>,
    /// Convex hull of the sphere's centre.
    sphere: Vec<Vector2<f64>>,
}

impl Swept {
    fn new(model: &Model<f64>, family: &Family, member: &Member) -> Self {
        let (mut links, mut sphere) = (Vec::new(), Vec::new());
        trajectory(model, &member.of(family), &tolerance(), SAMPLES, |point| {
            let outline = model.swimmer().links.outline(&point.phi);
            links.extend(outline.map(|end| point.pose.transform(&end)));
            sphere.push(point.pose.position());
        });
        Self {
            links: hull(links),
            sphere: hull(sphere),
        }
    }
}

impl<'a> Sweeps<'a> {
    pub(super) fn new(
        walls: &'a Walls<'a>,
        nets: &'a Nets,
        family: &'a Family,
        swept: &'a SweptAreas,
    ) -> Self {
        Self {
            walls,
            nets,
            family,
            swept,
        }
    }

    /// Pose after this number of cycles. Returns `None` if they meet a wall. A cycle needs at most the space of the next larger size
    /// at which the swept area is computed.
    pub(super) fn after(
        &self,
        pose: &Pose<f64>,
        member: &Member,
        cycles: u32,
    ) -> Option<Pose<f64>> {
        let number = sizes().take_while(|size| *size >= member.scale).count();
        let all = &self.swept.0[member.kind as usize];
        let cell = all.get(number.saturating_sub(1))?;
        let swept = cell.get_or_init(|| {
            // Up to the full size.
            let power = i32::try_from(number.saturating_sub(1)).unwrap_or(0);
            let scale = if power == 0 {
                1.0
            } else {
                LARGEST * RATIO.powi(power)
            };
            Swept::new(self.walls.model, self.family, &member.kind.of_scale(scale))
        });
        let net = self.nets.of(member);
        let mut pose = *pose;
        for _ in 0..cycles {
            let next = pose * net;
            // Backwards it sweeps the area that it sweeps forwards from its end.
            let start = if member.backwards { &next } else { &pose };
            if !self.walls.holds(start, &swept.links, &swept.sphere) {
                return None;
            }
            pose = next;
        }
        Some(pose)
    }
}

/// Sizes at which the swept area is computed, from the largest.
pub(super) fn sizes() -> impl Iterator<Item = f64> {
    std::iter::successors(Some(LARGEST), |size| Some(size * RATIO))
        .take_while(|size| *size > SMALLEST)
}

/// Corners of the convex hull (Andrew's monotone chain).
fn hull(mut points: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |points: &mut dyn Iterator<Item = &Vector2<f64>>| {
        let mut corners: Vec<Vector2<f64>> = Vec::new();
        for point in points {
            while let [.., one, two] = corners[..]
                && (two - one).perp(&(point - two)) <= 0.0
            {
                corners.pop();
            }
            corners.push(*point);
        }
        corners
    };
    let mut corners = half(&mut points.iter());
    corners.extend(half(&mut points.iter().rev()));
    corners
}
