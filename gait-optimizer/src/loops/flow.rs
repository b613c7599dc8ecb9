//! Integration of an orbit: arc after arc, each ended by an event, until the orbit returns to its start.

use nalgebra::Vector2;
use swimmer_model::Model;

use crate::arcs::{EndCondition, Event, Leg, Tracer};
use crate::momentum::{Flow, Momentum, Motion, State, Track, shape};
use crate::region::Region;
use crate::runge_kutta::{Point, StepControl, exact_step};

/// Largest number of arcs of an orbit.
const MOST_ARCS: usize = 24;
/// Largest length of an orbit \[rad\].
const LONGEST: f64 = 60.0;
/// Largest step \[rad\].
const LONGEST_STEP: f64 = 0.15;
/// Distance from the start, along its bound, within which an orbit has returned \[rad\].
const AT_START: f64 = 1e-7;
/// Largest negative height at the start of an arc on a bound, over L.
const SLACK: f64 = 1e-9;

/// Orbit that returned to its start.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ClosedOrbit {
    pub(crate) momentum: Momentum,
    pub(crate) legs: Vec<Leg>,
    pub(crate) end: State,
}

/// Condition for the return of an orbit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ReturnCondition {
    /// Leaving the bound with this index near the start.
    Exit(usize),
    /// Crossing the line across the curve at the start.
    Line,
    /// Passing the start on the straight bound with this index, or reaching that bound there.
    Along(usize),
}

/// Start and end condition of an orbit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Launch<'a> {
    pub(crate) model: &'a Model<f64>,
    pub(crate) region: &'a Region,
    pub(crate) momentum: Momentum,
    pub(crate) start: Vector2<f64>,
    /// Kind of the first arc.
    pub(crate) first: Motion,
    pub(crate) until: ReturnCondition,
    /// Direction of the curve at the start.
    pub(crate) ahead: Vector2<f64>,
    /// Least length of the orbit \[rad\].
    pub(crate) shortest: f64,
    /// Largest distance of the end from the start \[rad\].
    pub(crate) near: f64,
    /// Tolerance of the integration.
    pub(crate) tolerance: f64,
}

impl Launch<'_> {
    /// Integrates the orbit. Returns `None` if it does not return.
    pub(crate) fn orbit(&self) -> Option<ClosedOrbit> {
        let start = [self.start.x, self.start.y, 0.0, 0.0, 0.0, 0.0];
        let tracer = Tracer {
            flow: Flow {
                model: self.model,
                momentum: self.momentum,
                motion: self.entered(self.first, &start)?,
            },
            region: self.region,
            control: StepControl {
                tolerance: self.tolerance,
                longest: LONGEST_STEP,
            },
            leaves: true,
            ends: self,
            before: 0.0,
            longest: LONGEST,
        };
        let (legs, returned) = tracer.chain(start, MOST_ARCS, |tracer, leg, event| {
            if event.is_some_and(|event| self.returns(event, leg, tracer.before)) {
                return Err(true);
            }
            let next = match event {
                Some(Event::HeightGone) => Some(Motion::Singular),
                Some(Event::Bound(index)) => {
                    along(self.region, index, &shape(&leg.to), &leg.motion)
                }
                Some(Event::PieceEnd) => leg.motion.next_piece(),
                _ => None,
            };
            next.and_then(|next| self.entered(next, &leg.to))
                .ok_or(false)
        });
        (returned == Some(true)).then_some(ClosedOrbit {
            momentum: self.momentum,
            end: legs.last()?.to,
            legs,
        })
    }

    /// Returns `true` if the end of an arc is the end of the orbit with this length \[rad\].
    fn returns(&self, event: Event<()>, leg: &Leg, length: f64) -> bool {
        let off = (shape(&leg.to) - self.start).norm();
        let is_start = match event {
            Event::End(()) => return true,
            Event::HeightGone => {
                let exit = leg.motion.bound().map(ReturnCondition::Exit);
                exit == Some(self.until) && off < self.near
            }
            Event::Bound(index) => self.until == ReturnCondition::Along(index) && off < AT_START,
            Event::PieceEnd => false,
        };
        is_start && length > self.shortest
    }

    /// Returns the motion if it is admissible in a state: on a bound the height must be positive or rising.
    fn entered(&self, motion: Motion, at: &State) -> Option<Motion> {
        let flow = Flow {
            model: self.model,
            momentum: self.momentum,
            motion,
        };
        let rises = || {
            let ahead = exact_step(&flow, &Point::new(&flow, *at), 1e-5);
            flow.height(&ahead.z).value >= -SLACK
        };
        (motion == Motion::Singular || rises()).then_some(motion)
    }
}

impl EndCondition for Launch<'_> {
    /// Crossing of the line at the start.
    type End = ();

    fn watched(&self, motion: &Motion) -> impl Iterator<Item = ()> {
        let ends = motion
            .bound()
            .map_or(ReturnCondition::Line, ReturnCondition::Along);
        (self.until == ends).then_some(()).into_iter()
    }

    fn value(&self, (): (), at: &Point<6>) -> (f64, f64) {
        let (phi, rate) = (shape(&at.z), shape(&at.rate));
        (-(phi - self.start).dot(&self.ahead), -rate.dot(&self.ahead))
    }

    fn counts(&self, (): (), after: &Point<6>, length: f64) -> bool {
        let near = self.until != ReturnCondition::Line
            || (shape(&after.z) - self.start).norm() < self.near;
        length > self.shortest && near
    }
}

/// Motion after a bound is reached.
fn along(region: &Region, index: usize, phi: &Vector2<f64>, before: &Motion) -> Option<Motion> {
    let track = Track::new(region, index, phi, 1.0)?;
    // From one straight bound to the next, the motion must stay inside both.
    if let Motion::Along(before) = before
        && before.wall.edge().is_some()
        && before.direction(phi).perp(&track.direction(phi)) <= 0.0
    {
        return None;
    }
    Some(Motion::Along(track))
}
