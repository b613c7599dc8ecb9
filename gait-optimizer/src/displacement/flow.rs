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

/// Step control of an extremal that is returned as a result.
pub(super) const FINE: StepControl = StepControl {
    tolerance: 1e-13,
    longest: 0.3,
};

/// Behaviour of a quarter where it first meets φ₁ = −φ₂.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Touch {
    /// Ends there.
    Ends,
    /// Goes on along that line, which must be a bound, towards the straight shape: the quarter and its image touch there.
    GoesInwards,
    /// The same, away from the straight shape.
    GoesOutwards,
}

/// Options for tracing arcs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TraceOptions {
    pub(crate) control: StepControl,
    /// `true` to leave a bound when its multiplier falls to zero.
    pub(crate) leaves: bool,
    /// Earlier contacts of the quarter with the diagonals.
    pub(crate) met: DiagonalContacts,
}

/// Contacts of a quarter with the diagonals. It may not touch either of them again at these places.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DiagonalContacts {
    /// The lowest and the highest φ₁ + φ₂ on φ₁ = φ₂.
    start: [f64; 2],
    /// φ₂ − φ₁ where it met φ₁ = −φ₂ first, and up to where it ran along that line.
    end: Option<[f64; 2]>,
}

impl DiagonalContacts {
    /// Contacts of a quarter that begins in a state.
    pub(super) fn beginning(state: &State) -> Self {
        Self {
            start: [state[0] + state[1]; 2],
            end: None,
        }
    }

    /// And ran along φ₁ = −φ₂ from one state to another.
    pub(super) fn and_ran(self, from: &State, to: &State) -> Self {
        let end = Some([from, to].map(|state| state[1] - state[0]));
        Self { end, ..self }
    }

    /// And along φ₁ = φ₂ up to a state.
    fn and_started(self, to: &State) -> Self {
        let ([low, high], at) = (self.start, to[0] + to[1]);
        let start = [low.min(at), high.max(at)];
        Self { start, ..self }
    }
}

/// Reason why the trace of a quarter ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TraceEnd {
    /// On φ₁ = −φ₂, as it should.
    Ended,
    /// Back where it or its mirror images have been.
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
    pub(crate) met: DiagonalContacts,
    pub(crate) outcome: TraceEnd,
    pub(crate) end: State,
}

impl Quarter {
    /// `true` if it touched φ₁ = −φ₂ and continued along it.
    pub(crate) fn touched(&self) -> bool {
        self.met.end.is_some()
    }

    /// `true` if it ends on φ₁ = −φ₂ at an admissible place: beyond the stretch that it ran along that line.
    pub(crate) fn ended(&self) -> bool {
        let beyond = self.met.end.is_none_or(|[from, to]| {
            let end = self.end[1] - self.end[0];
            (end - to) * (to - from) > 0.0
        });
        self.outcome == TraceEnd::Ended && beyond
    }

    /// Continuation along φ₁ = −φ₂ of a quarter that ends there. Returns `None` if that line is no bound or another bound is in
    /// the way.
    pub(crate) fn going_on(
        &self,
        touch: Touch,
        (flow, region): (Flow<'_>, &Region),
        options: TraceOptions,
    ) -> Option<Self> {
        if self.outcome != TraceEnd::Ended || self.touched() {
            return None;
        }
        let motion = along_the_end(region, &self.end, touch)?;
        let met = self.met;
        let options = TraceOptions { met, ..options };
        let onwards = follow(Flow { motion, ..flow }, region, self.end, options);
        let legs = self.legs.iter().chain(&onwards.legs).copied().collect();
        Some(Self { legs, ..onwards })
    }
}

/// Legs that have a length.
pub(super) fn nonempty_legs(legs: &[Leg]) -> impl Iterator<Item = &Leg> {
    legs.iter().filter(|leg| leg.to[5] > leg.from[5])
}

/// Follows arcs from a state on the first one until the quarter is over, where it first meets φ₁ = −φ₂ at the latest unless it runs
/// along that line.
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
        ends: &Ends(region),
        before: 0.0,
        longest: LONGEST_CURVE,
    };
    let mut met = options.met;
    let (legs, outcome) = tracer.chain(start, MOST_ARCS, |tracer, leg, event| {
        let edge = leg.motion.track().and_then(|track| track.wall.edge());
        if is_start_line(edge) {
            met = met.and_started(&leg.to);
        }
        if is_end_line(edge) {
            met = met.and_ran(&leg.from, &leg.to);
            // The rest of that line is off the region.
            if matches!(event, Some(Event::Bound(_))) {
                return Err(TraceEnd::CameBack);
            }
        }
        match event {
            None => Err(TraceEnd::Stalled),
            Some(Event::End(End::Antidiagonal)) => Err(TraceEnd::Ended),
            Some(Event::End(End::Diagonal)) => Err(TraceEnd::CameBack),
            Some(Event::End(End::Horizon)) => Err(TraceEnd::LeftHorizon),
            Some(Event::HeightGone) => Ok(Motion::Singular),
            Some(Event::PieceEnd) => leg.motion.next_piece().ok_or(TraceEnd::Stalled),
            Some(Event::Bound(index)) => {
                let track =
                    Track::new(region, index, &shape(&leg.to), 1.0).ok_or(TraceEnd::Stalled)?;
                let edge = track.wall.edge();
                if is_start_line(edge) {
                    let ([low, high], at) = (met.start, leg.to[0] + leg.to[1]);
                    if low < at && at < high {
                        return Err(TraceEnd::CameBack);
                    }
                }
                // Along φ₁ = φ₂ to the straight shape.
                if is_end_line(edge) && met.end.is_some() {
                    return Err(TraceEnd::Ended);
                }
                Ok(onto(track, &tracer.flow, &leg.to, met.start))
            }
        }
    });
    Quarter {
        end: legs.last().map_or(start, |leg| leg.to),
        legs,
        met,
        outcome: outcome.unwrap_or(TraceEnd::TooManyArcs),
    }
}

/// Events that end a quarter.
#[derive(Debug, Clone, Copy, PartialEq)]
enum End {
    /// φ₁ + φ₂ falls to zero.
    Antidiagonal,
    /// φ₂ − φ₁ does.
    Diagonal,
    /// Nothing is left to the horizon.
    Horizon,
}

struct Ends<'a>(&'a Region);

impl EndCondition for Ends<'_> {
    type End = End;

    fn watched(&self, motion: &Motion) -> impl Iterator<Item = End> {
        let ends = [
            (!on_diagonal(motion)).then_some(End::Antidiagonal),
            (!self.0.has_diagonals()).then_some(End::Diagonal),
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
                (self.0.horizon - reach, -phi.dot(&rate) / reach)
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
    motion.kind() == ArcKind::Diagonal
}

/// Motion along φ₁ = −φ₂. Returns `None` for [`Touch::Ends`], if that line is no bound, or if another bound is in the way.
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

/// Direction along a bound that an arc meets, for a quarter with this range of φ₁ + φ₂ on φ₁ = φ₂.
fn onto(track: Track, flow: &Flow<'_>, at: &State, [_, highest]: [f64; 2]) -> Motion {
    let phi = shape(at);
    let along = track.direction(&phi);
    // A singular arc may turn either way on a bound; the way towards φ₁ = −φ₂ closes the loop. On φ₁ = φ₂ it leads away from where
    // the quarter has been. In a corner of the region the only way is back inside.
    let forwards = match flow.motion {
        Motion::Singular => {
            let outwards = is_start_line(track.wall.edge()) && phi.x + phi.y > highest;
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
