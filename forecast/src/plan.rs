//! Gaits of one family strung together to a target.
//!
//! All gaits start and end at one common shape, so what a chain of them brings is a product of poses. Each has a family: the gait
//! drawn towards the common shape by a scale of at most 1, with the servos as fast as before, and its own net pose, swum anew as
//! the servos play it. A leg is a number of cycles of one member, forwards or backwards; three legs have three scales, which meet a
//! target's three coordinates exactly. Beside a wall, where such legs have no room, ways out are looked for with the cycles that
//! have, from the start and (every gait can be undone) from the target; three legs lead from one to the other. The search takes the
//! quickest chain that it finds; walls are respected.
//!
//! The robot's tables cut corners, its servos have a dead band, and the ways from and to the straight shape are ramps. So a chain
//! is played, with the robot's own arithmetic, and aimed as far beside the target as it misses it by, until it is met.

mod aim;
mod legs;
mod member;
mod planner;
mod room;
mod search;
mod way_out;

use nalgebra::Vector2;
use swimmer_files::AnyGait;
use swimmer_model::{Model, Pose, wrapped_angle};

use crate::losses::Servos;
use crate::path::Polyline;
use crate::playlist::{Repeated, leads_to};
use crate::tank::Tank;
use aim::Hit;
use member::Nets;
use room::{Room, Sweeps, SweptAreas};
use search::{EFFORTS, Seen, quickest};

pub use member::{Kind, Member, Scaled};
pub use planner::Planner;

/// The gaits that a plan is made of.
#[derive(Debug, Clone)]
pub struct Family {
    /// One of each kind, all from one common shape: forward, left, turning left; with the seconds that a cycle takes.
    pub gaits: [(AnyGait, f64); 3],
    /// All of them seen in a mirror along the body, φ ↦ −φ: left is right then, and the common shape bends the other way.
    pub mirrored: bool,
}

/// What is asked for. Poses are those of the middle link with all joints straight, from the tank's centre: the way from there to
/// the common shape, and back at the end, belongs to the plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errand {
    /// Where the swimmer is \[m, rad\].
    pub from: Pose<f64>,
    /// Where it shall go \[m\].
    pub to: Vector2<f64>,
    /// Its heading there \[rad\]; none: any.
    pub heading: Option<f64>,
    /// Its walls; none: open water.
    pub tank: Option<Tank>,
    /// No part of it comes nearer to a wall than this \[m\].
    pub margin: f64,
    /// What the plan is played by.
    pub servos: Servos,
}

/// So many cycles of one member.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Which member.
    pub member: Member,
    /// Cycles.
    pub cycles: u32,
    /// Seconds of a cycle, as it is played.
    pub period: f64,
}

impl Step {
    /// As it is played.
    fn repeated(&self, family: &Family) -> Repeated<Scaled> {
        Repeated {
            gait: self.member.of(family),
            cycles: self.cycles,
            period: self.period,
        }
    }

    /// The same cycles run backwards.
    fn undone(&self) -> Self {
        let member = Member {
            backwards: !self.member.backwards,
            ..self.member
        };
        Self { member, ..*self }
    }
}

/// A plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// In order.
    pub steps: Vec<Step>,
    /// Of the gaits in a mirror.
    pub mirrored: bool,
    /// \[s\], without the ways from and to the straight shape.
    pub duration: f64,
    /// Where the swimmer ends up, the joints straight again.
    pub reached: Pose<f64>,
    /// The way of the joints as the servos take it, from straight to straight.
    pub way: Polyline,
    /// How far that is from the target \[m\], and by what angle \[rad\].
    pub off: [f64; 2],
    /// Chains of legs that meet the target, and those of them that the walls leave.
    pub met: [usize; 2],
}

/// Why there is no plan.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// The gaits do not join.
    #[error(
        "the gaits of a family start and end at one common shape, and these are {apart:.2e} rad apart there; take them from one \
         `swimmer optimize steer`"
    )]
    Apart {
        /// \[rad\]
        apart: f64,
    },
    /// A pose does not fit into the tank.
    #[error(
        "the swimmer does not fit into the tank {what}: at ({:.4}, {:.4}) m, heading {:.1}°, it comes within {margin} m of a wall; \
         name a pose farther from the walls, or a larger --tank", pose[0], pose[1], pose[2].to_degrees()
    )]
    Outside {
        /// At the start, or at the target.
        what: &'static str,
        /// x, y \[m\], θ \[rad\].
        pose: [f64; 3],
        /// \[m\]
        margin: f64,
    },
    /// The robot would not play it.
    #[error("the robot would refuse the {gait} gait of the plan: {reason}")]
    Refused {
        /// Which gait.
        gait: &'static str,
        /// The robot's words.
        reason: String,
    },
    /// It does where it is straight, and not where it is bent as the gaits begin and end.
    #[error(
        "{what}, ({:.4}, {:.4}) m, heading {:.1}°, the swimmer has no room to be bent to ({:.1}°, {:.1}°), where these gaits join, \
         nor to the other side: it comes within {margin} m of a wall; gaits that join at the straight shape always \
         have room there (`swimmer optimize steer --shape 0,0`)", pose[0], pose[1], pose[2].to_degrees(), shape[0].to_degrees(),
         shape[1].to_degrees()
    )]
    Bent {
        /// The start, or the target.
        what: &'static str,
        /// x, y \[m\], θ \[rad\].
        pose: [f64; 3],
        /// The common shape \[rad\].
        shape: [f64; 2],
        /// \[m\]
        margin: f64,
    },
    /// No chain of legs.
    #[error(
        "no way found: {met} chains of legs meet the target, {within} of them within walls in the model, and none stays {margin} m \
         from the walls as the servos play it; name a target farther from the walls, another heading, a smaller --margin or a larger \
         --tank"
    )]
    NoWay {
        /// That meet the target.
        met: usize,
        /// Of them those that the walls leave in the model.
        within: usize,
        /// \[m\]
        margin: f64,
    },
}

impl Family {
    /// The common shape \[rad\].
    pub fn shape(&self) -> Vector2<f64> {
        swimmer_model::Gait::at(&self.gaits[0].0, 0.0).phi * self.sign()
    }

    /// # Errors
    /// [`PlanError::Apart`] if the gaits do not start and end at one shape.
    fn check_joined(&self) -> Result<(), PlanError> {
        let shape = self.shape();
        let apart = self.gaits.iter().map(|(gait, _)| {
            let end = |u: f64| (swimmer_model::Gait::at(gait, u).phi * self.sign() - shape).norm();
            end(0.0).max(end(1.0))
        });
        let apart = apart.fold(0.0, f64::max);
        if apart > 1e-6 {
            return Err(PlanError::Apart { apart });
        }
        Ok(())
    }

    fn sign(&self) -> f64 {
        if self.mirrored { -1.0 } else { 1.0 }
    }

    /// The same gaits in a mirror.
    #[must_use]
    pub fn mirror(&self) -> Self {
        Self {
            gaits: self.gaits.clone(),
            mirrored: !self.mirrored,
        }
    }

    /// What going from the straight shape to the common one brings.
    fn way_in(&self, model: &Model<f64>) -> Pose<f64> {
        leads_to(model, &Polyline::new([Vector2::zeros(), self.shape()]))
    }
}

/// The quickest plan that is found.
///
/// # Errors
/// [`PlanError`].
///
/// ```
/// use forecast::{Errand, Family, PlanError, Servos, plan};
/// use nalgebra::Vector2;
/// use swimmer_files::{AnyGait, ServoFile};
/// use swimmer_model::{Model, Pose, Swimmer};
///
/// let model = Model::new(&Swimmer::robot()).unwrap();
/// // Circles of three sizes start at three shapes: they do not join.
/// let gaits = [0.8, 1.0, 1.2].map(|amplitude| (AnyGait::circle(amplitude), 10.0));
/// let to = Vector2::new(0.2, 0.1);
/// let servos = Servos::on_the_robot(ServoFile::default());
/// let errand = Errand { from: Pose::identity(), to, heading: None, tank: None, margin: 0.005, servos };
/// let refused = plan(&model, &Family { gaits, mirrored: false }, &errand).unwrap_err();
/// assert!(matches!(refused, PlanError::Apart { apart } if (apart - 0.4).abs() < 1e-12));
/// ```
pub fn plan(model: &Model<f64>, family: &Family, errand: &Errand) -> Result<Plan, PlanError> {
    family.check_joined()?;
    let room = Room::new(model, errand.tank, errand.margin);
    has_room(model, &room, family, errand)?;
    let nets = Nets::new(model, family, &errand.servos).map_err(|error| PlanError::Refused {
        gait: "fastest",
        reason: error.to_string(),
    })?;
    // Beside a wall the swimmer may have room to bend away from it only.
    let images = [(family.clone(), &nets), (family.mirror(), &nets.mirror())];
    let mut seen = Seen::default();
    for effort in &EFFORTS {
        let roomy = Room::new(model, errand.tank, errand.margin + effort.spare);
        let mut found = None;
        for (family, nets) in &images {
            let swept = SweptAreas::default();
            let sweeps = Sweeps::new(&roomy, nets, family, &swept);
            found = quickest(model, errand, &room, &sweeps, effort, found, &mut seen);
        }
        if let Some(found) = found {
            return Ok(Plan {
                met: seen.met,
                ..found
            });
        }
    }
    Err(seen.refused.unwrap_or(PlanError::NoWay {
        met: seen.met[0],
        within: seen.met[1],
        margin: errand.margin,
    }))
}

/// Whether there is room at the start and, where its heading is given, at the target: straight, and bent to one side at least.
fn has_room(
    model: &Model<f64>,
    room: &Room<'_>,
    family: &Family,
    errand: &Errand,
) -> Result<(), PlanError> {
    let to = errand
        .heading
        .map(|heading| Pose::new(errand.to.x, errand.to.y, heading));
    let shape = family.shape();
    for (what, pose) in [("at the start", Some(errand.from)), ("at the target", to)] {
        let Some(pose) = pose else { continue };
        let told = [pose.x, pose.y, pose.theta];
        let margin = errand.margin;
        if !room.fits(&pose, &Vector2::zeros()) {
            return Err(PlanError::Outside {
                what,
                pose: told,
                margin,
            });
        }
        let bent = |family: &Family| room.fits(&(pose * family.way_in(model)), &family.shape());
        if !bent(family) && !bent(&family.mirror()) {
            return Err(PlanError::Bent {
                what,
                pose: told,
                shape: shape.into(),
                margin,
            });
        }
    }
    Ok(())
}

/// How far two poses are apart \[m\], and by what angle \[rad\].
fn distance(one: &Pose<f64>, other: &Pose<f64>) -> [f64; 2] {
    [
        (one.position() - other.position()).norm(),
        wrapped_angle(one.theta - other.theta).abs(),
    ]
}

impl Plan {
    fn new(errand: &Errand, family: &Family, hit: Hit) -> Self {
        let heading = errand.heading.unwrap_or(hit.reached.theta);
        Self {
            duration: duration(&hit.steps),
            off: distance(&hit.reached, &Pose::new(errand.to.x, errand.to.y, heading)),
            reached: hit.reached,
            steps: hit.steps,
            mirrored: family.mirrored,
            way: hit.way,
            met: [0, 0],
        }
    }

    /// One cycle of each step, in order.
    pub fn gaits(&self, family: &Family) -> Vec<Scaled> {
        let family = Family {
            mirrored: self.mirrored,
            ..family.clone()
        };
        let steps = self.steps.iter();
        steps.map(|step| step.member.of(&family)).collect()
    }

    /// What a step is called: `forward`, `backward`, `left`, `right`, `turn-left`, `turn-right`.
    pub fn word(&self, step: &Step) -> &'static str {
        step.member.word(self.mirrored)
    }

    /// Where another swimmer gets with it.
    pub fn reached_by(&self, model: &Model<f64>, from: &Pose<f64>) -> Pose<f64> {
        *from * leads_to(model, &self.way)
    }

    /// How far a pose is from where the plan leads \[m\], and by what angle \[rad\].
    pub fn apart_from(&self, pose: &Pose<f64>) -> [f64; 2] {
        distance(&self.reached, pose)
    }
}

fn duration(steps: &[Step]) -> f64 {
    let of = |step: &Step| f64::from(step.cycles) * step.period;
    steps.iter().map(of).sum()
}
