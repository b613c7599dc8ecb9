//! One extremal, from a place on a family to where it ends: traced once up to φ₁ = −φ₂, and on from there for each line.

use super::super::ExtremalOutcomes;
use super::super::flow::{
    DiagonalContacts, FINE, Quarter, Touch, TraceEnd, TraceOptions, follow, nonempty_legs,
};
use super::super::start_family::{StartFamily, StartState};
use super::{Candidate, MIDDLING, QuarterBranch, Search};
use crate::momentum::{Flow, Motion, shape};
use crate::runge_kutta::StepControl;

/// A quarter up to where it first meets φ₁ = −φ₂, and what it was traced with.
pub(super) struct Shot<'a> {
    pub(super) quarter: Quarter,
    pub(super) final_y: f64,
    pub(super) flow: Flow<'a>,
    options: TraceOptions,
}

/// An extremal that ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Miss {
    /// λ₄ there, over L and λ₃.
    pub(crate) lambda4: f64,
    /// λ₃ x there, over L; below zero it heads the wrong way, and is no gait.
    pub(crate) carried: f64,
    /// Sequence of the arcs.
    pub(super) arcs: u64,
}

impl<'a> Search<'a> {
    /// The quarter that becomes singular at place p of a family, with its `y_f`. Returns `None` if the singular control would
    /// leave the region, or if no `y_f` makes the height vanish.
    pub(super) fn shoot(
        &self,
        family: &StartFamily,
        p: f64,
        control: StepControl,
    ) -> Option<Shot<'a>> {
        let place = self.place(family, p, control)?;
        let final_y = family.final_y(self.model, &place, p)?;
        let StartState { state, motion } = place;
        let phi = shape(&state);
        let flow = self.flow(final_y, Motion::Singular);
        let direction = flow.direction(&state);
        let inwards = match motion {
            Motion::Singular => direction.y - direction.x,
            Motion::Along(track) => track.inwards(&phi).dot(&direction),
        };
        let options = options(control, family.met(&state));
        (inwards > 0.0).then(|| Shot {
            quarter: follow(flow, self.region, state, options),
            final_y,
            flow,
            options,
        })
    }

    /// Quarter of a shot on its line. Returns `None` if it does not end properly.
    fn onwards(&self, shot: &Shot<'_>, line: QuarterBranch<'_>) -> Option<Quarter> {
        // From the end line a quarter has gone on along it already.
        let went_on = !line.family.may(Touch::Ends) && shot.quarter.touched();
        let quarter = if went_on || line.touch == Touch::Ends {
            shot.quarter.clone()
        } else {
            let flow = (shot.flow, self.region);
            shot.quarter.going_on(line.touch, flow, shot.options)?
        };
        quarter.ended().then_some(quarter)
    }

    /// The extremal of a shot on its line. Returns `None` if it does not end properly.
    pub(super) fn miss_of(&self, shot: &Shot<'_>, line: QuarterBranch<'_>) -> Option<Miss> {
        let quarter = self.onwards(shot, line)?;
        let arcs = nonempty_legs(&quarter.legs).fold(0, |arcs: u64, leg| {
            let arc = leg.motion.bound().map_or(1, |index| 2 + index as u64);
            arcs.wrapping_mul(31).wrapping_add(arc)
        });
        Some(Miss {
            lambda4: quarter.end[3] - shot.final_y,
            carried: self.sign * quarter.end[2],
            arcs,
        })
    }

    /// A place, one step of tolerance closer than what is followed from there.
    fn place(&self, family: &StartFamily, p: f64, control: StepControl) -> Option<StartState> {
        let coarse = control.tolerance > MIDDLING.tolerance;
        let flow = self.flow(0.0, Motion::Singular);
        family.place(flow, p, if coarse { MIDDLING } else { FINE })
    }

    /// The quarter that begins where a family does, where it ends.
    pub(super) fn whole(&self, line: QuarterBranch<'_>, final_y: f64) -> Option<Quarter> {
        let StartState { state, motion } = line.family.start()?;
        let flow = self.flow(final_y, motion);
        let options = options(FINE, DiagonalContacts::beginning(&state));
        let quarter = follow(flow, self.region, state, options);
        let shot = Shot {
            quarter,
            final_y,
            flow,
            options,
        };
        self.onwards(&shot, line)
    }

    /// A shot with all that comes before it.
    pub(super) fn begun(
        &self,
        line: QuarterBranch<'_>,
        p: f64,
        shot: &Shot<'_>,
    ) -> Option<Candidate> {
        let quarter = match line.family {
            StartFamily::StartLine { .. } => self.onwards(shot, line)?,
            // Again from the start: the multiplier itself must fall to zero at p.
            StartFamily::Bounds { .. } | StartFamily::EndLine { .. } => {
                let whole = self.whole(line, shot.final_y)?;
                let mut legs = whole.legs.iter();
                let left = legs.find(|leg| leg.motion == Motion::Singular)?;
                let place = self.place(line.family, p, FINE)?.state;
                ((shape(&left.from) - shape(&place)).norm() < 1e-6).then_some(whole)?
            }
        };
        Some(Candidate {
            quarter,
            momentum: shot.flow.momentum,
        })
    }
}

impl ExtremalOutcomes {
    /// Counts one more of those that end where they first meet φ₁ = −φ₂.
    pub(super) fn count(&mut self, shot: Option<&Shot<'_>>) {
        self.sent += 1;
        let Some(Shot {
            quarter, final_y, ..
        }) = shot
        else {
            self.wrong_way += 1;
            return;
        };
        match quarter.outcome {
            TraceEnd::Ended => {
                self.ended += 1;
                let missed = (quarter.end[3] - final_y).abs();
                let nearest = self.nearest.unwrap_or(f64::INFINITY).min(missed);
                self.nearest = Some(nearest);
            }
            TraceEnd::CameBack => self.came_back += 1,
            TraceEnd::LeftHorizon => self.left_horizon += 1,
            TraceEnd::Stalled | TraceEnd::TooManyArcs => self.lost += 1,
        }
    }
}

fn options(control: StepControl, met: DiagonalContacts) -> TraceOptions {
    TraceOptions {
        control,
        leaves: true,
        met,
    }
}
