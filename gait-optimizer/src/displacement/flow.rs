//! One quarter gait for given multipliers: arc after arc, each ended by an event.

mod quarter;

use swimmer_files::ArcKind;

use crate::arcs::{EndCondition, Event, Leg, Tracer};
use crate::momentum::{Flow, Motion, State, Track, shape};
use crate::region::{Bound, Edge, Region};
use crate::runge_kutta::{Point, StepControl, System};
pub(crate) use quarter::{Fate, MOST_ARCS, Quarter};

/// Longest curve of a quarter \[rad\].
const LONGEST_CURVE: f64 = 40.0;

/// As closely as an extremal is followed that shall be an answer.
pub(super) const FINE: StepControl = StepControl {
    tolerance: 1e-13,
    longest: 0.3,
};

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
    /// Whether bounds are left where the multiplier falls to zero.
    pub(crate) leaves: bool,
    pub(crate) touch: Touch,
    /// Whether the quarter has touched φ₁ = −φ₂ before the state that is followed from.
    pub(crate) touched: bool,
    /// φ₁ + φ₂ where the quarter began.
    pub(crate) began: f64,
}

/// Legs that have a length.
pub(super) fn lasting(legs: &[Leg]) -> impl Iterator<Item = &Leg> {
    legs.iter().filter(|leg| leg.to[5] > leg.from[5])
}

/// Follows arcs from a state on the first one until the quarter is over.
pub(crate) fn follow(
    first: Flow<'_>,
    region: &Region,
    start: State,
    options: TraceOptions,
) -> Quarter {
    let still = Leg {
        motion: first.motion,
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
    let mut motion = first.motion;
    while let Some(leg) = quarter.legs.get_mut(quarter.count) {
        let ends = Ends { region };
        let tracer = Tracer {
            flow: Flow { motion, ..first },
            region,
            control: options.control,
            leaves: options.leaves,
            ends: &ends,
            before: 0.0,
            longest: LONGEST_CURVE,
        };
        let event;
        (*leg, event) = tracer.arc(quarter.end);
        let end = leg.to;
        quarter.end = end;
        quarter.count += 1;
        let at_the_end = event == Some(Event::End(End::Antidiagonal));
        let touch = (at_the_end && !quarter.touched)
            .then(|| along_the_end(region, &end, options.touch))
            .flatten();
        if let Some(touch) = touch {
            quarter.touched = true;
            motion = touch;
            continue;
        }
        let next = Next {
            flow: tracer.flow,
            region,
            began: options.began,
            ends_straight: quarter.touched,
        };
        match next.after(&end, event) {
            Ok(next) => motion = next,
            Err(fate) => {
                quarter.fate = fate;
                break;
            }
        }
    }
    quarter
}

/// Where a quarter ends.
#[derive(Debug, Clone, Copy, PartialEq)]
enum End {
    /// φ₁ + φ₂ falls to zero.
    Antidiagonal,
    /// φ₂ − φ₁ does.
    Diagonal,
    /// Nothing is left to the horizon.
    Horizon,
}

struct Ends<'a> {
    region: &'a Region,
}

impl EndCondition for Ends<'_> {
    type End = End;

    fn watched(&self, motion: &Motion) -> impl Iterator<Item = End> {
        let ends = [
            (!on_diagonal(motion)).then_some(End::Antidiagonal),
            (!self.region.has_diagonals()).then_some(End::Diagonal),
            Some(End::Horizon),
        ];
        ends.into_iter().flatten()
    }

    fn value(&self, end: End, at: &Point<6>) -> (f64, f64) {
        let (phi, rate) = (shape(&at.z), shape(&at.rate));
        match end {
            End::Antidiagonal => (phi.x + phi.y, rate.x + rate.y),
            End::Diagonal => (phi.y - phi.x, rate.y - rate.x),
            End::Horizon => {
                let reach = phi.norm();
                (self.region.horizon - reach, -phi.dot(&rate) / reach)
            }
        }
    }

    fn precedes_bounds(end: End) -> bool {
        end == End::Antidiagonal
    }

    fn stops_at(&self, bound: &Bound, motion: &Motion) -> bool {
        !is_end_line(bound.edge()) || on_diagonal(motion)
    }
}

/// Running along a side of the sector.
fn on_diagonal(motion: &Motion) -> bool {
    matches!(motion, Motion::Along(track) if track.wall.kind() == ArcKind::Diagonal)
}

/// On along φ₁ = −φ₂; none where the quarter shall end, that line is no bound or another bound is in the way.
fn along_the_end(region: &Region, at: &State, touch: Touch) -> Option<Motion> {
    const AHEAD: f64 = 1e-6;
    let index = region
        .bounds()
        .position(|bound| is_end_line(bound.edge()))?;
    let phi = shape(at);
    let inwards = Track::new(region, index, &phi, 1.0)?;
    let track = match touch {
        Touch::Ends => return None,
        Touch::GoesInwards => inwards,
        Touch::GoesOutwards => inwards.back(),
    };
    let ahead = phi + track.direction(&phi) * AHEAD;
    (region.overstepped(&ahead) < 0.5 * AHEAD).then_some(Motion::Along(track))
}

/// What follows an arc.
struct Next<'a> {
    flow: Flow<'a>,
    region: &'a Region,
    /// φ₁ + φ₂ where the quarter began.
    began: f64,
    /// Whether a quarter ends in the straight shape. One that has touched φ₁ = −φ₂ must, or it would meet itself.
    ends_straight: bool,
}

impl Next<'_> {
    fn after(&self, at: &State, event: Option<Event<End>>) -> Result<Motion, Fate> {
        match event {
            None => Err(Fate::Stalled),
            Some(Event::End(End::Antidiagonal)) => Err(Fate::Ended),
            Some(Event::End(End::Diagonal)) => Err(Fate::CameBack),
            Some(Event::End(End::Horizon)) => Err(Fate::LeftHorizon),
            Some(Event::HeightGone) => Ok(Motion::Singular),
            Some(Event::PieceEnd) => self.flow.motion.next_piece().ok_or(Fate::Stalled),
            Some(Event::Bound(index)) => {
                let phi = shape(at);
                let Some(track) = Track::new(self.region, index, &phi, 1.0) else {
                    return Err(Fate::Stalled);
                };
                let is_straight =
                    on_diagonal(&self.flow.motion) && track.wall.kind() == ArcKind::Diagonal;
                if is_straight && self.ends_straight {
                    return Err(Fate::Ended);
                }
                let along = track.direction(&phi);
                // A singular arc may turn either way on a bound; the way towards φ₁ = −φ₂ closes the loop. On φ₁ = φ₂ it
                // leads away from where the quarter began. In a corner of the region the only way is back inside.
                let forwards = match self.flow.motion {
                    Motion::Singular => {
                        let outwards =
                            is_start_line(track.wall.edge()) && phi.x + phi.y > self.began;
                        let away = if outwards { 1.0 } else { -1.0 };
                        let towards_end = away * (along.x + along.y);
                        if towards_end.abs() > 1e-9 {
                            towards_end
                        } else {
                            along.dot(&shape(&self.flow.rate(at)))
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
fn is_start_line(edge: Option<&Edge>) -> bool {
    edge.is_some_and(|edge| edge.kind == ArcKind::Diagonal && edge.normal.x > 0.0)
}

/// The edge φ₂ ≥ −φ₁ of the sector, which is also where quarters end.
pub(crate) fn is_end_line(edge: Option<&Edge>) -> bool {
    edge.is_some_and(|edge| edge.kind == ArcKind::Diagonal && edge.normal.x < 0.0)
}
