//! Motion plans: chains of gaits of one family that lead to a target pose.
//!
//! All gaits start and end at one common shape, so the net motion of a chain is the product of the net poses of its cycles. Each
//! gait has scaled members: its curve is contracted towards the common shape by a scale of at most 1, at the same speed of the
//! servos. The net pose of each member is computed anew, as the servos play it. A leg is a number of cycles of one member, forwards
//! or backwards. Three legs have three scales, which meet the three coordinates of a target exactly. If such legs do not fit next to
//! a wall, the search looks for approaches with smaller cycles, from the start and from the target (every gait can be reversed);
//! three legs then lead from one to the other. The plan is the quickest chain found that stays clear of the walls.
//!
//! The robot's tables cut corners, its servos have a dead band, and the ways from and to the straight shape are ramps. A chain is
//! therefore played with the robot's own arithmetic, and the aim is shifted by the miss until the played chain meets the target.

mod aim;
mod budget;
mod legs;
mod member;
mod planner;
mod search;
mod walls;
mod way_out;

use nalgebra::Vector2;
use swimmer_files::AnyGait;
use swimmer_model::{Model, Pose, wrapped_angle};

use crate::losses::Servos;
use crate::path::Polyline;
use crate::playlist::{Repeated, leads_to};
use crate::tank::Tank;
use aim::Hit;
use budget::Budget;
use member::Nets;
use search::{EFFORTS, PlanSearch, SearchCounts, ends};
use walls::{Sweeps, SweptAreas, Walls};

pub use budget::Watch;
pub use member::{Kind, Member, Scaled};
pub use planner::Planner;

/// Gaits of a plan.
#[derive(Debug, Clone)]
pub struct Family {
    /// Forward, left and left-turning gait, all from one common shape, each with the duration of a cycle \[s\].
    pub gaits: [(AnyGait, f64); 3],
    /// Mirrored along the body, φ ↦ −φ: left and right are exchanged, and the common shape bends the other way.
    pub mirrored: bool,
}

/// Request for a plan. Poses are those of the middle link with all joints straight, relative to the tank's centre: the motion from
/// there to the common shape, and back at the end, belongs to the plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanRequest {
    /// Start pose \[m, rad\].
    pub from: Pose<f64>,
    /// Target position \[m\].
    pub to: Vector2<f64>,
    /// Heading at the target \[rad\]; `None`: any.
    pub heading: Option<f64>,
    /// Tank with its walls; `None`: open water.
    pub tank: Option<Tank>,
    /// Least distance of any part of the swimmer to a wall \[m\].
    pub margin: f64,
    /// Servos that play the plan.
    pub servos: Servos,
}

/// Number of cycles of one member.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Repeated gait.
    pub member: Member,
    /// Number of cycles.
    pub cycles: u32,
    /// Duration of a cycle as it is played \[s\].
    pub period: f64,
}

impl Step {
    /// The repeated gait as it is played.
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

/// Motion plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Steps in order.
    pub steps: Vec<Step>,
    /// Made of the mirrored gaits.
    pub mirrored: bool,
    /// Duration \[s\], without the motion from and to the straight shape.
    pub duration: f64,
    /// End pose, with the joints straight again.
    pub reached: Pose<f64>,
    /// Path of the joints as the servos follow it, from straight to straight.
    pub way: Polyline,
    /// Distance of the end pose to the target \[m\], and difference of the heading \[rad\].
    pub off: [f64; 2],
    /// Number of chains of legs that meet the target, and of those that also stay clear of the walls.
    pub met: [usize; 2],
}

/// Reason why there is no plan.
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
    /// The swimmer fits into the tank at the target in no heading.
    #[error(
        "the swimmer does not fit into the tank at the target: at ({:.4}, {:.4}) m it comes within {margin} m of a wall in every \
         heading; name a target farther from the walls, or a larger --tank", to[0], to[1]
    )]
    TargetOutside {
        /// x, y \[m\].
        to: [f64; 2],
        /// \[m\]
        margin: f64,
    },
    /// The robot would not play it.
    #[error("the robot would refuse the {gait} gait of the plan: {reason}")]
    Refused {
        /// Name of the gait.
        gait: &'static str,
        /// The robot's reason.
        reason: String,
    },
    /// The straight swimmer fits, but not the common shape at which the gaits begin and end.
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
    /// No chain of legs stays clear of the walls.
    #[error(
        "no way found: {met} chains of legs meet the target, {within} of them within walls in the model, and none stays {margin} m \
         from the walls as the servos play it; name a target farther from the walls, another heading, a smaller --margin or a larger \
         --tank"
    )]
    NoWay {
        /// Number of chains that meet the target.
        met: usize,
        /// Number of those that stay clear of the walls in the model.
        within: usize,
        /// \[m\]
        margin: f64,
    },
}

impl Family {
    /// Joint angles of the common shape \[rad\].
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

    /// Net motion from the straight shape to the common one.
    fn way_in(&self, model: &Model<f64>) -> Pose<f64> {
        leads_to(model, &Polyline::new([Vector2::zeros(), self.shape()]))
    }
}

/// Searches for the quickest plan, with bounded work. `watch` receives the fraction of that work that is done.
///
/// # Errors
/// [`PlanError`].
///
/// ```
/// use forecast::{PlanRequest, Family, PlanError, Servos, plan};
/// use nalgebra::Vector2;
/// use swimmer_files::{AnyGait, ServoFile};
/// use swimmer_model::{Model, Pose, Swimmer};
///
/// let model = Model::new(&Swimmer::robot()).unwrap();
/// // Circles of three sizes start at three shapes: they do not join.
/// let gaits = [0.8, 1.0, 1.2].map(|amplitude| (AnyGait::circle(amplitude), 10.0));
/// let to = Vector2::new(0.2, 0.1);
/// let servos = Servos::on_the_robot(ServoFile::default());
/// let request = PlanRequest { from: Pose::identity(), to, heading: None, tank: None, margin: 0.005, servos };
/// let refused = plan(&model, &Family { gaits, mirrored: false }, &request, &|_| ()).unwrap_err();
/// assert!(matches!(refused, PlanError::Apart { apart } if (apart - 0.4).abs() < 1e-12));
/// ```
pub fn plan(
    model: &Model<f64>,
    family: &Family,
    request: &PlanRequest,
    watch: Watch<'_>,
) -> Result<Plan, PlanError> {
    family.check_joined()?;
    check_ends(model, request)?;
    let walls = Walls::new(model, request.tank, request.margin);
    check_bent_ends(model, &walls, family, request)?;
    let nets = Nets::new(model, family, &request.servos).map_err(|error| PlanError::Refused {
        gait: "fastest",
        reason: error.to_string(),
    })?;
    // Next to a wall the swimmer may fit only if it bends away from it.
    let images = [(family.clone(), &nets), (family.mirror(), &nets.mirror())];
    let (mut counts, mut budget) = (SearchCounts::default(), Budget::new(watch));
    for effort in &EFFORTS {
        let spared_walls = Walls::new(model, request.tank, request.margin + effort.spare);
        let mut found = None;
        for (family, nets) in &images {
            let swept = SweptAreas::default();
            let search = PlanSearch {
                model,
                request,
                walls: &walls,
                sweeps: Sweeps::new(&spared_walls, nets, family, &swept),
                effort,
            };
            budget.start(effort.budget);
            found = search.quickest(found, &mut counts, &mut budget);
        }
        if let Some(found) = found {
            return Ok(Plan {
                met: counts.met,
                ..found
            });
        }
    }
    Err(counts.refused.unwrap_or(PlanError::NoWay {
        met: counts.met[0],
        within: counts.met[1],
        margin: request.margin,
    }))
}

/// Refuses a start or a target at which the straight swimmer does not fit into the tank. This check needs no gaits, so it can
/// precede their search.
///
/// # Errors
/// [`PlanError::Outside`], [`PlanError::TargetOutside`].
pub fn check_ends(model: &Model<f64>, request: &PlanRequest) -> Result<(), PlanError> {
    let walls = Walls::new(model, request.tank, request.margin);
    let fits = |pose: &Pose<f64>| walls.fits(pose, &Vector2::zeros());
    let outside = |what, pose: &Pose<f64>| PlanError::Outside {
        what,
        pose: [pose.x, pose.y, pose.theta],
        margin: request.margin,
    };
    if !fits(&request.from) {
        return Err(outside("at the start", &request.from));
    }
    let targets = ends(request);
    if targets.iter().any(fits) {
        return Ok(());
    }
    Err(match (request.heading, &targets[..]) {
        (Some(_), [target]) => outside("at the target", target),
        _ => PlanError::TargetOutside {
            to: request.to.into(),
            margin: request.margin,
        },
    })
}

/// Refuses a start or, if its heading is given, a target at which the swimmer can be bent to neither side.
fn check_bent_ends(
    model: &Model<f64>,
    walls: &Walls<'_>,
    family: &Family,
    request: &PlanRequest,
) -> Result<(), PlanError> {
    let to = request
        .heading
        .map(|heading| Pose::new(request.to.x, request.to.y, heading));
    for (what, pose) in [("at the start", Some(request.from)), ("at the target", to)] {
        let Some(pose) = pose else { continue };
        let bent = |family: &Family| walls.fits(&(pose * family.way_in(model)), &family.shape());
        if !bent(family) && !bent(&family.mirror()) {
            return Err(PlanError::Bent {
                what,
                pose: [pose.x, pose.y, pose.theta],
                shape: family.shape().into(),
                margin: request.margin,
            });
        }
    }
    Ok(())
}

/// Distance of two poses \[m\], and angle between their headings \[rad\].
fn distance(one: &Pose<f64>, other: &Pose<f64>) -> [f64; 2] {
    [
        (one.position() - other.position()).norm(),
        wrapped_angle(one.theta - other.theta).abs(),
    ]
}

impl Plan {
    fn new(request: &PlanRequest, family: &Family, hit: Hit) -> Self {
        let heading = request.heading.unwrap_or(hit.reached.theta);
        Self {
            duration: duration(&hit.steps),
            off: distance(
                &hit.reached,
                &Pose::new(request.to.x, request.to.y, heading),
            ),
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

    /// Name of a step: `forward`, `backward`, `left`, `right`, `turn-left`, `turn-right`.
    pub fn word(&self, step: &Step) -> &'static str {
        step.member.word(self.mirrored)
    }

    /// End pose of another swimmer that plays this plan.
    pub fn reached_by(&self, model: &Model<f64>, from: &Pose<f64>) -> Pose<f64> {
        *from * leads_to(model, &self.way)
    }

    /// Distance of a pose to the end pose of the plan \[m\], and difference of the heading \[rad\].
    pub fn apart_from(&self, pose: &Pose<f64>) -> [f64; 2] {
        distance(&self.reached, pose)
    }
}

fn duration(steps: &[Step]) -> f64 {
    let of = |step: &Step| f64::from(step.cycles) * step.period;
    steps.iter().map(of).sum()
}
