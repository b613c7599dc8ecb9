//! Start families of singular arcs: places on φ₁ = φ₂, or along the bounds that lead from there to φ₁ = −φ₂.

use std::f64::consts::PI;

use nalgebra::Vector2;
use swimmer_files::{ArcKind, Bounds};

use swimmer_model::Model;

use super::flow::{
    DiagonalContacts, FINE, Quarter, Touch, TraceEnd, TraceOptions, follow, is_end_line,
    nonempty_legs,
};
use crate::arcs::Leg;
use crate::momentum::{Flow, Momentum, Motion, State, Track, pose, shape};
use crate::region::{Bound, Region};
use crate::runge_kutta::{Point, StepControl, advance};

/// A line of places.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum StartFamily {
    /// φ₁ = φ₂ = p.
    StartLine { low: f64, high: f64 },
    /// Along bounds; p is the way along them. Poses are carried along.
    Bounds { stretches: Vec<Stretch> },
    /// Along bounds and then along φ₁ = −φ₂, up to where the multiplier falls to zero. The place is fixed and λ₄ is free; p is
    /// a measure of it, from −1 for −∞ to 1 for ∞.
    EndLine {
        stretches: Vec<Stretch>,
        turn: State,
        touch: Touch,
    },
}

/// A part of the way along bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stretch {
    track: Track,
    from: State,
    to: State,
    /// First and last p of the family.
    span: [f64; 2],
}

/// A place on a family.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StartState {
    pub(crate) state: State,
    /// Motion of the curve up to the family; singular on φ₁ = φ₂.
    pub(crate) motion: Motion,
}

/// All families of a region.
pub(crate) fn families(flow: Flow<'_>, bounds: &Bounds, region: &Region) -> Vec<StartFamily> {
    let mut families = vec![StartFamily::StartLine {
        low: bounds.min_angle.unwrap_or(0.0),
        high: bounds.max_angle.unwrap_or(PI).min(PI),
    }];
    for (index, bound) in region.bounds().enumerate() {
        let Some((corner, way)) = start(&bound) else {
            continue;
        };
        let state = [corner, corner, 0.0, 0.0, 0.0, 0.0];
        let shape = [corner, corner].into();
        if region.overstepped(&shape) > 1e-12 {
            continue;
        }
        let Some(mut track) = Track::new(region, index, &shape, way) else {
            continue;
        };
        if let Bound::Clearance(clearance) = &mut track.wall {
            *clearance = clearance.held_to(clearance.after_tip(0));
        }
        let start = StartState {
            state,
            motion: Motion::Along(track),
        };
        let way = along_bounds(flow, region, start, false);
        let stretches = stretches(&way.legs);
        if way.outcome == TraceEnd::Ended && !stretches.is_empty() {
            families.push(StartFamily::Bounds { stretches });
        }
    }
    families
}

/// The families of quarters that touch φ₁ = −φ₂, where that is a bound: those along other bounds and on along that line from where
/// they meet it, and those outwards from the straight shape. Quarters leave them to go round shapes about the straight one
/// that the other bounds do not meet, or to leave those shapes out.
pub(crate) fn families_on_the_diagonal(
    flow: Flow<'_>,
    region: &Region,
    families: &[StartFamily],
    touch: Touch,
) -> Vec<StartFamily> {
    let Some(index) = region.bounds().position(|bound| is_end_line(bound.edge())) else {
        return Vec::new();
    };
    let on_bounds = families.iter().filter_map(StartFamily::start);
    let straight = (touch == Touch::GoesOutwards)
        .then(|| straight_shape(region, index))
        .flatten();
    let ways = on_bounds.chain(straight).filter_map(|start| {
        let way = along_bounds(flow, region, start, false);
        let onwards = way.going_on(touch, (flow, region), options(&start.state, false));
        let way = onwards.unwrap_or(way);
        let mut stretches = stretches(&way.legs);
        let touching = stretches
            .iter()
            .position(|stretch| stretch.track.index == index)?;
        stretches.truncate(touching + 1);
        let turn = turn(flow, region, stretches.last()?)?;
        Some(StartFamily::EndLine {
            stretches,
            turn,
            touch,
        })
    });
    ways.collect()
}

/// Follows the bounds from a place on the first one, never leaving them unless it `leaves`.
fn along_bounds(
    flow: Flow<'_>,
    region: &Region,
    StartState { state, motion }: StartState,
    leaves: bool,
) -> Quarter {
    let options = options(&state, leaves);
    follow(Flow { motion, ..flow }, region, state, options)
}

fn options(began: &State, leaves: bool) -> TraceOptions {
    TraceOptions {
        control: FINE,
        leaves,
        met: DiagonalContacts::beginning(began),
    }
}

/// Start of the quarters that leave the straight shape along φ₁ = −φ₂. Returns `None` if the bounds do not allow it.
fn straight_shape(region: &Region, index: usize) -> Option<StartState> {
    let straight = Vector2::zeros();
    let track = Track::new(region, index, &straight, 1.0)?.back();
    (region.overstepped(&straight) <= 0.0).then_some(StartState {
        state: [0.0; 6],
        motion: Motion::Along(track),
    })
}

/// State at which the multiplier of φ₁ = −φ₂ falls to zero along a stretch of that line. Its curvature has no θ component, so the
/// place is the same for every λ₄.
fn turn(flow: Flow<'_>, region: &Region, stretch: &Stretch) -> Option<State> {
    let start = StartState {
        state: stretch.from,
        motion: Motion::Along(stretch.track),
    };
    let way = along_bounds(flow, region, start, true);
    match way.legs.as_slice() {
        [first, next, ..] if next.motion == Motion::Singular => Some(first.to),
        _ => None,
    }
}

/// Legs along bounds, one after the other.
fn stretches(legs: &[Leg]) -> Vec<Stretch> {
    let mut p = 0.0;
    let stretch = |leg: &Leg| {
        let Motion::Along(track) = leg.motion else {
            return None;
        };
        let begins = p;
        p += leg.length;
        Some(Stretch {
            track,
            from: leg.from,
            to: leg.to,
            span: [begins, p],
        })
    };
    nonempty_legs(legs).filter_map(stretch).collect()
}

/// First point on a bound towards φ₁ = −φ₂, where it meets φ₁ = φ₂ > 0, and the direction along the bound from there.
fn start(bound: &Bound) -> Option<(f64, f64)> {
    match bound {
        // φ₂ ≤ φ_max and φ₂ ≥ φ_min, both run towards smaller φ₁.
        Bound::Straight(edge) => {
            let top = edge.normal.y > 0.5 && edge.kind != ArcKind::Diagonal;
            if top {
                Some((edge.offset, 1.0))
            } else {
                (edge.kind == ArcKind::Lower).then_some((-edge.offset, -1.0))
            }
        }
        Bound::Clearance(clearance) => clearance.on_diagonal().map(|corner| (corner, 1.0)),
    }
}

impl StartFamily {
    pub(crate) fn range(&self) -> [f64; 2] {
        match self {
            Self::StartLine { low, high } => [*low, *high],
            Self::Bounds { stretches } => [0.0, stretches.last().map_or(0.0, |last| last.span[1])],
            Self::EndLine { .. } => [-1.0, 1.0],
        }
    }

    fn stretches(&self) -> &[Stretch] {
        match self {
            Self::StartLine { .. } => &[],
            Self::Bounds { stretches } | Self::EndLine { stretches, .. } => stretches,
        }
    }

    /// `true` if quarters that leave the family may show this behaviour at their first contact with φ₁ = −φ₂.
    pub(crate) fn may(&self, touch: Touch) -> bool {
        !matches!(self, Self::EndLine { touch: done, .. } if *done != touch)
    }

    /// Contacts with the diagonals of a quarter that leaves the family in a state.
    pub(crate) fn met(&self, state: &State) -> DiagonalContacts {
        let begins = self.start().map_or(*state, |start| start.state);
        let met = DiagonalContacts::beginning(&begins);
        match self {
            Self::EndLine {
                stretches, turn, ..
            } => stretches
                .last()
                .map_or(met, |last| met.and_ran(&last.from, turn)),
            _ => met,
        }
    }

    /// The state at a place; `flow` only carries the model. None outside the family.
    pub(crate) fn place(&self, flow: Flow<'_>, p: f64, control: StepControl) -> Option<StartState> {
        match self {
            Self::StartLine { .. } => Some(StartState {
                state: [p, p, 0.0, 0.0, 0.0, 0.0],
                motion: Motion::Singular,
            }),
            Self::Bounds { stretches } => {
                let stretch = stretches
                    .iter()
                    .find(|stretch| p >= stretch.span[0] && p <= stretch.span[1])?;
                let motion = Motion::Along(stretch.track);
                let drive = Flow { motion, ..flow };
                let start = Point::new(&drive, stretch.from);
                let state = advance(&drive, start, p - stretch.span[0], control)?.z;
                Some(StartState { state, motion })
            }
            Self::EndLine {
                stretches, turn, ..
            } => Some(StartState {
                state: *turn,
                motion: Motion::Along(stretches.last()?.track),
            }),
        }
    }

    /// `y_f` of the extremal that becomes singular at a place: the one for which the height vanishes there.
    pub(crate) fn final_y(&self, model: &Model<f64>, place: &StartState, p: f64) -> Option<f64> {
        let [_, y, theta] = pose(&place.state);
        let final_y = match self {
            Self::EndLine { .. } => y + p / (1.0 - p * p),
            _ => y - Momentum::of_zero(model, &shape(&place.state), -theta)?.c,
        };
        final_y.is_finite().then_some(final_y)
    }

    /// The place nearest to a shape, approximately: bounds count as the chords of their stretches. Returns `None` if shapes do
    /// not determine the place.
    pub(crate) fn nearest(&self, phi: &Vector2<f64>) -> Option<f64> {
        match self {
            Self::StartLine { low, high } => Some((0.5 * (phi.x + phi.y)).clamp(*low, *high)),
            Self::EndLine { .. } => None,
            Self::Bounds { stretches } => stretches
                .iter()
                .map(|stretch| {
                    let (from, to) = (shape(&stretch.from), shape(&stretch.to));
                    let chord = to - from;
                    let share = (phi - from).dot(&chord) / chord.norm_squared();
                    let share = share.clamp(0.0, 1.0);
                    let apart = (from + chord * share - phi).norm();
                    let [begins, ends] = stretch.span;
                    (apart, begins + share * (ends - begins))
                })
                .min_by(|(a, _), (b, _)| a.total_cmp(b))
                .map(|(_, p)| p),
        }
    }

    /// The first place along bounds.
    pub(crate) fn start(&self) -> Option<StartState> {
        self.stretches().first().map(|first| StartState {
            state: first.from,
            motion: Motion::Along(first.track),
        })
    }

    /// The last state along bounds.
    pub(crate) fn end(&self) -> Option<State> {
        self.stretches().last().map(|last| last.to)
    }
}
