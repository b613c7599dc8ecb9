//! One lap: arc after arc, each ended by an event, until the start is met again.

use nalgebra::Vector2;
use swimmer_model::Model;

use crate::displacement::height::{State, pose, pose_rates, shape};
use crate::momentum::Momentum;
use crate::region::{Bound, Clearance, Piece, Region};
use crate::runge_kutta::{Point, StepControl, System, controlled_step, exact_step};

/// What an arc runs along.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Motion {
    /// The zero of the height.
    Singular,
    /// A straight bound, with this direction.
    Edge {
        bound: usize,
        direction: Vector2<f64>,
    },
    /// A piece of the bound that keeps links apart, this way along its tangent.
    Clearance {
        bound: usize,
        piece: Piece,
        clearance: Clearance,
    },
}

/// One arc of a lap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Leg {
    pub(crate) motion: Motion,
    pub(crate) from: State,
    pub(crate) to: State,
}

/// Most arcs of a lap.
const MOST_ARCS: usize = 24;
/// Longest lap \[rad\].
const LONGEST: f64 = 60.0;
/// Most steps of an arc: where steps shrink to nothing the zero of the height has no direction.
const MOST_STEPS: usize = 600;
/// A lap that reaches its start's bound this near to the start is home \[rad\].
const AT_START: f64 = 1e-7;
/// The height may start this much below zero on a bound, over L.
const SLACK: f64 = 1e-9;

/// A lap that came back, or not.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Lap {
    pub(crate) legs: Vec<Leg>,
    pub(crate) end: State,
}

/// What ends a lap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Home {
    /// Leaving the bound with this index near the start.
    Exit(usize),
    /// Crossing the line across the curve at the start.
    Line,
    /// Passing the start on the straight bound with this index, or reaching that bound there.
    Along(usize),
}

/// Where a lap begins and what ends it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Course<'a> {
    pub(crate) model: &'a Model<f64>,
    pub(crate) region: &'a Region,
    pub(crate) momentum: Momentum,
    pub(crate) start: Vector2<f64>,
    /// What the first arc runs along.
    pub(crate) first: Motion,
    pub(crate) home: Home,
    /// Direction of the curve at the start.
    pub(crate) ahead: Vector2<f64>,
    /// No end before this much of the curve \[rad\] …
    pub(crate) shortest: f64,
    /// … and no end farther than this from the start \[rad\].
    pub(crate) near: f64,
    pub(crate) control: StepControl,
}

struct Drive<'a> {
    model: &'a Model<f64>,
    momentum: Momentum,
    motion: Motion,
}

impl System<6> for Drive<'_> {
    fn rate(&self, z: &State) -> State {
        let (direction, connection, power) = match &self.motion {
            Motion::Singular => {
                let (height, connection, power) =
                    self.momentum.look(self.model, &shape(z), &pose(z));
                (height.singular_direction(), connection, power)
            }
            along => {
                let phi = shape(z);
                let (connection, power) = self.model.connection_and_power(&phi);
                (along.tangent(&phi), connection, power)
            }
        };
        let [x, y, theta, speed] = pose_rates(&connection, &power, z[4], &direction);
        [direction.x, direction.y, x, y, theta, speed]
    }
}

impl Drive<'_> {
    /// What is left of the piece of a clearance that the arc runs along.
    fn piece_left(&self, at: &Point<6>) -> f64 {
        match self.motion {
            Motion::Clearance {
                piece, clearance, ..
            } => clearance
                .piece_end(piece, &shape(&at.z))
                .map_or(1.0, |(value, _)| value),
            _ => 1.0,
        }
    }
}

impl Motion {
    /// Along a bound: its tangent with the region on the left.
    pub(crate) fn tangent(&self, phi: &Vector2<f64>) -> Vector2<f64> {
        match self {
            Self::Singular => Vector2::zeros(),
            Self::Edge { direction, .. } => *direction,
            Self::Clearance {
                piece, clearance, ..
            } => {
                let inwards = clearance.level(*piece, phi).gradient;
                Vector2::new(inwards.y, -inwards.x) / inwards.norm()
            }
        }
    }

    fn bound(&self) -> Option<usize> {
        match self {
            Self::Singular => None,
            Self::Edge { bound, .. } | Self::Clearance { bound, .. } => Some(*bound),
        }
    }
}

/// What ended an arc.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Event {
    Reached(usize),
    HeightGone,
    PieceEnd,
    Home,
}

impl Course<'_> {
    /// Runs the lap; none where it does not come back.
    pub(crate) fn lap(&self) -> Option<Lap> {
        let mut lap = Lap {
            legs: Vec::with_capacity(8),
            end: [self.start.x, self.start.y, 0.0, 0.0, 0.0, 0.0],
        };
        let mut motion = self.first;
        let mut travelled = 0.0;
        for _ in 0..MOST_ARCS {
            let drive = Drive {
                model: self.model,
                momentum: self.momentum,
                motion,
            };
            let (end, event, length) = self.arc(&drive, lap.end, travelled)?;
            lap.legs.push(Leg {
                motion,
                from: lap.end,
                to: end,
            });
            lap.end = end;
            travelled += length;
            let phi = shape(&end);
            match event {
                Event::Home => return Some(lap),
                Event::HeightGone => {
                    let at_home = motion.bound().map(Home::Exit) == Some(self.home)
                        && travelled > self.shortest
                        && (phi - self.start).norm() < self.near;
                    if at_home {
                        return Some(lap);
                    }
                    motion = Motion::Singular;
                }
                Event::Reached(index)
                    if self.home == Home::Along(index)
                        && travelled > self.shortest
                        && (phi - self.start).norm() < AT_START =>
                {
                    return Some(lap);
                }
                Event::Reached(index) => {
                    motion = along(self.region.bound(index)?, index, &phi, &motion)?;
                }
                Event::PieceEnd => {
                    let index = motion.bound()?;
                    let ahead = phi + motion.tangent(&phi) * 1e-7;
                    let before = motion;
                    motion = match (self.region.bound(index)?, motion) {
                        (Bound::Clearance(clearance), Motion::Clearance { piece, .. }) => {
                            Motion::Clearance {
                                bound: index,
                                piece: next_piece(&clearance, piece, &ahead),
                                clearance,
                            }
                        }
                        _ => return None,
                    };
                    if motion == before {
                        return None;
                    }
                }
            }
        }
        None
    }

    /// Integrates to the first event.
    fn arc(&self, drive: &Drive<'_>, start: State, before: f64) -> Option<(State, Event, f64)> {
        let mut here = Point::new(drive, start);
        let mut length = 0.0;
        let mut try_length: f64 = 0.05;
        let own = drive.motion.bound();
        if own.is_some() {
            // The height must rise where a bound is met, or be positive already.
            let ahead = exact_step(drive, &here, 1e-5);
            let (height, ..) = self
                .momentum
                .look(self.model, &shape(&ahead.z), &pose(&ahead.z));
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
            if own.is_some() && self.home == own.map_or(Home::Line, Home::Along) && far_enough {
                let event = Event::Home;
                consider(
                    event,
                    self.value(event, &here),
                    self.value(event, &step.end),
                );
            }
            if own.is_some() {
                let event = Event::HeightGone;
                consider(
                    event,
                    self.value(event, &here),
                    self.value(event, &step.end),
                );
                if let Motion::Clearance { .. } = drive.motion {
                    let event = Event::PieceEnd;
                    let value = |at: &Point<6>| drive.piece_left(at);
                    consider(event, value(&here), value(&step.end));
                }
            } else if self.home == Home::Line && far_enough {
                let event = Event::Home;
                let near = (shape(&step.end.z) - self.start).norm() < self.near;
                let (from, to) = (self.value(event, &here), self.value(event, &step.end));
                if near {
                    consider(event, from, to);
                }
            }
            if let Some((guess, event)) = first {
                let (end, at) = self.locate(drive, &here, event, guess, step.length);
                return Some((end, event, length + at));
            }
            here = step.end;
            length += step.length;
            try_length = step.next;
        }
        None
    }

    /// A value that falls through zero where the event is.
    fn value(&self, event: Event, at: &Point<6>) -> f64 {
        match event {
            Event::Reached(index) => self
                .region
                .bound(index)
                .map_or(1.0, |bound| bound.margin(&shape(&at.z))),
            Event::HeightGone => {
                self.momentum
                    .look(self.model, &shape(&at.z), &pose(&at.z))
                    .0
                    .value
            }
            Event::PieceEnd => 1.0,
            Event::Home => -(shape(&at.z) - self.start).dot(&self.ahead),
        }
    }

    /// Cuts the step where the event is: regula falsi with bisection, then exact.
    fn locate(
        &self,
        drive: &Drive<'_>,
        here: &Point<6>,
        event: Event,
        guess: f64,
        longest: f64,
    ) -> (State, f64) {
        let value = |at: &Point<6>| match event {
            Event::PieceEnd => drive.piece_left(at),
            other => self.value(other, at),
        };
        let (mut low, mut high) = ((0.0, value(here)), (longest, f64::NAN));
        high.1 = value(&exact_step(drive, here, longest));
        let mut length = guess;
        let mut there = exact_step(drive, here, length);
        for round in 0..60 {
            let now = value(&there);
            if now > 0.0 {
                low = (length, now);
                if round % 2 == 1 {
                    high.1 *= 0.5;
                }
            } else {
                high = (length, now);
                if round % 2 == 1 {
                    low.1 *= 0.5;
                }
            }
            if now == 0.0 || high.0 - low.0 < 1e-15 {
                break;
            }
            let secant = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let next = if secant > low.0 && secant < high.0 && round < 40 {
                secant
            } else {
                0.5 * (low.0 + high.0)
            };
            if (next - length).abs() < 1e-16 {
                break;
            }
            length = next;
            there = exact_step(drive, here, length);
        }
        let mut z = there.z;
        if let Event::Reached(index) = event
            && let Some(bound) = self.region.bound(index)
        {
            let on = bound.onto(&shape(&z));
            (z[0], z[1]) = (on.x, on.y);
        }
        (z, length)
    }
}

/// What follows when a bound is met.
fn along(bound: Bound, index: usize, phi: &Vector2<f64>, before: &Motion) -> Option<Motion> {
    let motion = match bound {
        Bound::Straight(edge) => Motion::Edge {
            bound: index,
            direction: edge.counter_clockwise(),
        },
        Bound::Clearance(clearance) => Motion::Clearance {
            bound: index,
            piece: clearance.piece(phi),
            clearance,
        },
    };
    // From bound to bound the way must lead on inside both.
    if let Motion::Edge { direction, .. } = before
        && direction.perp(&motion.tangent(phi)) <= 0.0
    {
        return None;
    }
    Some(motion)
}

/// The piece that a clearance goes on with where one ends.
fn next_piece(clearance: &Clearance, ended: Piece, ahead: &Vector2<f64>) -> Piece {
    let next = clearance.piece(ahead);
    if next != ended {
        return next;
    }
    // At a corner the place ahead lies beyond the bound; the other tip's piece goes on.
    match ended {
        Piece::FrontTip => Piece::BackTip,
        Piece::BackTip => Piece::FrontTip,
        other => other,
    }
}
