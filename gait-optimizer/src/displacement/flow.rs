//! One quarter gait for given multipliers: arc after arc, each ended by an event.
//!
//! ```text
//!                   a bound is reached
//!   Singular ─────────────────────────────► Along that bound ──┐ a corner of the
//!      ▲  │                                     │     ▲        │ region: along the
//!      │  │                                     │     └────────┘ next bound
//!      │  └──────────► Ended, CameBack …        ├──► Ended
//!      └────────────────────────────────────────┘
//!            the multiplier falls to zero (F = 0)
//! ```
//!
//! On entering a bound `F = 0` as well; there the multiplier rises, so the exit event, which waits for it to *fall* to
//! zero, is armed only once it has left that neighbourhood. Events are looked for on the cubic through value and slope at
//! both ends of a step, so that two crossings in one step are seen, and located by cutting the step.

mod event;

use event::{Event, MOST_EVENTS, Watched, first_event};
use nalgebra::Vector2;

use super::height::{Extremal, State, pose_rates, shape};
use crate::region::Region;
use crate::runge_kutta::{Point, StepControl, System, controlled_step, exact_step};

/// What an arc runs along.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Motion {
    /// The singular control.
    Singular,
    /// An edge of the region, in this direction.
    Along {
        edge: usize,
        direction: Vector2<f64>,
    },
}

/// One arc of a quarter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Leg {
    pub(crate) motion: Motion,
    pub(crate) from: State,
    pub(crate) to: State,
}

/// How a quarter came to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fate {
    /// On φ₁ = −φ₂, as it should.
    Ended,
    /// Back on φ₁ = φ₂, where its mirror image would cross it.
    CameBack,
    /// Beyond the horizon.
    LeftHorizon,
    /// The singular control is not defined: no step is short enough.
    Stalled,
    /// Arc after arc without an end.
    TooManyArcs,
}

/// Most arcs of a quarter.
pub(crate) const MOST_ARCS: usize = 12;
/// Longest curve of a quarter \[rad\].
const LONGEST_CURVE: f64 = 40.0;
/// A quarter gait.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Quarter {
    legs: [Leg; MOST_ARCS],
    count: usize,
    pub(crate) fate: Fate,
    pub(crate) end: State,
}

impl Quarter {
    pub(crate) fn legs(&self) -> &[Leg] {
        self.legs.get(..self.count).unwrap_or_default()
    }
}

/// The dynamics of an arc with |u| = 1 (paper, the constraint on the shape's rate of change).
pub(crate) struct Drive<'a> {
    pub(crate) extremal: Extremal<'a>,
    pub(crate) motion: Motion,
}

impl System<6> for Drive<'_> {
    fn rate(&self, z: &State) -> State {
        let (phi, pose) = (shape(z), [z[2], z[3], z[4]]);
        let (direction, connection, power) = match self.motion {
            Motion::Singular => {
                let (height, connection, power) = self.extremal.height_and_gradient(&phi, &pose);
                (height.singular_direction(), connection, power)
            }
            Motion::Along { direction, .. } => {
                let (connection, power) = self.extremal.model.connection_and_power(&phi);
                (direction, connection, power)
            }
        };
        let [x, y, theta, speed] = pose_rates(&connection, &power, z[4], &direction);
        [direction.x, direction.y, x, y, theta, speed]
    }
}

/// Follows arcs from a state until the quarter is over.
pub(crate) fn follow(
    extremal: Extremal<'_>,
    region: &Region,
    start: State,
    first: Motion,
    control: StepControl,
) -> Quarter {
    let still = Leg {
        motion: first,
        from: start,
        to: start,
    };
    let mut quarter = Quarter {
        legs: [still; MOST_ARCS],
        count: 0,
        fate: Fate::TooManyArcs,
        end: start,
    };
    let mut motion = first;
    while let Some(leg) = quarter.legs.get_mut(quarter.count) {
        let tracer = Tracer {
            drive: Drive { extremal, motion },
            region,
            control,
        };
        let (end, event) = tracer.arc(quarter.end);
        *leg = Leg {
            motion,
            from: quarter.end,
            to: end,
        };
        quarter.end = end;
        quarter.count += 1;
        match tracer.next(&end, event) {
            Ok(next) => motion = next,
            Err(fate) => {
                quarter.fate = fate;
                break;
            }
        }
    }
    quarter
}

/// One arc being traced.
struct Tracer<'a> {
    drive: Drive<'a>,
    region: &'a Region,
    control: StepControl,
}

impl Tracer<'_> {
    /// Integrates until the first event; none when steps fail or the curve grows too long.
    fn arc(&self, start: State) -> (State, Option<Event>) {
        let mut here = Point::new(&self.drive, start);
        let mut watched = self.watch(&here);
        let mut length = 0.0;
        let mut try_length = 0.05;
        while length < LONGEST_CURVE {
            let Some(step) = controlled_step(&self.drive, &here, try_length, self.control) else {
                return (here.z, None);
            };
            let after = self.watch(&step.end);
            if let Some((event, at)) = first_event(&watched, &after, step.length) {
                return (self.locate(&here, event, at, step.length), Some(event));
            }
            here = step.end;
            watched = after;
            length += step.length;
            try_length = step.next;
        }
        (here.z, None)
    }

    /// Every event's value and slope at a point.
    fn watch(&self, at: &Point<6>) -> Watched {
        let mut watched = [None; MOST_EVENTS];
        let mut slots = watched.iter_mut();
        let mut add = |event| {
            if let Some(slot) = slots.next() {
                let (value, slope) = self.value(event, at);
                *slot = Some((event, value, slope));
            }
        };
        let own = match self.drive.motion {
            Motion::Singular => None,
            Motion::Along { edge, .. } => {
                add(Event::Multiplier);
                Some(edge)
            }
        };
        for index in 0..self.region.edges().len() {
            let as_end = self.is_end_line(index) && !self.on_diagonal();
            if Some(index) != own && !as_end {
                add(Event::Edge(index));
            }
        }
        if !self.on_diagonal() {
            add(Event::End);
        }
        if !self.region.has_diagonals() {
            add(Event::Start);
        }
        add(Event::Horizon);
        watched
    }

    /// The edge φ₂ ≥ −φ₁ of the sector, which is also where quarters end.
    fn is_end_line(&self, index: usize) -> bool {
        self.region.edge(index).is_some_and(|edge| {
            edge.kind == swimmer_files::ArcKind::Diagonal && edge.normal.x < 0.0
        })
    }

    /// Running along a side of the sector.
    fn on_diagonal(&self) -> bool {
        match self.drive.motion {
            Motion::Singular => false,
            Motion::Along { edge, .. } => self
                .region
                .edge(edge)
                .is_some_and(|edge| edge.kind == swimmer_files::ArcKind::Diagonal),
        }
    }

    fn value(&self, event: Event, at: &Point<6>) -> (f64, f64) {
        let (phi, rate) = (shape(&at.z), shape(&at.rate));
        match event {
            Event::Edge(index) => match self.region.edge(index) {
                Some(edge) => (edge.margin(&phi), -edge.normal.dot(&rate)),
                None => (1.0, 0.0),
            },
            Event::End => (phi.x + phi.y, rate.x + rate.y),
            Event::Start => (phi.y - phi.x, rate.y - rate.x),
            Event::Horizon => {
                let reach = phi.norm();
                (self.region.horizon - reach, -phi.dot(&rate) / reach)
            }
            Event::Multiplier => self.multiplier(at),
        }
    }

    /// The multiplier μ of the bound and its slope: the height where the region lies left of the motion, minus the height
    /// where it lies right (paper, exit criterion, with the sign that belongs to a maximum).
    fn multiplier(&self, at: &Point<6>) -> (f64, f64) {
        let Motion::Along { edge, direction } = self.drive.motion else {
            return (1.0, 0.0);
        };
        let Some(edge) = self.region.edge(edge) else {
            return (1.0, 0.0);
        };
        let side = edge.counter_clockwise().dot(&direction).signum();
        let pose = [at.z[2], at.z[3], at.z[4]];
        let (height, ..) = self
            .drive
            .extremal
            .height_and_gradient(&shape(&at.z), &pose);
        (side * height.value, side * height.gradient.dot(&direction))
    }

    /// Cuts the step to end where the event's value is zero, by Newton's method on the step's length.
    fn locate(&self, here: &Point<6>, event: Event, guess: f64, longest: f64) -> State {
        let mut length = guess;
        let mut there = exact_step(&self.drive, here, length);
        for _ in 0..12 {
            let (value, slope) = self.value(event, &there);
            let better = (length - value / slope).clamp(0.0, longest);
            if !better.is_finite() || (better - length).abs() <= 1e-16 * (1.0 + length) {
                break;
            }
            let done = (better - length).abs() < 1e-13;
            length = better;
            there = exact_step(&self.drive, here, length);
            if done {
                break;
            }
        }
        let mut z = there.z;
        if let Event::Edge(index) = event
            && let Some(edge) = self.region.edge(index)
        {
            let on = edge.onto(&shape(&z));
            (z[0], z[1]) = (on.x, on.y);
        }
        z
    }

    /// What follows an arc.
    fn next(&self, at: &State, event: Option<Event>) -> Result<Motion, Fate> {
        match event {
            None => Err(Fate::Stalled),
            Some(Event::End) => Err(Fate::Ended),
            Some(Event::Start) => Err(Fate::CameBack),
            Some(Event::Horizon) => Err(Fate::LeftHorizon),
            Some(Event::Multiplier) => Ok(Motion::Singular),
            Some(Event::Edge(index)) => {
                let Some(edge) = self.region.edge(index) else {
                    return Err(Fate::Stalled);
                };
                let along = edge.counter_clockwise();
                // A singular arc may turn either way on a bound; the way towards φ₁ = −φ₂ closes the loop. In a corner of
                // the region the only way is back inside.
                let forwards = match self.drive.motion {
                    Motion::Singular => {
                        let towards_end = -(along.x + along.y);
                        if towards_end.abs() > 1e-9 {
                            towards_end
                        } else {
                            along.dot(&shape(&self.drive.rate(at)))
                        }
                    }
                    Motion::Along { edge: before, .. } => self
                        .region
                        .edge(before)
                        .map_or(1.0, |before| -along.dot(&before.normal)),
                };
                let direction = if forwards < 0.0 { -along } else { along };
                Ok(Motion::Along {
                    edge: index,
                    direction,
                })
            }
        }
    }
}
