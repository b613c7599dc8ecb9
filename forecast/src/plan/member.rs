//! Members of a family: a gait scaled towards the common shape, and the net pose of its cycle.

use gait_player::table::TableError;
use nalgebra::Vector2;
use swimmer_files::AnyGait;
use swimmer_model::{Gait, GaitPoint, Model, Pose, wrapped_angle};

use super::legs::power;
use super::{Family, Step};
use crate::losses::Servos;
use crate::playlist::{leads_to, played, step_period, tables};

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

    /// Run forwards, at this scale.
    pub(super) fn of_scale(self, scale: f64) -> Member {
        Member {
            kind: self,
            backwards: false,
            scale,
        }
    }
}

/// A member of a family.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Member {
    /// Gait of the family.
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

    /// Name of the motion: `forward`, `backward`, `left`, `right`, `turn-left` or `turn-right`. In a mirror left is right.
    pub fn word(&self, mirrored: bool) -> &'static str {
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

/// Net poses of all members as the servos play them, between scales by the polynomial through those at Chebyshev points: what a
/// gait brings depends on its scale analytically, and what tables and dead bands take of it hardly less smoothly. And how long their
/// cycles take.
#[derive(Debug, Clone)]
pub(super) struct Nets {
    scales: Vec<f64>,
    poses: [Vec<[f64; 3]>; 3],
    /// Of the gaits of the family \[s\].
    periods: [f64; 3],
    /// Of the servos \[rad/s\].
    max_rate: f64,
    /// Factors on the motion of each kind, along its screw; 1 as predicted.
    pub(super) gains: [f64; 3],
}

/// Scales that are swum.
const POINTS: usize = 20;
/// Members are no smaller: they would hardly swim.
pub(super) const SMALLEST: f64 = 0.03;

impl Nets {
    /// # Errors
    /// [`TableError`]: an angle that does not fit.
    pub(super) fn new(
        model: &Model<f64>,
        family: &Family,
        servos: &Servos,
    ) -> Result<Self, TableError> {
        let scale = |k: usize| {
            let angle = std::f64::consts::PI * k as f64 / (POINTS - 1) as f64;
            0.5 * (1.0 + SMALLEST) + 0.5 * (1.0 - SMALLEST) * angle.cos()
        };
        let way_in = family.way_in(model);
        let unswum = Self {
            scales: (0..POINTS).map(scale).collect(),
            poses: Default::default(),
            periods: family.gaits.each_ref().map(|(_, period)| *period),
            max_rate: servos.file.max_rate,
            gains: [1.0; 3],
        };
        let of = |kind: Kind| {
            let at = |&scale: &f64| {
                let after = |cycles| {
                    let step = unswum.step(kind.of_scale(scale), cycles);
                    let tables = tables(&[step.repeated(family)])?;
                    Ok(leads_to(model, &played(&tables, servos)) * way_in)
                };
                // The first cycle takes up the dead band: what a second one adds.
                let pose = after(1)?.inverse() * after(2)?;
                Ok([pose.x, pose.y, pose.theta])
            };
            unswum.scales.iter().map(at).collect::<Result<Vec<_>, _>>()
        };
        Ok(Self {
            poses: [of(Kind::Forward)?, of(Kind::Left)?, of(Kind::Turn)?],
            ..unswum
        })
    }

    /// So many cycles at the servos' full rate.
    pub(super) fn step(&self, member: Member, cycles: u32) -> Step {
        let period = self.periods[member.kind as usize] * member.scale;
        Step {
            member,
            cycles,
            period: step_period(period, self.max_rate),
        }
    }

    /// The same in a mirror along the body.
    #[must_use]
    pub(super) fn mirror(&self) -> Self {
        let poses = self.poses.each_ref().map(|poses| {
            let poses = poses.iter();
            poses.map(|[x, y, theta]| [*x, -y, -theta]).collect()
        });
        Self {
            scales: self.scales.clone(),
            poses,
            ..*self
        }
    }

    /// Approximate lower bound of the duration \[s\] of a chain with this net pose.
    pub(super) fn least(&self, wanted: &Pose<f64>) -> f64 {
        let (mut speed, mut rate) = (0.0_f64, 0.0_f64);
        for (kind, period) in Kind::ALL.into_iter().zip(self.periods) {
            let net = self.of(&kind.of_scale(1.0));
            speed = speed.max(net.position().norm() / period);
            rate = rate.max(net.theta.abs() / period);
        }
        let turned = wrapped_angle(wanted.theta).abs() / rate;
        turned.max(wanted.position().norm() / speed)
    }

    /// Scale at which a cycle has this share of the full-size cycle's net motion, projected on the latter.
    pub(super) fn scale(&self, kind: Kind, share: f64) -> f64 {
        let (mut below, mut above) = (SMALLEST, 1.0);
        for _ in 0..24 {
            let middle = 0.5 * (below + above);
            if self.share(&kind.of_scale(middle)) < share {
                below = middle;
            } else {
                above = middle;
            }
        }
        above
    }

    /// Share of the full-size cycle's net motion in that of this member's cycle, projected on the former.
    pub(super) fn share(&self, member: &Member) -> f64 {
        let [full, here] = [1.0, member.scale].map(|scale| self.of(&member.kind.of_scale(scale)));
        match member.kind {
            Kind::Turn => here.theta / full.theta,
            Kind::Forward | Kind::Left => {
                here.position().dot(&full.position()) / full.position().norm_squared()
            }
        }
    }

    /// Net pose of some steps.
    pub(super) fn after(&self, steps: &[Step]) -> Pose<f64> {
        steps.iter().fold(Pose::identity(), |pose, step| {
            pose * repeated(&self.of(&step.member), step.cycles)
        })
    }

    /// Net pose of a member's cycle.
    pub(super) fn of(&self, member: &Member) -> Pose<f64> {
        self.at_gain(member, self.gains[member.kind as usize])
    }

    /// The same at another gain.
    pub(super) fn at_gain(&self, member: &Member, gain: f64) -> Pose<f64> {
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
        let pose = power(&Pose::new(x, y, theta), gain);
        if member.backwards {
            pose.inverse()
        } else {
            pose
        }
    }
}

/// A pose to the power `times`.
pub(super) fn repeated(pose: &Pose<f64>, times: u32) -> Pose<f64> {
    (0..times).fold(Pose::identity(), |sum, _| sum * *pose)
}
