//! Members of a family: a gait drawn towards the common shape, and what a cycle of it brings.

use nalgebra::Vector2;
use swimmer_files::AnyGait;
use swimmer_model::{Gait, GaitPoint, Model, Pose};

use super::Family;
use crate::playlist::leads_to;

/// A kind of gait.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Along the heading.
    Forward,
    /// Across it.
    Left,
    /// Round.
    Turn,
}

impl Kind {
    /// In the order of [`Family::gaits`].
    pub const ALL: [Self; 3] = [Self::Forward, Self::Left, Self::Turn];
}

/// A member of a family.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Member {
    /// Which gait.
    pub kind: Kind,
    /// Run backwards: backward, right, turning right.
    pub backwards: bool,
    /// Every shape is this share of its way from the common shape.
    pub scale: f64,
}

/// A member as a gait.
#[derive(Debug, Clone)]
pub struct Scaled {
    gait: AnyGait,
    sign: f64,
    about: Vector2<f64>,
    scale: f64,
}

impl Member {
    /// The member's cycle.
    pub fn of(&self, family: &Family) -> Scaled {
        let (gait, _) = &family.gaits[self.kind as usize];
        Scaled {
            gait: gait.clone().reversed_if(self.backwards),
            sign: family.sign(),
            about: family.shape(),
            scale: self.scale,
        }
    }

    /// In words; in a mirror left is right.
    pub(super) fn word(&self, mirrored: bool) -> &'static str {
        match (
            self.kind,
            self.backwards != (mirrored && self.kind != Kind::Forward),
        ) {
            (Kind::Forward, false) => "forward",
            (Kind::Forward, true) => "backward",
            (Kind::Left, false) => "left",
            (Kind::Left, true) => "right",
            (Kind::Turn, false) => "turn-left",
            (Kind::Turn, true) => "turn-right",
        }
    }
}

impl Gait<f64> for Scaled {
    fn at(&self, u: f64) -> GaitPoint<f64> {
        let point = self.gait.at(u);
        GaitPoint {
            phi: self.about + (point.phi * self.sign - self.about) * self.scale,
            rate: point.rate * (self.sign * self.scale),
        }
    }

    fn pieces(&self) -> usize {
        self.gait.pieces()
    }

    fn piece_end(&self, i: usize) -> f64 {
        self.gait.piece_end(i)
    }

    fn corner_at_end(&self, i: usize) -> bool {
        self.gait.corner_at_end(i)
    }
}

/// Net poses of all members, between scales by the polynomial through those at Chebyshev points: they depend on the scale
/// analytically.
#[derive(Debug)]
pub(super) struct Nets {
    scales: Vec<f64>,
    poses: [Vec<[f64; 3]>; 3],
}

/// Scales that are swum.
const POINTS: usize = 20;
/// Members are no smaller: they would hardly swim.
pub(super) const SMALLEST: f64 = 0.03;

impl Nets {
    pub(super) fn new(model: &Model<f64>, family: &Family) -> Self {
        let scale = |k: usize| {
            let angle = std::f64::consts::PI * k as f64 / (POINTS - 1) as f64;
            0.5 * (1.0 + SMALLEST) + 0.5 * (1.0 - SMALLEST) * angle.cos()
        };
        let scales: Vec<f64> = (0..POINTS).map(scale).collect();
        let of = |kind: Kind| {
            let at = |&scale: &f64| {
                let member = Member {
                    kind,
                    backwards: false,
                    scale,
                };
                let pose = leads_to(model, &member.of(family));
                [pose.x, pose.y, pose.theta]
            };
            scales.iter().map(at).collect()
        };
        Self {
            poses: Kind::ALL.map(of),
            scales,
        }
    }

    /// What a cycle of a member brings.
    pub(super) fn of(&self, member: &Member) -> Pose<f64> {
        let poses = &self.poses[member.kind as usize];
        let (mut above, mut below) = ([0.0; 3], 0.0);
        for (k, (scale, pose)) in self.scales.iter().zip(poses).enumerate() {
            let end = k == 0 || k + 1 == self.scales.len();
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            let off = member.scale - scale;
            if off.abs() < 1e-14 {
                (above, below) = (*pose, 1.0);
                break;
            }
            let weight = sign * if end { 0.5 } else { 1.0 } / off;
            for (sum, value) in above.iter_mut().zip(pose) {
                *sum += weight * value;
            }
            below += weight;
        }
        let [x, y, theta] = above.map(|sum| sum / below);
        let pose = Pose::new(x, y, theta);
        if member.backwards {
            pose.inverse()
        } else {
            pose
        }
    }
}

/// A pose so many times over.
pub(super) fn repeated(pose: &Pose<f64>, times: u32) -> Pose<f64> {
    (0..times).fold(Pose::identity(), |sum, _| sum * *pose)
}
