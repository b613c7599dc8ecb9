//! Gaits of one family strung together to a target.
//!
//! All gaits start and end at one common shape, so what a chain of them brings is a product of poses. Each has a family: the gait
//! drawn towards the common shape by a scale of at most 1, with the servos as fast as before, and its own net pose, swum anew.
//! A leg is a number of cycles of one member, forwards or backwards; three legs have three scales, which meet a target's three
//! coordinates exactly. Which legs, in which order and how many cycles is searched for; walls are respected.
//!
//! The robot's tables cut corners, its servos have a dead band, and the ways from and to the straight shape are ramps. So a chain
//! is played, with the robot's own arithmetic, and aimed as far beside the target as it misses it by, until it is met.

mod aim;
mod legs;
mod member;
mod room;

use nalgebra::Vector2;
use swimmer_files::AnyGait;
use swimmer_model::{Model, Pose, wrapped_angle};

use crate::losses::Servos;
use crate::path::Polyline;
use crate::playlist::{leads_to, step_period};
use crate::tank::Tank;
use aim::{Aim, Hit};
pub use member::{Kind, Member, Scaled};

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
    /// At the servos' full rate.
    fn new(family: &Family, servos: &Servos, member: Member, cycles: u32) -> Self {
        let (_, period) = &family.gaits[member.kind as usize];
        Self {
            member,
            cycles,
            period: step_period(period * member.scale, servos.file.max_rate),
        }
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
    /// No chain of legs.
    #[error(
        "no way found: {met} chains of at most three legs meet the target, and each comes within {margin} m of a wall; name a target \
         farther from the walls, another heading, or a larger --tank"
    )]
    NoWay {
        /// That meet the target.
        met: usize,
        /// \[m\]
        margin: f64,
    },
}

impl Family {
    /// The common shape \[rad\].
    pub fn shape(&self) -> Vector2<f64> {
        swimmer_model::Gait::at(&self.gaits[0].0, 0.0).phi * self.sign()
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
    let shape = family.shape();
    let apart = family.gaits.iter().map(|(gait, _)| {
        let end = |u: f64| (swimmer_model::Gait::at(gait, u).phi * family.sign() - shape).norm();
        end(0.0).max(end(1.0))
    });
    let apart = apart.fold(0.0, f64::max);
    if apart > 1e-6 {
        return Err(PlanError::Apart { apart });
    }
    let room = room::Room::new(model, errand);
    let straight = |what, pose: Pose<f64>| {
        if room.fits(&pose, &Vector2::zeros()) {
            return Ok(());
        }
        Err(PlanError::Outside {
            what,
            pose: [pose.x, pose.y, pose.theta],
            margin: errand.margin,
        })
    };
    straight("at the start", errand.from)?;
    if let Some(heading) = errand.heading {
        straight(
            "at the target",
            Pose::new(errand.to.x, errand.to.y, heading),
        )?;
    }
    // Beside a wall the swimmer may have room to bend away from it only.
    let plans =
        [family.clone(), family.mirror()].map(|family| of_family(model, &family, errand, &room));
    let [one, other] = plans;
    match (one?, other?) {
        ((Some(one), met), (Some(other), met_too)) => {
            let quicker = if other.duration < one.duration {
                other
            } else {
                one
            };
            Ok(quicker.of(added(met, met_too)))
        }
        ((Some(plan), met), (None, met_too)) | ((None, met), (Some(plan), met_too)) => {
            Ok(plan.of(added(met, met_too)))
        }
        ((None, met), (None, met_too)) => Err(PlanError::NoWay {
            met: met[0] + met_too[0],
            margin: errand.margin,
        }),
    }
}

/// Beside a wall there may be no room for large cycles: so many times as many smaller ones are tried.
const SMALLER: [u32; 5] = [1, 2, 4, 8, 16];

fn added(one: [usize; 2], other: [usize; 2]) -> [usize; 2] {
    [one[0] + other[0], one[1] + other[1]]
}

/// The quickest plan with these gaits, where there is one; and how many chains meet the target, and stay within the walls.
fn of_family(
    model: &Model<f64>,
    family: &Family,
    errand: &Errand,
    room: &room::Room<'_>,
) -> Result<(Option<Plan>, [usize; 2]), PlanError> {
    let nets = member::Nets::new(model, family);
    let way_in = family.way_in(model);
    let begun = errand.from * way_in;
    let chains = legs::chains(&nets, family, errand, &way_in);
    let aim = Aim {
        model,
        family,
        errand,
        nets: &nets,
        way_in,
    };
    let mut found = [chains.len(), 0];
    for smaller in SMALLER {
        let more = |steps: &Vec<Step>| legs::smaller(&nets, family, &errand.servos, steps, smaller);
        let mut left: Vec<_> = chains.iter().filter_map(more).collect();
        left.sort_by(|a, b| duration(a).total_cmp(&duration(b)));
        left.retain(|steps| room.leaves(family, &begun, &nets, steps));
        found[1] += left.len();
        for steps in &left {
            let Some(hit) = aim.hit(&begun, steps)? else {
                continue;
            };
            if room.leaves_played(&errand.from, &hit.way) {
                return Ok((Some(Plan::new(errand, family, hit, found)), found));
            }
        }
    }
    Ok((None, found))
}

/// How far two poses are apart \[m\], and by what angle \[rad\].
fn distance(one: &Pose<f64>, other: &Pose<f64>) -> [f64; 2] {
    [
        (one.position() - other.position()).norm(),
        wrapped_angle(one.theta - other.theta).abs(),
    ]
}

impl Plan {
    fn new(errand: &Errand, family: &Family, hit: Hit, met: [usize; 2]) -> Self {
        let heading = errand.heading.unwrap_or(hit.reached.theta);
        Self {
            duration: duration(&hit.steps),
            off: distance(&hit.reached, &Pose::new(errand.to.x, errand.to.y, heading)),
            reached: hit.reached,
            steps: hit.steps,
            mirrored: family.mirrored,
            way: hit.way,
            met,
        }
    }

    fn of(self, met: [usize; 2]) -> Self {
        Self { met, ..self }
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
