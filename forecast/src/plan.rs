//! Gaits of one family strung together to a target.
//!
//! All gaits start and end at one common shape, so what a chain of them brings is a product of poses. Each has a family: the gait
//! drawn towards the common shape by a scale of at most 1, with the servos as fast as before, and its own net pose, swum anew.
//! A leg is a number of cycles of one member, forwards or backwards; three legs have three scales, which meet a target's three
//! coordinates exactly. Which legs, in which order and how many cycles is searched for; walls are respected.

mod legs;
mod member;
mod room;

use nalgebra::Vector2;
use swimmer_files::AnyGait;
use swimmer_model::{Model, Pose, Tolerance, swim};

use crate::path::Polyline;
use crate::tank::Tank;
pub use member::{Kind, Member};

/// The gaits that a plan is made of.
#[derive(Debug, Clone)]
pub struct Family {
    /// One of each kind, all from one common shape: forward, left, turning left; with the seconds that a cycle takes.
    pub gaits: [(AnyGait, f64); 3],
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
}

/// So many cycles of one member.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Which member.
    pub member: Member,
    /// Cycles.
    pub cycles: u32,
    /// Seconds of a cycle.
    pub period: f64,
}

/// A plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// In order.
    pub steps: Vec<Step>,
    /// \[s\], without the ways from and to the straight shape.
    pub duration: f64,
    /// Where the model ends up, the joints straight again.
    pub reached: Pose<f64>,
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
        swimmer_model::Gait::at(&self.gaits[0].0, 0.0).phi
    }

    /// What going from the straight shape to the common one brings.
    fn way_in(&self, model: &Model<f64>) -> Pose<f64> {
        net(model, &Polyline::new([Vector2::zeros(), self.shape()]))
    }

    /// Where these steps lead, swum anew: each member as a gait of its own.
    pub fn reached(&self, model: &Model<f64>, from: &Pose<f64>, steps: &[Step]) -> Pose<f64> {
        let way_in = self.way_in(model);
        let mut pose = *from * way_in;
        for step in steps {
            let cycle = net(model, &step.member.of(self));
            pose = pose * member::repeated(&cycle, step.cycles);
        }
        pose * way_in.inverse()
    }
}

fn net<G: swimmer_model::Gait<f64>>(model: &Model<f64>, gait: &G) -> Pose<f64> {
    let stroke = swim(model, gait, &Tolerance::default());
    Pose::new(
        stroke.displacement.x,
        stroke.displacement.y,
        stroke.rotation,
    )
}

/// The quickest plan that is found.
///
/// # Errors
/// [`PlanError`].
///
/// ```
/// use forecast::{Errand, Family, PlanError, plan};
/// use nalgebra::Vector2;
/// use swimmer_files::AnyGait;
/// use swimmer_model::{Model, Pose, Swimmer};
///
/// let model = Model::new(&Swimmer::robot()).unwrap();
/// // Circles of three sizes start at three shapes: they do not join.
/// let gaits = [0.8, 1.0, 1.2].map(|amplitude| (AnyGait::circle(amplitude), 10.0));
/// let to = Vector2::new(0.2, 0.1);
/// let errand = Errand { from: Pose::identity(), to, heading: None, tank: None, margin: 0.005 };
/// let refused = plan(&model, &Family { gaits }, &errand).unwrap_err();
/// assert!(matches!(refused, PlanError::Apart { apart } if (apart - 0.4).abs() < 1e-12));
/// ```
pub fn plan(model: &Model<f64>, family: &Family, errand: &Errand) -> Result<Plan, PlanError> {
    let shape = family.shape();
    let apart = family.gaits.iter().map(|(gait, _)| {
        let end = |u: f64| (swimmer_model::Gait::at(gait, u).phi - shape).norm();
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
    let nets = member::Nets::new(model, family);
    let way_in = family.way_in(model);
    let begun = errand.from * way_in;
    let mut left = legs::chains(&nets, family, errand, &way_in);
    let met = left.len();
    left.sort_by(|a, b| duration(a).total_cmp(&duration(b)));
    left.retain(|steps| room.leaves(family, &begun, &nets, steps));
    let Some(steps) = left.first() else {
        return Err(PlanError::NoWay {
            met,
            margin: errand.margin,
        });
    };
    let reached = family.reached(model, &errand.from, steps);
    let heading = errand.heading.unwrap_or(reached.theta);
    Ok(Plan {
        duration: duration(steps),
        off: distance(&reached, &Pose::new(errand.to.x, errand.to.y, heading)),
        reached,
        met: [met, left.len()],
        steps: steps.clone(),
    })
}

/// How far two poses are apart \[m\], and by what angle \[rad\].
fn distance(one: &Pose<f64>, other: &Pose<f64>) -> [f64; 2] {
    [
        (one.position() - other.position()).norm(),
        legs::wrapped(one.theta - other.theta).abs(),
    ]
}

impl Plan {
    /// How far a pose is from where the plan leads \[m\], and by what angle \[rad\].
    pub fn apart_from(&self, pose: &Pose<f64>) -> [f64; 2] {
        distance(&self.reached, pose)
    }
}

fn duration(steps: &[Step]) -> f64 {
    let of = |step: &Step| f64::from(step.cycles) * step.period;
    steps.iter().map(of).sum()
}
