//! Number of cycles until a swimmer meets a wall of its tank.

use std::str::FromStr;

use nalgebra::Vector2;
use swimmer_model::{Gait, Model, Pose, Swimmer, trajectory};

use crate::losses::tolerance;
use crate::path::Polyline;

/// A rectangular tank, inner measures.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
pub struct Tank {
    /// Along x \[m\].
    pub length: f64,
    /// Along y \[m\].
    pub width: f64,
}

impl FromStr for Tank {
    type Err = String;

    /// Reads length and width in metres, as `1.0x0.6`.
    fn from_str(text: &str) -> Result<Self, String> {
        let sides = text.split_once(['x', '×']).map(|(length, width)| {
            let number = |text: &str| f64::from_str(text.trim().trim_end_matches('m').trim());
            (number(length), number(width))
        });
        match sides {
            Some((Ok(length), Ok(width)))
                if length > 0.0 && width > 0.0 && length.is_finite() && width.is_finite() =>
            {
                Ok(Self { length, width })
            }
            _ => Err("write length and width in metres, as 1.0x0.6".to_owned()),
        }
    }
}

impl Tank {
    /// `true` if a disc of this radius \[m\] at this place, from the tank's centre \[m\], does not touch a wall.
    pub(crate) fn holds(&self, at: &Vector2<f64>, radius: f64) -> bool {
        at.x.abs() + radius < 0.5 * self.length && at.y.abs() + radius < 0.5 * self.width
    }
}

/// A part of the body that meets the wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Part {
    /// The tip of the back link.
    BackTip,
    /// The back joint.
    BackJoint,
    /// The front joint.
    FrontJoint,
    /// The tip of the front link.
    FrontTip,
    /// The sphere on the middle link.
    Sphere,
}

impl Part {
    /// In words.
    pub fn word(self) -> &'static str {
        match self {
            Self::BackTip => "the back link's tip",
            Self::BackJoint => "the back joint",
            Self::FrontJoint => "the front joint",
            Self::FrontTip => "the front link's tip",
            Self::Sphere => "the sphere",
        }
    }
}

/// First contact of a swimmer with a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting {
    /// Cycles until then, with the fraction of the last one; 0 if it does not fit into the tank at the start.
    pub cycles: f64,
    /// Part of the body that touches.
    pub part: Part,
    /// Place of the contact, from the tank's centre \[m\].
    pub at: Vector2<f64>,
}

/// Looks at the body a cycle.
const SAMPLES: usize = 360;
/// Cycles that are looked at: a month of 30 s each.
const MOST_CYCLES: u32 = 90_000;

/// When a swimmer that starts at a pose (of its middle link at the gait's first shape, from the tank's centre, heading from the
/// tank's x) and swims this gait over and over meets a wall. `None`: not within 90 000 cycles, or never because it comes round
/// to where it was.
///
/// The links are lines and the sphere a disc; walls do not slow the swimmer before they are met.
///
/// ```
/// use forecast::{Tank, until_wall};
/// use swimmer_files::AnyGait;
/// use swimmer_model::{Model, Pose, Swimmer};
///
/// let model = Model::new(&Swimmer::<f64>::robot()).unwrap();
/// let cycles = |length| {
///     let tank = Tank { length, width: 1.0 };
///     until_wall(&model, &AnyGait::circle(1.2), &tank, &Pose::identity()).map(|meeting| meeting.cycles)
/// };
/// assert!(cycles(2.0).unwrap() > cycles(1.5).unwrap(), "a longer tank fits more cycles");
/// ```
pub fn until_wall<G: Gait<f64> + ?Sized>(
    model: &Model<f64>,
    gait: &G,
    tank: &Tank,
    start: &Pose<f64>,
) -> Option<Meeting> {
    let mut cycle: Vec<(f64, Pose<f64>, Vector2<f64>)> = Vec::with_capacity(SAMPLES + 1);
    trajectory(model, gait, &tolerance(), SAMPLES, |point| {
        cycle.push((point.u, point.pose, point.phi));
    });
    let net = cycle.last().map(|(_, pose, _)| *pose)?;
    let swimmer = model.swimmer();
    // No part of the body is further than this from where the cycle began.
    let reach = cycle
        .iter()
        .map(|(_, pose, _)| pose.position().norm())
        .fold(0.0, f64::max)
        + swimmer.total_length().max(swimmer.sphere_radius);
    let mut began = *start;
    let mut turned: f64 = 0.0;
    for number in 0..MOST_CYCLES {
        if !tank.holds(&began.position(), reach) {
            for (u, pose, phi) in &cycle {
                let pose = began * *pose;
                if let Some((part, at)) = touching(swimmer, tank, &pose, phi) {
                    return Some(Meeting {
                        cycles: f64::from(number) + u,
                        part,
                        at,
                    });
                }
            }
        }
        began = began * net;
        turned += net.theta;
        // A swimmer that turns goes round a circle, and after two rounds has been everywhere on it.
        if turned.abs() > 2.0 * std::f64::consts::TAU {
            return None;
        }
    }
    None
}

/// First contact with a wall of a swimmer that follows a path of the joints once, from a pose of its middle link. `cycles` is the
/// fraction of the path. The body is checked at every vertex of the path.
///
/// ```
/// use forecast::{Part, Tank, meets_wall, path::Polyline};
/// use nalgebra::Vector2;
/// use swimmer_model::{Model, Pose, Swimmer};
///
/// let model = Model::new(&Swimmer::robot()).unwrap();
/// let tank = Tank { length: 1.0, width: 0.6 };
/// let bent = Polyline::new([Vector2::zeros(), Vector2::new(1.5, -1.5)]);
/// assert!(meets_wall(&model, &bent, &tank, &Pose::new(0.0, 0.0, 0.0)).is_none());
/// // Straight along a wall the swimmer fits; with bent joints it does not.
/// let meeting = meets_wall(&model, &bent, &tank, &Pose::new(0.0, 0.195, 0.0)).unwrap();
/// assert!(meeting.part == Part::BackTip && meeting.at.y > 0.3 && meeting.cycles > 0.0);
/// ```
pub fn meets_wall(
    model: &Model<f64>,
    way: &Polyline,
    tank: &Tank,
    start: &Pose<f64>,
) -> Option<Meeting> {
    let mut met = None;
    trajectory(model, way, &tolerance(), way.pieces(), |point| {
        if met.is_none() {
            let touching = touching(model.swimmer(), tank, &(*start * point.pose), &point.phi);
            met = touching.map(|(part, at)| Meeting {
                cycles: point.u,
                part,
                at,
            });
        }
    });
    met
}

/// The part of the body that is beyond a wall, and where.
pub(crate) fn touching(
    swimmer: &Swimmer<f64>,
    tank: &Tank,
    pose: &Pose<f64>,
    phi: &Vector2<f64>,
) -> Option<(Part, Vector2<f64>)> {
    let [back_tip, back, front, front_tip] = swimmer.links.outline(phi);
    let parts = [
        (Part::BackTip, back_tip, 0.0),
        (Part::FrontTip, front_tip, 0.0),
        (Part::Sphere, Vector2::zeros(), swimmer.sphere_radius),
        (Part::BackJoint, back, 0.0),
        (Part::FrontJoint, front, 0.0),
    ];
    parts.into_iter().find_map(|(part, point, radius)| {
        let at = pose.transform(&point);
        (!tank.holds(&at, radius)).then_some((part, at))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_files::AnyGait;
    use swimmer_model::{Tolerance, swim};

    fn robot() -> Model<f64> {
        Model::new(&Swimmer::robot()).unwrap()
    }

    const TANK: Tank = Tank {
        length: 1.0,
        width: 0.6,
    };

    /// A gait without rotation goes straight: the last cycle is where the body's foremost reach within a cycle, carried on by
    /// the net displacement, passes the wall.
    #[test]
    fn a_straight_swimmer_meets_the_end_where_arithmetic_says() {
        let (model, gait) = (robot(), AnyGait::circle(1.2));
        let net = swim(&model, &gait, &Tolerance::default()).displacement.x;
        let meeting = until_wall(&model, &gait, &TANK, &Pose::identity()).unwrap();
        let mut foremost: f64 = 0.0;
        trajectory(&model, &gait, &tolerance(), SAMPLES, |point| {
            for corner in model.swimmer().links.outline(&point.phi) {
                foremost = foremost.max(point.pose.transform(&corner).x);
            }
        });
        let expected = (0.5 - foremost) / net;
        assert!(
            (meeting.cycles - expected).abs() <= 1.0,
            "{} cycles, {expected} by arithmetic",
            meeting.cycles
        );
        assert!((meeting.at.x - 0.5).abs() < net, "{meeting:?}");
        // A longer tank is longer by what the net displacement needs.
        let longer = Tank {
            length: 2.0,
            ..TANK
        };
        let later = until_wall(&model, &gait, &longer, &Pose::identity()).unwrap();
        assert!((later.cycles - meeting.cycles - 0.5 / net).abs() <= 1.0);
    }

    #[test]
    fn reversed_it_meets_the_other_end_and_across_the_side() {
        let (model, gait) = (robot(), AnyGait::circle(1.2));
        let back = gait.clone().reversed_if(true);
        let meeting = until_wall(&model, &back, &TANK, &Pose::identity()).unwrap();
        assert!(meeting.at.x < -0.49, "{meeting:?}");
        let across = Pose::new(0.0, 0.0, std::f64::consts::FRAC_PI_2);
        let side = until_wall(&model, &gait, &TANK, &across).unwrap();
        assert!(side.cycles < meeting.cycles && side.at.y > 0.29, "{side:?}");
    }

    #[test]
    fn a_tank_that_is_too_small_is_met_at_once_and_a_still_swimmer_never() {
        let small = Tank {
            length: 0.2,
            width: 0.6,
        };
        let (model, gait) = (robot(), AnyGait::circle(0.5));
        let meeting = until_wall(&model, &gait, &small, &Pose::identity()).unwrap();
        assert!(meeting.cycles <= 0.0, "{meeting:?}");
        let still = AnyGait::circle(1e-9);
        let wide = Tank {
            length: 10.0,
            width: 10.0,
        };
        assert_eq!(until_wall(&model, &still, &wide, &Pose::identity()), None);
    }

    #[test]
    fn tanks_are_read() {
        let read = |text: &str| text.parse().map(|tank: Tank| (tank.length, tank.width));
        assert_eq!(read("1.0x0.6"), Ok((1.0, 0.6)));
        assert_eq!(read("2 m × 1 m"), Ok((2.0, 1.0)));
        for text in ["1.0", "x", "0x1", "1x-1", "1xnan", "axb", "1x2x3", "infx1"] {
            assert!(read(text).is_err(), "{text}");
        }
    }
}
