//! One orbit: arc after arc, each ended by an event, until the start is met again.

use nalgebra::Vector2;
use swimmer_model::Model;

use crate::momentum::{Flow, Momentum, Motion, State, Track, shape};
use crate::region::{Bound, Region};
use crate::runge_kutta::{Point, StepControl, controlled_step, exact_step, locate};

/// One arc of an orbit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Leg {
    pub(crate) motion: Motion,
    pub(crate) from: State,
    pub(crate) to: State,
}

/// Most arcs of an orbit.
const MOST_ARCS: usize = 24;
/// Longest orbit \[rad\].
const LONGEST: f64 = 60.0;
/// Most steps of an arc: where steps shrink to nothing the zero of the height has no direction.
const MOST_STEPS: usize = 600;
/// An orbit that reaches its start's bound this near to the start has returned \[rad\].
const AT_START: f64 = 1e-7;
/// The height may start this much below zero on a bound, over L.
const SLACK: f64 = 1e-9;

/// An orbit that came back, or not.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ClosedOrbit {
    pub(crate) legs: Vec<Leg>,
    pub(crate) end: State,
}

/// What ends an orbit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ReturnCondition {
    /// Leaving the bound with this index near the start.
    Exit(usize),
    /// Crossing the line across the curve at the start.
    Line,
    /// Passing the start on the straight bound with this index, or reaching that bound there.
    Along(usize),
}

/// Where an orbit begins and what ends it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Launch<'a> {
    pub(crate) model: &'a Model<f64>,
    pub(crate) region: &'a Region,
    pub(crate) momentum: Momentum,
    pub(crate) start: Vector2<f64>,
    /// What the first arc runs along.
    pub(crate) first: Motion,
    pub(crate) until: ReturnCondition,
    /// Direction of the curve at the start.
    pub(crate) ahead: Vector2<f64>,
    /// No end before this much of the curve \[rad\] …
    pub(crate) shortest: f64,
    /// … and no end farther than this from the start \[rad\].
    pub(crate) near: f64,
    pub(crate) control: StepControl,
}

/// What ended an arc.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Event {
    Reached(usize),
    HeightGone,
    PieceEnd,
    Returned,
}

impl Launch<'_> {
    /// Runs the orbit; none where it does not come back.
    pub(crate) fn orbit(&self) -> Option<ClosedOrbit> {
        let mut orbit = ClosedOrbit {
            legs: Vec::with_capacity(8),
            end: [self.start.x, self.start.y, 0.0, 0.0, 0.0, 0.0],
        };
        let mut motion = self.first;
        let mut travelled = 0.0;
        for _ in 0..MOST_ARCS {
            let drive = Flow {
                model: self.model,
                momentum: self.momentum,
                motion,
            };
            let (end, event, length) = self.arc(&drive, orbit.end, travelled)?;
            orbit.legs.push(Leg {
                motion,
                from: orbit.end,
                to: end,
            });
            orbit.end = end;
            travelled += length;
            let phi = shape(&end);
            match event {
                Event::Returned => return Some(orbit),
                Event::HeightGone => {
                    let returned = bound_of(&motion).map(ReturnCondition::Exit) == Some(self.until)
                        && travelled > self.shortest
                        && (phi - self.start).norm() < self.near;
                    if returned {
                        return Some(orbit);
                    }
                    motion = Motion::Singular;
                }
                Event::Reached(index)
                    if self.until == ReturnCondition::Along(index)
                        && travelled > self.shortest
                        && (phi - self.start).norm() < AT_START =>
                {
                    return Some(orbit);
                }
                Event::Reached(index) => {
                    motion = along(self.region, index, &phi, &motion)?;
                }
                Event::PieceEnd => {
                    let Motion::Along(track) = motion else {
                        return None;
                    };
                    motion = Motion::Along(track.next_piece()?);
                }
            }
        }
        None
    }

    /// Integrates to the first event.
    fn arc(&self, drive: &Flow<'_>, start: State, before: f64) -> Option<(State, Event, f64)> {
        let mut here = Point::new(drive, start);
        let mut length = 0.0;
        let mut try_length: f64 = 0.05;
        let own = bound_of(&drive.motion);
        if own.is_some() {
            // The height must rise where a bound is met, or be positive already.
            let ahead = exact_step(drive, &here, 1e-5);
            let height = drive.height(&ahead.z);
            if height.value < -SLACK {
                return None;
            }
        }
        for _ in 0..MOST_STEPS {
            if before + length > LONGEST {
                return None;
            }
            let step = controlled_step(drive, &here, try_length.min(0.15), self.control)?;
            let mut first: Option<(f64, Event)> = None;
            let mut consider = |event: Event, from: f64, to: f64| {
                if from > 0.0 && to <= 0.0 {
                    let at = step.length * from / (from - to);
                    if first.is_none_or(|(earliest, _)| at < earliest) {
                        first = Some((at, event));
                    }
                }
            };
            for (index, bound) in self.region.bounds().enumerate() {
                if Some(index) != own {
                    let event = Event::Reached(index);
                    let (from, to) = (shape(&here.z), shape(&step.end.z));
                    consider(event, bound.margin(&from), bound.margin(&to));
                }
            }
            let far_enough = before + length + step.length > self.shortest;
            if own.is_some()
                && self.until == own.map_or(ReturnCondition::Line, ReturnCondition::Along)
                && far_enough
            {
                let event = Event::Returned;
                consider(
                    event,
                    self.value(drive, event, &here).0,
                    self.value(drive, event, &step.end).0,
                );
            }
            if own.is_some() {
                let event = Event::HeightGone;
                consider(
                    event,
                    self.value(drive, event, &here).0,
                    self.value(drive, event, &step.end).0,
                );
                let event = Event::PieceEnd;
                consider(
                    event,
                    self.value(drive, event, &here).0,
                    self.value(drive, event, &step.end).0,
                );
            } else if self.until == ReturnCondition::Line && far_enough {
                let event = Event::Returned;
                let near = (shape(&step.end.z) - self.start).norm() < self.near;
                let (from, to) = (
                    self.value(drive, event, &here).0,
                    self.value(drive, event, &step.end).0,
                );
                if near {
                    consider(event, from, to);
                }
            }
            if let Some((guess, event)) = first {
                let (end, at) = self.locate(drive, &here, event, guess, step.length)?;
                return Some((end, event, length + at));
            }
            here = step.end;
            length += step.length;
            try_length = step.next;
        }
        None
    }

    /// A value that falls through zero where the event is, with its slope.
    fn value(&self, drive: &Flow<'_>, event: Event, at: &Point<6>) -> (f64, f64) {
        let (phi, rate) = (shape(&at.z), shape(&at.rate));
        match event {
            Event::Reached(index) => self.region.bound(index).map_or((1.0, 0.0), |bound| {
                (bound.margin(&phi), bound.gradient(&phi).dot(&rate))
            }),
            Event::HeightGone => {
                let height = drive.height(&at.z);
                (height.value, height.gradient.dot(&rate))
            }
            Event::PieceEnd => match drive.motion {
                Motion::Along(track) => track.piece_end(&phi),
                Motion::Singular => None,
            }
            .map_or((1.0, 0.0), |(left, slope)| (left, slope.dot(&rate))),
            Event::Returned => (-(phi - self.start).dot(&self.ahead), -rate.dot(&self.ahead)),
        }
    }

    /// Cuts the step where the event is.
    fn locate(
        &self,
        drive: &Flow<'_>,
        here: &Point<6>,
        event: Event,
        guess: f64,
        longest: f64,
    ) -> Option<(State, f64)> {
        let at = |length| Some(exact_step(drive, here, length));
        let value = |at: &Point<6>| self.value(drive, event, at);
        let (there, length) = locate([guess, longest], at, value)?;
        let mut z = there.z;
        if let Event::Reached(index) = event
            && let Some(bound) = self.region.bound(index)
        {
            let on = bound.onto(&shape(&z));
            (z[0], z[1]) = (on.x, on.y);
        }
        Some((z, length))
    }
}

fn bound_of(motion: &Motion) -> Option<usize> {
    match motion {
        Motion::Singular => None,
        Motion::Along(track) => Some(track.index),
    }
}

/// What follows when a bound is met.
fn along(region: &Region, index: usize, phi: &Vector2<f64>, before: &Motion) -> Option<Motion> {
    let track = Track::new(region, index, phi, 1.0)?;
    // From one straight bound to the next the way must lead on inside both.
    if let Motion::Along(before) = before
        && matches!(before.bound, Bound::Straight(_))
        && before.direction(phi).perp(&track.direction(phi)) <= 0.0
    {
        return None;
    }
    Some(Motion::Along(track))
}
