//! Integration of an arc of greatest displacement up to the event that ends it, for quarters and for closed curves.
//!
//! ```text
//!                a bound is reached
//!   singular ──────────────────────────► along that bound ──┐ its next piece,
//!      ▲  │                                 │    ▲          │ or another bound
//!      │  │                                 │    └──────────┘
//!      │  └────────► the chain's own end ◄──┤
//!      └────────────────────────────────────┘
//!                the height falls to zero
//! ```
//!
//! On entering a bound the height is zero as well, but rising. The exit event is a *falling* zero, so it is armed only after the
//! arc has left that neighbourhood.

mod event;
mod trace;

pub(crate) use event::Event;
use event::{MOST_EVENTS, Watched, first_event};
pub(crate) use trace::{ByPower, SMOOTH, sampled};

use crate::momentum::{Flow, Motion, State, shape};
use crate::numerics::locate;
use crate::region::{Bound, Region};
use crate::runge_kutta::{Point, StepControl, controlled_step, exact_step};

/// Arc of a chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Leg {
    pub(crate) motion: Motion,
    pub(crate) from: State,
    pub(crate) to: State,
    /// Length in the (φ₁, φ₂) plane \[rad\].
    pub(crate) length: f64,
}

/// End condition of a chain of arcs.
pub(crate) trait EndCondition {
    /// Kind of an end.
    type End: Copy + PartialEq;

    /// Ends that can occur along such an arc.
    fn watched(&self, motion: &Motion) -> impl Iterator<Item = Self::End>;

    /// Value that falls through zero at the end of the chain, with its slope along the arc.
    fn value(&self, end: Self::End, at: &Point<6>) -> (f64, f64);

    /// Returns `true` if the end counts within a step up to a point at which the chain has this length \[rad\].
    fn counts(&self, _end: Self::End, _after: &Point<6>, _length: f64) -> bool {
        true
    }

    /// Returns `true` if the end precedes a bound that is reached at the same point.
    fn precedes_bounds(_end: Self::End) -> bool {
        false
    }

    /// Returns `true` if a bound ends such an arc.
    fn stops_at(&self, _bound: &Bound, _motion: &Motion) -> bool {
        true
    }
}

/// Integrator of arcs with its settings.
pub(crate) struct Tracer<'a, C> {
    pub(crate) flow: Flow<'a>,
    pub(crate) region: &'a Region,
    pub(crate) control: StepControl,
    /// `true` if an arc leaves its bound when the height falls to zero.
    pub(crate) leaves: bool,
    pub(crate) ends: &'a C,
    /// Length of the chain before this arc \[rad\]; the next field is its limit.
    pub(crate) before: f64,
    pub(crate) longest: f64,
}

/// Largest number of steps of an arc. Steps become arbitrarily small where the zero of the height has no direction.
const MOST_STEPS: usize = 600;

impl<C: EndCondition> Tracer<'_, C> {
    /// Integrates arc after arc from a state, up to a limit. `next` returns the following arc or the result. Returns `None` if the chain
    /// does not end.
    pub(crate) fn chain<F>(
        mut self,
        start: State,
        most: usize,
        mut next: impl FnMut(&Self, &Leg, Option<Event<C::End>>) -> Result<Motion, F>,
    ) -> (Vec<Leg>, Option<F>) {
        let mut legs: Vec<Leg> = Vec::with_capacity(most);
        while legs.len() < most {
            let (leg, event) = self.arc(legs.last().map_or(start, |leg| leg.to));
            self.before += leg.length;
            legs.push(leg);
            match next(&self, &leg, event) {
                Ok(motion) => self.flow.motion = motion,
                Err(fate) => return (legs, Some(fate)),
            }
        }
        (legs, None)
    }

    /// Integrates to the first event. The event is `None` if a step fails or the chain becomes too long.
    fn arc(&self, start: State) -> (Leg, Option<Event<C::End>>) {
        let leg = |to: State, length: f64| Leg {
            motion: self.flow.motion,
            from: start,
            to,
            length,
        };
        let mut here = Point::new(&self.flow, start);
        let mut watched = self.watch(&here);
        let mut length = 0.0;
        // Approximate step length of a method of order eight.
        let mut try_length = 2.0 * self.control.tolerance.powf(0.125);
        for _ in 0..MOST_STEPS {
            if self.before + length >= self.longest {
                break;
            }
            let step = controlled_step(&self.flow, &here, try_length, self.control);
            let Some(step) = step else { break };
            let after = self.watch(&step.end);
            let travelled = self.before + length + step.length;
            let counts = |event: &Event<C::End>| match event {
                Event::End(end) => self.ends.counts(*end, &step.end, travelled),
                _ => true,
            };
            let precedes = |event: &Event<C::End>| matches!(event, Event::End(end) if C::precedes_bounds(*end));
            if let Some((event, at)) =
                first_event((&watched, &after), step.length, counts, precedes)
            {
                let (end, at) = self.located(&here, event, at, step.length);
                return (leg(end, length + at), Some(event));
            }
            here = step.end;
            watched = after;
            length += step.length;
            try_length = step.next;
        }
        (leg(here.z, length), None)
    }

    /// Value and slope of every event at a point.
    fn watch(&self, at: &Point<6>) -> Watched<C::End> {
        let mut watched = [None; MOST_EVENTS];
        let mut slots = watched.iter_mut();
        let mut add = |event| {
            if let Some(slot) = slots.next() {
                let (value, slope) = self.value(event, at);
                *slot = Some((event, value, slope));
            }
        };
        let motion = &self.flow.motion;
        let own = motion.bound();
        if own.is_some() && self.leaves {
            add(Event::HeightGone);
        }
        if motion.piece_end(&shape(&at.z)).is_some() {
            add(Event::PieceEnd);
        }
        for (index, bound) in self.region.bounds().enumerate() {
            if Some(index) != own && self.ends.stops_at(&bound, motion) {
                add(Event::Bound(index));
            }
        }
        self.ends.watched(motion).map(Event::End).for_each(add);
        watched
    }

    fn value(&self, event: Event<C::End>, at: &Point<6>) -> (f64, f64) {
        let (phi, rate) = (shape(&at.z), shape(&at.rate));
        match event {
            Event::Bound(index) => self.region.bound(index).map_or((1.0, 0.0), |bound| {
                (bound.margin(&phi), bound.gradient(&phi).dot(&rate))
            }),
            Event::PieceEnd => {
                let end = self.flow.motion.piece_end(&phi);
                end.map_or((1.0, 0.0), |(left, slope)| (left, slope.dot(&rate)))
            }
            // The height if the region is on the left of the motion, minus the height if it is on the right (paper, exit
            // criterion, with the sign of a maximum).
            Event::HeightGone => match self.flow.motion {
                Motion::Along(track) => {
                    let height = self.flow.height(&at.z);
                    (
                        track.way * height.value,
                        track.way * height.gradient.dot(&rate),
                    )
                }
                Motion::Singular => (1.0, 0.0),
            },
            Event::End(end) => self.ends.value(end, at),
        }
    }

    /// Shortens the step to end at the zero of the event's value.
    fn located(
        &self,
        here: &Point<6>,
        event: Event<C::End>,
        guess: f64,
        longest: f64,
    ) -> (State, f64) {
        let at = |length| Some(exact_step(&self.flow, here, length));
        let value = |at: &Point<6>| self.value(event, at);
        let Some((there, length)) =
            locate([guess, longest], 0.01 * self.control.tolerance, at, value)
        else {
            return (here.z, 0.0);
        };
        let mut z = there.z;
        if let Event::Bound(index) = event
            && let Some(bound) = self.region.bound(index)
        {
            let on = bound.onto(&shape(&z));
            (z[0], z[1]) = (on.x, on.y);
        }
        (z, length)
    }
}
