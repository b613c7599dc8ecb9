//! A side link's angle from the points of one row after the other.

use nalgebra::Vector2;
use swimmer_model::{Pose, wrapped_angle};

use crate::poses::End;

/// Largest error of a point's distance to the joint, as a share of the reflector's.
const DISTANCE: f64 = 0.1;
/// Largest turn from one row to the next \[rad\], and how fast a link may turn over a gap \[rad/s\].
const STEP: f64 = 0.3;
const SPEED: f64 = 6.0;

/// A point in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SideSighting {
    /// It goes by the reflector's name; a hint.
    pub named: bool,
    /// Its place \[m\].
    pub place: Vector2<f64>,
}

/// Follows the reflector of a side link, by its distance from the joint and by what goes on from the last row.
#[derive(Debug, Clone)]
pub struct SideFollower {
    end: End,
    half: f64,
    at: [f64; 2],
    has_name: bool,
    last: Option<Last>,
}

#[derive(Debug, Clone, Copy)]
struct Last {
    time_s: f64,
    angle: f64,
}

/// The joint angle by a point.
#[derive(Debug, Clone, Copy)]
struct PointAngle {
    named: bool,
    angle: f64,
}

impl SideFollower {
    /// For the side link at this end of a middle link of half length `half` \[m\], with a reflector at `at` \[m\], from the joint
    /// outwards and to the left. `has_name`: some points may go by its name.
    pub fn new(end: End, half: f64, at: [f64; 2], has_name: bool) -> Self {
        Self {
            end,
            half,
            at,
            has_name,
            last: None,
        }
    }

    /// Takes the points of a row in which the middle link has this pose. Returns the joint angle \[rad\] that goes on from the last
    /// one, unwrapped; `None` if no point shows it.
    pub fn push(&mut self, time_s: f64, pose: &Pose<f64>, points: &[SideSighting]) -> Option<f64> {
        let shown = points.iter().filter_map(|point| {
            Some(PointAngle {
                named: point.named,
                angle: self.angle(pose, point.place)?,
            })
        });
        let shown: Vec<PointAngle> = shown.collect();
        let angle = self.goes_on(&shown, time_s)?;
        self.last = Some(Last { time_s, angle });
        Some(angle)
    }

    /// The link's angle by a point at this place, if it is as far from the joint as the reflector.
    fn angle(&self, pose: &Pose<f64>, place: Vector2<f64>) -> Option<f64> {
        let along = match self.end {
            End::Front => self.half,
            End::Back => -self.half,
        };
        let from = place - pose.transform(&Vector2::new(along, 0.0));
        let reach = self.at[0].hypot(self.at[1]);
        if (from.norm() - reach).abs() > DISTANCE * reach {
            return None;
        }
        let outwards = from.y.atan2(from.x) - self.at[1].atan2(self.at[0]);
        Some(wrapped_angle(match self.end {
            End::Front => outwards - pose.theta,
            End::Back => pose.theta + std::f64::consts::PI - outwards,
        }))
    }

    /// The angle that continues the last one; without a last one, the named point's or the straightest.
    fn goes_on(&self, shown: &[PointAngle], time_s: f64) -> Option<f64> {
        let by_name = || shown.iter().find(|shown| shown.named);
        let Some(last) = self.last else {
            let straightest = || {
                shown
                    .iter()
                    .min_by(|a, b| a.angle.abs().total_cmp(&b.angle.abs()))
            };
            let first = by_name().or_else(|| straightest().filter(|_| !self.has_name))?;
            return Some(first.angle);
        };
        let reach = STEP.max(SPEED * (time_s - last.time_s));
        let off = |shown: &&PointAngle| wrapped_angle(shown.angle - last.angle).abs();
        let nearest = shown.iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
        // Over a long gap everything is near: the name decides.
        let next = if reach > 1.0 {
            by_name().unwrap_or(nearest)
        } else {
            nearest
        };
        (off(&next) < reach).then(|| last.angle + wrapped_angle(next.angle - last.angle))
    }
}
