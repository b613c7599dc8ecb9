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
mod quarter;

use event::{Event, MOST_EVENTS, Watched, first_event};

use swimmer_files::ArcKind;

use super::height::Extremal;
use crate::momentum::{Flow, Motion, State, Track, shape};
use crate::region::{Bound, Region};
use crate::runge_kutta::{Point, StepControl, System, controlled_step, exact_step, locate};
pub(crate) use quarter::{Fate, Leg, MOST_ARCS, Quarter};

/// Longest curve of a quarter \[rad\].
const LONGEST_CURVE: f64 = 40.0;

/// What a quarter does where it first meets φ₁ = −φ₂.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Touch {
    /// Ends there.
    Ends,
    /// Goes on along that line, which must be a bound, towards the straight shape: the quarter and its image touch there.
    GoesInwards,
    /// The same, away from the straight shape.
    GoesOutwards,
}

/// How to follow arcs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TraceOptions {
    pub(crate) control: StepControl,
    pub(crate) touch: Touch,
    /// Whether the quarter has touched φ₁ = −φ₂ before the state that is followed from.
    pub(crate) touched: bool,
    /// φ₁ + φ₂ where the quarter began.
    pub(crate) began: f64,
}

/// Follows arcs from a state until the quarter is over, leaving bounds where the multiplier falls to zero.
pub(crate) fn follow(
    extremal: Extremal<'_>,
    region: &Region,
    start: State,
    first: Motion,
    options: TraceOptions,
) -> Quarter {
    arcs(extremal, region, start, first, options, true)
}

/// Follows the bounds from a state on one of them, never leaving them.
pub(crate) fn along_bounds(
    extremal: Extremal<'_>,
    region: &Region,
    start: State,
    first: Track,
    (control, touch): (StepControl, Touch),
) -> Quarter {
    let options = TraceOptions {
        control,
        touch,
        touched: false,
        began: start[0] + start[1],
    };
    arcs(
        extremal,
        region,
        start,
        Motion::Along(first),
        options,
        false,
    )
}

fn arcs(
    extremal: Extremal<'_>,
    region: &Region,
    start: State,
    first: Motion,
    options: TraceOptions,
    leaves: bool,
) -> Quarter {
    let still = Leg {
        motion: first,
        from: start,
        to: start,
        length: 0.0,
    };
    let mut quarter = Quarter {
        legs: [still; MOST_ARCS],
        count: 0,
        touched: options.touched,
        fate: Fate::TooManyArcs,
        end: start,
    };
    let mut motion = first;
    while let Some(leg) = quarter.legs.get_mut(quarter.count) {
        let tracer = Tracer {
            drive: Flow {
                model: extremal.model,
                momentum: extremal.momentum(),
                motion,
            },
            region,
            control: options.control,
            leaves,
            began: options.began,
            ends_straight: quarter.touched,
        };
        let (end, length, event) = tracer.arc(quarter.end);
        *leg = Leg {
            motion,
            from: quarter.end,
            to: end,
            length,
        };
        quarter.end = end;
        quarter.count += 1;
        let ends = event == Some(Event::End);
        let touch = (ends && !quarter.touched)
            .then(|| tracer.along_the_end(&end, options.touch))
            .flatten();
        if let Some(touch) = touch {
            quarter.touched = true;
            motion = touch;
            continue;
        }
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
    drive: Flow<'a>,
    region: &'a Region,
    control: StepControl,
    /// Whether bounds are left where the multiplier falls to zero.
    leaves: bool,
    /// φ₁ + φ₂ where the quarter began.
    began: f64,
    /// Whether a quarter ends in the straight shape. One that has touched φ₁ = −φ₂ must, or it would meet itself.
    ends_straight: bool,
}

impl Tracer<'_> {
    /// Integrates until the first event; none when steps fail or the curve grows too long.
    fn arc(&self, start: State) -> (State, f64, Option<Event>) {
        let mut here = Point::new(&self.drive, start);
        let mut watched = self.watch(&here);
        let mut length = 0.0;
        let mut try_length = 0.05;
        while length < LONGEST_CURVE {
            let Some(step) = controlled_step(&self.drive, &here, try_length, self.control) else {
                return (here.z, length, None);
            };
            let after = self.watch(&step.end);
            if let Some((event, at)) = first_event(&watched, &after, step.length) {
                let (end, at) = self.locate(&here, event, at, step.length);
                return (end, length + at, Some(event));
            }
            here = step.end;
            watched = after;
            length += step.length;
            try_length = step.next;
        }
        (here.z, length, None)
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
            Motion::Along(track) => {
                if self.leaves {
                    add(Event::Multiplier);
                }
                if track.piece_end(&shape(&at.z)).is_some() {
                    add(Event::PieceEnd);
                }
                Some(track.index)
            }
        };
        for (index, bound) in self.region.bounds().enumerate() {
            let as_end = is_end_line(&bound) && !self.on_diagonal();
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

    /// Running along a side of the sector.
    fn on_diagonal(&self) -> bool {
        match self.drive.motion {
            Motion::Singular => false,
            Motion::Along(track) => track.bound.kind() == ArcKind::Diagonal,
        }
    }

    fn value(&self, event: Event, at: &Point<6>) -> (f64, f64) {
        let (phi, rate) = (shape(&at.z), shape(&at.rate));
        match event {
            Event::Edge(index) => match self.region.bound(index) {
                Some(bound) => (bound.margin(&phi), bound.gradient(&phi).dot(&rate)),
                None => (1.0, 0.0),
            },
            Event::PieceEnd => match self.drive.motion {
                Motion::Along(track) => track
                    .piece_end(&phi)
                    .map_or((1.0, 0.0), |(left, slope)| (left, slope.dot(&rate))),
                Motion::Singular => (1.0, 0.0),
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
        let Motion::Along(track) = self.drive.motion else {
            return (1.0, 0.0);
        };
        let height = self.drive.height(&at.z);
        let direction = track.direction(&shape(&at.z));
        (
            track.way * height.value,
            track.way * height.gradient.dot(&direction),
        )
    }

    /// Cuts the step to end where the event's value is zero.
    fn locate(&self, here: &Point<6>, event: Event, guess: f64, longest: f64) -> (State, f64) {
        let at = |length| Some(exact_step(&self.drive, here, length));
        let value = |at: &Point<6>| self.value(event, at);
        let Some((there, length)) = locate([guess, longest], at, value) else {
            return (here.z, 0.0);
        };
        let mut z = there.z;
        if let Event::Edge(index) = event
            && let Some(bound) = self.region.bound(index)
        {
            let on = bound.onto(&shape(&z));
            (z[0], z[1]) = (on.x, on.y);
        }
        (z, length)
    }

    /// On along φ₁ = −φ₂; none where the quarter shall end, that line is no bound or another bound is in the way.
    fn along_the_end(&self, at: &State, touch: Touch) -> Option<Motion> {
        const AHEAD: f64 = 1e-6;
        let index = self.region.bounds().position(|bound| is_end_line(&bound))?;
        let phi = shape(at);
        let inwards = Track::new(self.region, index, &phi, 1.0)?;
        let track = match touch {
            Touch::Ends => return None,
            Touch::GoesInwards => inwards,
            Touch::GoesOutwards => inwards.back(),
        };
        let ahead = phi + track.direction(&phi) * AHEAD;
        (self.region.overstepped(&ahead) < 0.5 * AHEAD).then_some(Motion::Along(track))
    }

    /// What follows an arc.
    fn next(&self, at: &State, event: Option<Event>) -> Result<Motion, Fate> {
        match event {
            None => Err(Fate::Stalled),
            Some(Event::End) => Err(Fate::Ended),
            Some(Event::Start) => Err(Fate::CameBack),
            Some(Event::Horizon) => Err(Fate::LeftHorizon),
            Some(Event::Multiplier) => Ok(Motion::Singular),
            Some(Event::PieceEnd) => match self.drive.motion {
                Motion::Along(track) => track.next_piece().map(Motion::Along).ok_or(Fate::Stalled),
                Motion::Singular => Err(Fate::Stalled),
            },
            Some(Event::Edge(index)) => {
                let phi = shape(at);
                let Some(track) = Track::new(self.region, index, &phi, 1.0) else {
                    return Err(Fate::Stalled);
                };
                let is_straight = self.on_diagonal() && track.bound.kind() == ArcKind::Diagonal;
                if is_straight && self.ends_straight {
                    return Err(Fate::Ended);
                }
                let along = track.direction(&phi);
                // A singular arc may turn either way on a bound; the way towards φ₁ = −φ₂ closes the loop. On φ₁ = φ₂ it
                // leads away from where the quarter began. In a corner of the region the only way is back inside.
                let forwards = match self.drive.motion {
                    Motion::Singular => {
                        let outwards = is_start_line(&track.bound) && phi.x + phi.y > self.began;
                        let away = if outwards { 1.0 } else { -1.0 };
                        let towards_end = away * (along.x + along.y);
                        if towards_end.abs() > 1e-9 {
                            towards_end
                        } else {
                            along.dot(&shape(&self.drive.rate(at)))
                        }
                    }
                    Motion::Along(before) => along.dot(&before.inwards(&phi)),
                };
                Ok(Motion::Along(if forwards < 0.0 {
                    track.back()
                } else {
                    track
                }))
            }
        }
    }
}

/// The edge φ₂ ≥ φ₁ of the sector, on which quarters begin.
fn is_start_line(bound: &Bound) -> bool {
    matches!(bound, Bound::Straight(edge) if edge.kind == ArcKind::Diagonal && edge.normal.x > 0.0)
}

/// The edge φ₂ ≥ −φ₁ of the sector, which is also where quarters end.
pub(crate) fn is_end_line(bound: &Bound) -> bool {
    matches!(bound, Bound::Straight(edge) if edge.kind == ArcKind::Diagonal && edge.normal.x < 0.0)
}
