//! Choice of the next cycle.

use forecast::{Kind, Member, Step};
use swimmer_model::{Pose, wrapped_angle};

use super::{Controller, Ending, Goal, Target};

/// A target counts as reached within this share of the tolerance: the rest is left to the errors of the tracking.
const REACHED: f64 = 0.8;
/// Legs that move less than this share of the tolerance are put off: what follows moves more.
const PUT_OFF: f64 = 0.2;
/// Shares of the full motion that are tried if no chain is found.
const AMOUNTS: [f64; 7] = [1.0, 0.7, 0.5, 0.3, 0.2, 0.1, 0.05];
/// Steps that scales can adjust to a pose.
const COORDINATES: usize = 3;
/// Share of the full motion of a step that is added for an adjustment.
const SMALL: f64 = 0.3;
/// Limits of an adjusted chain, in duration and cycles relative to the former one: beyond them it is planned anew.
const LONGER: f64 = 1.1;
const MORE_CYCLES: f64 = 4.0;
/// A chain that leads so near to the target \[m, rad\] goes on without an adjustment.
const NEAR: [f64; 2] = [0.015, 0.1];
/// Rounds in which the time to the target and the drift during it are brought together.
const ROUNDS: usize = 2;

impl Controller {
    /// The next cycle from a pose at rest.
    ///
    /// # Errors
    /// The ending, if there is no next cycle.
    pub(super) fn choose(&mut self, here: &Pose<f64>) -> Result<Member, Ending> {
        match self.goal.clone() {
            Goal::Reach(targets) => self.towards(here, &targets),
            Goal::Hold {
                heading_rad,
                cycles,
            } => self.holding(here, heading_rad, cycles),
        }
    }

    fn towards(&mut self, here: &Pose<f64>, targets: &[Target]) -> Result<Member, Ending> {
        let to = loop {
            let Some(target) = targets.get(self.target) else {
                return Err(Ending::Reached);
            };
            let heading = target.heading_rad.unwrap_or(here.theta);
            let to = Pose::new(target.x_m, target.y_m, heading);
            let off = (here.position() - to.position()).norm();
            let turn = wrapped_angle(here.theta - heading).abs();
            if off > REACHED * self.options.within_m || turn > REACHED * self.options.within_rad {
                break to;
            }
            if self.target + 1 == targets.len() {
                return Err(Ending::Reached);
            }
            self.target += 1;
        };
        if self.cycles >= self.options.most_cycles {
            return Err(Ending::TooManyCycles(self.cycles));
        }
        if !self.planner.fits(&to, 0.0) {
            return Err(Ending::NoWay);
        }
        let kept = std::mem::take(&mut self.chain);
        let Some(mut chain) = self
            .adjusted(here, &to, &kept)
            .or_else(|| self.planned(here, &to))
        else {
            // A leg would be smaller than the smallest cycle.
            return self.nearest(here, &to).ok_or(Ending::NoWay);
        };
        let stays_clear = |step: &Step| self.planner.stays_clear(here, &step.member, 0.0);
        // Legs that are put off come last.
        let first = chain
            .iter()
            .position(|step| !self.is_put_off(step) && stays_clear(step))
            .or_else(|| chain.iter().position(stays_clear));
        let first = first.ok_or(Ending::NoWay)?;
        let step = &mut chain[first];
        let member = step.member;
        step.cycles -= 1;
        chain.retain(|step| step.cycles > 0);
        self.chain = chain;
        Ok(member)
    }

    /// A target that the drift will have moved to `to` by the time that these steps are done.
    fn upstream(&self, to: &Pose<f64>, steps: &[Step]) -> Pose<f64> {
        let drift = self.learning.drift() * self.total_seconds(steps);
        Pose::new(to.x - drift.x, to.y - drift.y, to.theta)
    }

    /// Remainder of the previous chain, adjusted to the pose that it has led to; unchanged if no adjustment is found and it ends
    /// near the target.
    fn adjusted(&self, here: &Pose<f64>, to: &Pose<f64>, kept: &[Step]) -> Option<Vec<Step>> {
        if kept.is_empty() {
            return None;
        }
        let upstream = self.upstream(to, kept);
        let adjusted = self.extended(kept).into_iter().filter_map(|steps| {
            let steps = self
                .planner
                .adjusted(here, &upstream, &steps, self.options.spare_m)?;
            Some((self.total_seconds(&steps), steps))
        });
        let best = adjusted.min_by(|a, b| a.0.total_cmp(&b.0));
        let longest = LONGER * self.total_seconds(kept) + MORE_CYCLES * self.pause_s;
        if let Some((_, steps)) = best.filter(|(seconds, _)| *seconds < longest) {
            return Some(steps);
        }
        let end = self.planner.after(here, kept);
        let near = (end.position() - upstream.position()).norm() < NEAR[0]
            && wrapped_angle(end.theta - upstream.theta).abs() < NEAR[1];
        near.then(|| kept.to_vec())
    }

    /// Some steps with a small one of each missing kind, in either sense, until there are as many as coordinates.
    fn extended(&self, kept: &[Step]) -> Vec<Vec<Step>> {
        let missing = Kind::ALL
            .into_iter()
            .filter(|kind| kept.iter().all(|step| step.member.kind != *kind));
        let mut extended = vec![kept.to_vec()];
        for kind in missing.take(COORDINATES.saturating_sub(kept.len())) {
            extended = extended
                .into_iter()
                .flat_map(|steps| {
                    [SMALL, -SMALL].map(|amount| {
                        let step = self.planner.step(self.planner.member(kind, amount), 1);
                        [steps.clone(), vec![step]].concat()
                    })
                })
                .collect();
        }
        extended
    }

    /// The quickest chain; the tank drifts meanwhile, so it aims upstream.
    fn planned(&self, here: &Pose<f64>, to: &Pose<f64>) -> Option<Vec<Step>> {
        let mut chain = Vec::new();
        for _ in 0..ROUNDS {
            let upstream = self.upstream(to, &chain);
            chain = [self.options.spare_m, 0.0]
                .into_iter()
                .find_map(|spare| self.planner.chain(here, &upstream, spare, self.pause_s))?;
        }
        Some(chain)
    }

    /// The cycle that leads nearest to a pose; `None` if none leads nearer than the robot is.
    fn nearest(&self, here: &Pose<f64>, to: &Pose<f64>) -> Option<Member> {
        let miss = |pose: &Pose<f64>| {
            (pose.position() - to.position()).norm() / self.options.within_m
                + wrapped_angle(pose.theta - to.theta).abs() / self.options.within_rad
        };
        let members = Kind::ALL.into_iter().flat_map(|kind| {
            AMOUNTS.into_iter().flat_map(move |amount| {
                [amount, -amount].map(|amount| self.planner.member(kind, amount))
            })
        });
        let leads = members
            .filter(|member| self.planner.stays_clear(here, member, 0.0))
            .map(|member| (miss(&(*here * self.planner.net(&member))), member));
        let (least, member) = leads.min_by(|a, b| a.0.total_cmp(&b.0))?;
        (least < miss(here)).then_some(member)
    }

    /// Time that some steps take, with the rests between their cycles \[s\].
    fn total_seconds(&self, steps: &[Step]) -> f64 {
        let seconds = |step: &Step| f64::from(step.cycles) * (step.period + self.pause_s);
        steps.iter().map(seconds).sum()
    }

    fn is_put_off(&self, step: &Step) -> bool {
        let net = self.planner.net(&step.member);
        let cycles = f64::from(step.cycles);
        cycles * net.position().norm() < PUT_OFF * self.options.within_m
            && cycles * net.theta.abs() < PUT_OFF * self.options.within_rad
    }

    fn holding(&mut self, here: &Pose<f64>, heading: f64, cycles: u32) -> Result<Member, Ending> {
        let error = wrapped_angle(here.theta - heading);
        if self.forward_cycles > 0 {
            self.worst_heading_rad = self.worst_heading_rad.max(error.abs());
        }
        let turn = self
            .planner
            .net(&self.planner.member(Kind::Turn, 1.0))
            .theta;
        let correcting = error.abs() > 0.5 * self.options.within_rad;
        let member = if correcting {
            self.planner
                .member(Kind::Turn, (-error / turn).clamp(-1.0, 1.0))
        } else if self.forward_cycles >= cycles {
            return Err(Ending::Held {
                worst_rad: self.worst_heading_rad,
            });
        } else {
            self.planner.member(Kind::Forward, 1.0)
        };
        if self.cycles >= self.options.most_cycles {
            return Err(Ending::TooManyCycles(self.cycles));
        }
        let stays_clear = self
            .planner
            .stays_clear(here, &member, self.options.spare_m);
        if stays_clear {
            Ok(member)
        } else {
            Err(Ending::NoWay)
        }
    }
}
