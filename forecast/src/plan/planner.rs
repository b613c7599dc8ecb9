//! Planning from cycle to cycle: the net motions of a family are computed once, then chains of cycles to many targets.
//!
//! Poses are those of the straight swimmer: the robot straightens at the end of every play. Between two plays the ways to the
//! common shape and back undo each other, so a chain of plays leads where the same cycles lead without a rest between them.

use swimmer_model::{Model, Pose};

use super::legs::{LARGEST, settled};
use super::member::Nets;
use super::search::{SearchCounts, legs_between};
use super::walls::{Sweeps, SweptAreas, Walls};
use super::way_out::ways_out;
use super::{Family, Member, PlanError, Scaled, Step, duration};
use crate::losses::Servos;
use crate::playlist::{PlaylistTable, tables};
use crate::tank::Tank;

/// Largest number of pairs of ways out, if the walls are too close for the largest cycles.
const PAIRS: usize = 40;

/// Plans to many targets with one family of gaits.
///
/// ```
/// use forecast::{Family, Kind, Member, Planner, Servos};
/// use swimmer_files::{AnyGait, ServoFile};
/// use swimmer_model::{Model, Swimmer};
///
/// let model = Model::new(&Swimmer::robot()).unwrap();
/// let servos = Servos::on_the_robot(ServoFile::default());
/// let circle = || (AnyGait::circle(1.0), 4.0);
/// let family = Family { gaits: [circle(), circle(), circle()], mirrored: false };
/// let mut planner = Planner::new(model, family, servos, None, 0.0).unwrap();
/// let member = Member { kind: Kind::Forward, backwards: false, scale: 1.0 };
/// let predicted = planner.net(&member).position().norm();
/// planner.set_gains([1.1, 1.0, 1.0]);
/// assert!((planner.net(&member).position().norm() / predicted - 1.1).abs() < 0.01);
/// ```
#[derive(Debug, Clone)]
pub struct Planner {
    model: Model<f64>,
    family: Family,
    servos: Servos,
    tank: Option<Tank>,
    margin: f64,
    nets: Nets,
    swept: SweptAreas,
    way_in: Pose<f64>,
}

impl Planner {
    /// A planner for these gaits in this tank (`None`: open water). No part of the body comes nearer to a wall than `margin`
    /// \[m\].
    ///
    /// # Errors
    /// [`PlanError::Apart`] if the gaits do not join, [`PlanError::Refused`] if an angle does not fit a table.
    pub fn new(
        model: Model<f64>,
        family: Family,
        servos: Servos,
        tank: Option<Tank>,
        margin: f64,
    ) -> Result<Self, PlanError> {
        family.check_joined()?;
        let nets = Nets::new(&model, &family, &servos).map_err(|error| PlanError::Refused {
            gait: "fastest",
            reason: error.to_string(),
        })?;
        let way_in = family.way_in(&model);
        Ok(Self {
            model,
            family,
            servos,
            tank,
            margin,
            nets,
            swept: SweptAreas::default(),
            way_in,
        })
    }

    /// Multiplies the predicted motion of each kind (forward, left, turn) along its screw: gains that a robot shows.
    pub fn set_gains(&mut self, gains: [f64; 3]) {
        self.nets.gains = gains;
    }

    /// Net motion of one cycle between two rests, in the frame of the straight swimmer at its start.
    pub fn net(&self, member: &Member) -> Pose<f64> {
        self.net_at_gain(member, self.nets.gains[member.kind as usize])
    }

    /// The same at another gain of its kind.
    pub fn net_at_gain(&self, member: &Member, gain: f64) -> Pose<f64> {
        self.way_in * self.nets.at_gain(member, gain) * self.way_in.inverse()
    }

    /// Cycles of a member at the servos' full rate.
    pub fn step(&self, member: Member, cycles: u32) -> Step {
        self.nets.step(member, cycles)
    }

    /// The member of this kind whose cycle has the share `amount` of the full-size motion; negative: run backwards.
    pub fn member(&self, kind: super::Kind, amount: f64) -> Member {
        Member {
            backwards: amount < 0.0,
            ..kind.of_scale(self.nets.scale(kind, amount.abs().min(1.0)))
        }
    }

    /// The table that the robot plays for one step, checked as the robot checks it.
    ///
    /// # Errors
    /// [`PlanError::Refused`]: the robot would not play it.
    pub fn checked_table(&self, step: &Step) -> Result<PlaylistTable, PlanError> {
        let refused = |reason: String| PlanError::Refused {
            gait: step.member.word(self.family.mirrored),
            reason,
        };
        let tables = tables(&[step.repeated(&self.family)]);
        let mut tables = tables.map_err(|error| refused(error.to_string()))?;
        let links = &self.model.swimmer().links;
        if let Some((_, reason)) = crate::playlist::refused(&tables, &self.servos, links) {
            return Err(refused(reason));
        }
        let table = tables.pop();
        table.ok_or_else(|| refused("a step without cycles".to_owned()))
    }

    /// The cycle of a member.
    pub fn gait(&self, member: &Member) -> Scaled {
        member.of(&self.family)
    }

    /// The model.
    pub fn model(&self) -> &Model<f64> {
        &self.model
    }

    /// The servos.
    pub fn servos(&self) -> &Servos {
        &self.servos
    }

    /// The walls, `None` for open water, and the distance \[m\] kept from them.
    pub fn tank(&self) -> (Option<Tank>, f64) {
        (self.tank, self.margin)
    }

    /// Returns `true` if the straight swimmer stays clear of the walls by the margin and `spare` \[m\] more.
    pub fn fits(&self, pose: &Pose<f64>, spare: f64) -> bool {
        let walls = Walls::new(&self.model, self.tank, self.margin + spare);
        walls.fits(pose, &nalgebra::Vector2::zeros())
    }

    /// Returns `true` if one cycle of a member from this pose stays clear of the walls by the margin and `spare` \[m\] more.
    pub fn stays_clear(&self, from: &Pose<f64>, member: &Member, spare: f64) -> bool {
        let walls = Walls::new(&self.model, self.tank, self.margin + spare);
        let sweeps = Sweeps::new(&walls, &self.nets, &self.family, &self.swept);
        sweeps.after(&(*from * self.way_in), member, 1).is_some()
    }

    /// The quickest chain of steps between two poses, with a rest of `pause` \[s\] after each cycle, that keeps `spare` \[m\] more
    /// than the margin from the walls. `None`: no chain does.
    pub fn chain(
        &self,
        from: &Pose<f64>,
        to: &Pose<f64>,
        spare: f64,
        pause: f64,
    ) -> Option<Vec<Step>> {
        let seconds = |steps: &[Step]| {
            let cycles: u32 = steps.iter().map(|step| step.cycles).sum();
            duration(steps) + pause * f64::from(cycles)
        };
        let walls = Walls::new(&self.model, self.tank, self.margin + spare);
        let sweeps = Sweeps::new(&walls, &self.nets, &self.family, &self.swept);
        let [from, to] = [from, to].map(|pose| *pose * self.way_in);
        let outward = ways_out(&sweeps, &from, false);
        let inward = ways_out(&sweeps, &to, false);
        let mut pairs: Vec<_> = outward
            .iter()
            .flat_map(|out| inward.iter().map(move |back| (out, back)))
            .map(|(out, back)| {
                let wanted = out.there.inverse() * back.there;
                let least = self.nets.least(&wanted) + out.duration + back.duration;
                (out, back, wanted, least)
            })
            .collect();
        pairs.sort_by(|a, b| a.3.total_cmp(&b.3));
        let mut best: Option<Vec<Step>> = None;
        for (out, back, wanted, least) in pairs.into_iter().take(PAIRS) {
            if best.as_ref().is_some_and(|best| seconds(best) < least) {
                break;
            }
            let legs = legs_between(&sweeps, &out.there, &wanted, &mut SearchCounts::default());
            let quickest = |a: &Vec<Step>, b: &Vec<Step>| seconds(a).total_cmp(&seconds(b));
            let Some(legs) = legs.into_iter().min_by(quickest) else {
                continue;
            };
            let undone: Vec<Step> = back.steps.iter().rev().map(Step::undone).collect();
            let chain = [out.steps.clone(), legs, undone].concat();
            if best
                .as_ref()
                .is_none_or(|best| seconds(&chain) < seconds(best))
            {
                best = Some(chain);
            }
        }
        best
    }

    /// The same steps with the nearest scales that lead from one pose to another, and with more cycles if a scale would exceed 1.
    /// `None` if no scales do within the walls; fewer than three steps seldom can.
    pub fn adjusted(
        &self,
        from: &Pose<f64>,
        to: &Pose<f64>,
        steps: &[Step],
        spare: f64,
    ) -> Option<Vec<Step>> {
        let walls = Walls::new(&self.model, self.tank, self.margin + spare);
        let sweeps = Sweeps::new(&walls, &self.nets, &self.family, &self.swept);
        let [from, to] = [from, to].map(|pose| *pose * self.way_in);
        let steps = settled(&self.nets, &(from.inverse() * to), steps, LARGEST)?;
        steps.iter().try_fold(from, |pose, step| {
            sweeps.after(&pose, &step.member, step.cycles)
        })?;
        Some(steps)
    }

    /// Pose after a chain of steps.
    pub fn after(&self, from: &Pose<f64>, steps: &[Step]) -> Pose<f64> {
        *from * self.way_in * self.nets.after(steps) * self.way_in.inverse()
    }
}
