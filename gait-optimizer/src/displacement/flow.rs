//! One quarter gait for given multipliers: arc after arc, each ended by an event.

use swimmer_files::ArcKind;

use crate::arcs::{EndCondition, Event, Leg, Tracer};
use crate::momentum::{Flow, Motion, State, Track, shape};
use crate::region::{Bound, Edge, Region};
use crate::runge_kutta::{Point, StepControl, System};

/// Most arcs of a quarter.
const MOST_ARCS: usize = 12;
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

/// A quarter gait.
#[derive(Debug, Clone)]
pub(crate) struct Quarter {
    pub(crate) legs: Vec<Leg>,
    /// Whether it touched φ₁ = −φ₂ and went on along it.
    pub(crate) touched: bool,
    pub(crate) fate: Fate,
    pub(crate) end: State,
}

impl Quarter {
    /// Whether it ends on a way along φ₁ = −φ₂, which it would go back: no loop.
    pub(crate) fn ends_in_a_spike(&self) -> bool {
        let last = self.legs.last().map(|leg| leg.motion);
        matches!(last, Some(Motion::Along(track)) if is_end_line(track.wall.edge()))
    }
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
    let tracer = Tracer {
        flow: first,
        region,
        control: options.control,
        leaves: options.leaves,
        ends: &Ends { region },
        before: 0.0,
        longest: LONGEST_CURVE,
    };
    let mut touched = options.touched;
    let (legs, fate) = tracer.chain(start, MOST_ARCS, |tracer, leg, event| {
        if event == Some(Event::End(End::Antidiagonal))
            && !touched
            && let Some(along) = along_the_end(region, &leg.to, options.touch)
        {
            touched = true;
            return Ok(along);
        }
        // One that has touched φ₁ = −φ₂ must end in the straight shape, or it would meet itself.
        match event {
            None => Err(Fate::Stalled),
            Some(Event::End(End::Antidiagonal)) => Err(Fate::Ended),
            Some(Event::End(End::Diagonal)) => Err(Fate::CameBack),
            Some(Event::End(End::Horizon)) => Err(Fate::LeftHorizon),
            Some(Event::HeightGone) => Ok(Motion::Singular),
            Some(Event::PieceEnd) => leg.motion.next_piece().ok_or(Fate::Stalled),
            Some(Event::Bound(index)) => {
                let track = Track::new(region, index, &shape(&leg.to), 1.0).ok_or(Fate::Stalled)?;
                let is_straight =
                    on_diagonal(&leg.motion) && track.wall.kind() == ArcKind::Diagonal;
                if is_straight && touched {
                    return Err(Fate::Ended);
                }
                Ok(onto(track, &tracer.flow, &leg.to, options.began))
            }
        }
    });
    Quarter {
        end: legs.last().map_or(start, |leg| leg.to),
        legs,
        touched,
        fate: fate.unwrap_or(Fate::TooManyArcs),
    }
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

/// Which way a bound is run that an arc meets, of a quarter that began where φ₁ + φ₂ is `began`.
fn onto(track: Track, flow: &Flow<'_>, at: &State, began: f64) -> Motion {
    let phi = shape(at);
    let along = track.direction(&phi);
    // A singular arc may turn either way on a bound; the way towards φ₁ = −φ₂ closes the loop. On φ₁ = φ₂ it leads away from where
    // the quarter began. In a corner of the region the only way is back inside.
    let forwards = match flow.motion {
        Motion::Singular => {
            let outwards = is_start_line(track.wall.edge()) && phi.x + phi.y > began;
            let away = if outwards { 1.0 } else { -1.0 };
            let towards_end = away * (along.x + along.y);
            if towards_end.abs() > 1e-9 {
                towards_end
            } else {
                along.dot(&shape(&flow.rate(at)))
            }
        }
        Motion::Along(before) => along.dot(&before.inwards(&phi)),
    };
    Motion::Along(if forwards < 0.0 { track.back() } else { track })
}

/// The edge φ₂ ≥ φ₁ of the sector, on which quarters begin.
fn is_start_line(edge: Option<&Edge>) -> bool {
    edge.is_some_and(|edge| edge.kind == ArcKind::Diagonal && edge.normal.x > 0.0)
}

/// The edge φ₂ ≥ −φ₁ of the sector, which is also where quarters end.
pub(crate) fn is_end_line(edge: Option<&Edge>) -> bool {
    edge.is_some_and(|edge| edge.kind == ArcKind::Diagonal && edge.normal.x < 0.0)
}
