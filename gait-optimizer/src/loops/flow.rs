//! One orbit: arc after arc, each ended by an event, until the start is met again.

use nalgebra::Vector2;
use swimmer_model::Model;

use crate::arcs::{EndCondition, Event, Leg, Tracer};
use crate::momentum::{Flow, Momentum, Motion, State, Track, shape};
use crate::region::Region;
use crate::runge_kutta::{Point, StepControl, exact_step};

/// Most arcs of an orbit.
const MOST_ARCS: usize = 24;
/// Longest orbit \[rad\].
const LONGEST: f64 = 60.0;
/// Longest step \[rad\].
const LONGEST_STEP: f64 = 0.15;
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
            let flow = Flow {
                model: self.model,
                momentum: self.momentum,
                motion,
            };
            if motion.bound().is_some() {
                // The height must rise where a bound is met, or be positive already.
                let ahead = exact_step(&flow, &Point::new(&flow, orbit.end), 1e-5);
                if flow.height(&ahead.z).value < -SLACK {
                    return None;
                }
            }
            let tracer = Tracer {
                flow,
                region: self.region,
                control: StepControl {
                    longest: self.control.longest.min(LONGEST_STEP),
                    ..self.control
                },
                leaves: true,
                ends: self,
                before: travelled,
                longest: LONGEST,
            };
            let (leg, event) = tracer.arc(orbit.end);
            orbit.legs.push(leg);
            orbit.end = leg.to;
            travelled += leg.length;
            let phi = shape(&leg.to);
            match event? {
                Event::End(Returned) => return Some(orbit),
                Event::HeightGone => {
                    let returned = motion.bound().map(ReturnCondition::Exit) == Some(self.until)
                        && travelled > self.shortest
                        && (phi - self.start).norm() < self.near;
                    if returned {
                        return Some(orbit);
                    }
                    motion = Motion::Singular;
                }
                Event::Bound(index)
                    if self.until == ReturnCondition::Along(index)
                        && travelled > self.shortest
                        && (phi - self.start).norm() < AT_START =>
                {
                    return Some(orbit);
                }
                Event::Bound(index) => {
                    motion = along(self.region, index, &phi, &motion)?;
                }
                Event::PieceEnd => motion = motion.next_piece()?,
            }
        }
        None
    }
}

/// The line across the curve at the start is crossed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Returned;

impl EndCondition for Launch<'_> {
    type End = Returned;

    fn watched(&self, motion: &Motion) -> impl Iterator<Item = Returned> {
        let ends = motion
            .bound()
            .map_or(ReturnCondition::Line, ReturnCondition::Along);
        (self.until == ends).then_some(Returned).into_iter()
    }

    fn value(&self, _: Returned, at: &Point<6>) -> (f64, f64) {
        let (phi, rate) = (shape(&at.z), shape(&at.rate));
        (-(phi - self.start).dot(&self.ahead), -rate.dot(&self.ahead))
    }

    fn counts(&self, _: Returned, after: &Point<6>, length: f64) -> bool {
        let near = self.until != ReturnCondition::Line
            || (shape(&after.z) - self.start).norm() < self.near;
        length > self.shortest && near
    }
}

/// What follows when a bound is met.
fn along(region: &Region, index: usize, phi: &Vector2<f64>, before: &Motion) -> Option<Motion> {
    let track = Track::new(region, index, phi, 1.0)?;
    // From one straight bound to the next the way must lead on inside both.
    if let Motion::Along(before) = before
        && before.wall.edge().is_some()
        && before.direction(phi).perp(&track.direction(phi)) <= 0.0
    {
        return None;
    }
    Some(Motion::Along(track))
}
