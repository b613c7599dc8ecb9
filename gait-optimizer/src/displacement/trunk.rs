//! Where singular arcs may begin: on φ₁ = φ₂, or anywhere along the bounds that lead from there to φ₁ = −φ₂.

use std::f64::consts::PI;

use nalgebra::Vector2;
use swimmer_files::{ArcKind, Bounds};

use super::flow::{Fate, Leg, along_bounds, is_end_line};
use super::height::Extremal;
use super::search::{FINE, lasting};
use crate::momentum::{Flow, Motion, State, Track, shape};
use crate::region::{Bound, Piece, Region};
use crate::runge_kutta::{Point, advance};

/// A line of places.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Trunk {
    /// φ₁ = φ₂ = p.
    StartLine { low: f64, high: f64 },
    /// Along bounds; p is the way along them. Poses are carried along.
    Bounds {
        stretches: Vec<Stretch>,
        /// Where arcs may begin at the earliest.
        low: f64,
        /// How often φ₁ = −φ₂ was touched up to there.
        touched: usize,
    },
}

/// A part of the way along bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stretch {
    track: Track,
    from: State,
    to: State,
    /// Where it starts and ends, as p.
    span: [f64; 2],
}

/// A place on a trunk.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) state: State,
    /// What the curve runs along up to here; singular on φ₁ = φ₂.
    pub(crate) motion: Motion,
}

/// All trunks of a region.
pub(crate) fn trunks(extremal: Extremal<'_>, bounds: &Bounds, region: &Region) -> Vec<Trunk> {
    let mut trunks = vec![Trunk::StartLine {
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
        if let Bound::Clearance(clearance) = &bound {
            track.piece = Some(if clearance.has_corner() {
                Piece::BackTip
            } else {
                Piece::Tips
            });
        }
        let way = along_bounds(extremal, region, state, track, (FINE, 0));
        let stretches = stretches(way.legs());
        if way.fate == Fate::Ended && !stretches.is_empty() {
            trunks.push(Trunk::Bounds {
                stretches,
                low: 0.0,
                touched: 0,
            });
        }
    }
    trunks
}

/// The trunks along φ₁ = −φ₂, where that is a bound, inwards from where those along other bounds meet it. Quarters leave them
/// to go round shapes about the straight one that the other bounds do not meet.
pub(crate) fn trunks_on_the_diagonal(
    extremal: Extremal<'_>,
    region: &Region,
    trunks: &[Trunk],
) -> Vec<Trunk> {
    let mut found = Vec::new();
    let Some(index) = region.bounds().position(|bound| is_end_line(&bound)) else {
        return found;
    };
    for trunk in trunks {
        let Some(Place {
            state,
            motion: Motion::Along(track),
        }) = trunk.start()
        else {
            continue;
        };
        let way = along_bounds(extremal, region, state, track, (FINE, 1));
        let stretches = stretches(way.legs());
        let touching = stretches
            .iter()
            .find(|stretch| stretch.track.index == index);
        if let (Fate::Ended, Some(touching)) = (way.fate, touching) {
            found.push(Trunk::Bounds {
                low: touching.span[0],
                stretches,
                touched: 1,
            });
        }
    }
    found
}

/// Legs along bounds, one after the other.
fn stretches(legs: &[Leg]) -> Vec<Stretch> {
    let mut p = 0.0;
    lasting(legs)
        .filter_map(|leg| {
            let stretch = stretch(leg, p)?;
            p = stretch.span[1];
            Some(stretch)
        })
        .collect()
}

/// Where a bound that leads towards φ₁ = −φ₂ meets φ₁ = φ₂ > 0, and which way round it is run from there.
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

fn stretch(leg: &Leg, p: f64) -> Option<Stretch> {
    let Motion::Along(track) = leg.motion else {
        return None;
    };
    Some(Stretch {
        track,
        from: leg.from,
        to: leg.to,
        span: [p, p + leg.length],
    })
}

impl Trunk {
    pub(crate) fn range(&self) -> [f64; 2] {
        match self {
            Self::StartLine { low, high } => [*low, *high],
            Self::Bounds { stretches, low, .. } => {
                [*low, stretches.last().map_or(*low, |last| last.span[1])]
            }
        }
    }

    /// How often a quarter has touched φ₁ = −φ₂ where it leaves the trunk.
    pub(crate) fn touched(&self) -> usize {
        match self {
            Self::StartLine { .. } => 0,
            Self::Bounds { touched, .. } => *touched,
        }
    }

    /// Whether the places lie on φ₁ = −φ₂.
    pub(crate) fn on_diagonal(&self) -> bool {
        match self {
            Self::StartLine { .. } => false,
            Self::Bounds { stretches, .. } => stretches
                .last()
                .is_some_and(|last| is_end_line(&last.track.bound)),
        }
    }

    /// The state at a place; `extremal` only carries the model. None outside the trunk.
    pub(crate) fn place(&self, extremal: Extremal<'_>, p: f64) -> Option<Place> {
        match self {
            Self::StartLine { .. } => Some(Place {
                state: [p, p, 0.0, 0.0, 0.0, 0.0],
                motion: Motion::Singular,
            }),
            Self::Bounds { stretches, .. } => {
                let stretch = stretches
                    .iter()
                    .find(|stretch| p >= stretch.span[0] && p <= stretch.span[1])?;
                let motion = Motion::Along(stretch.track);
                let drive = Flow {
                    model: extremal.model,
                    momentum: extremal.momentum(),
                    motion,
                };
                let start = Point::new(&drive, stretch.from);
                let state = advance(&drive, start, p - stretch.span[0], FINE)?.z;
                Some(Place { state, motion })
            }
        }
    }

    /// The place nearest to a shape, about: bounds count as the chords of their stretches.
    pub(crate) fn nearest(&self, phi: &Vector2<f64>) -> Option<f64> {
        match self {
            Self::StartLine { low, high } => Some((0.5 * (phi.x + phi.y)).clamp(*low, *high)),
            Self::Bounds { stretches, .. } => stretches
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
    pub(crate) fn start(&self) -> Option<Place> {
        match self {
            Self::StartLine { .. } => None,
            Self::Bounds { stretches, .. } => stretches.first().map(|first| Place {
                state: first.from,
                motion: Motion::Along(first.track),
            }),
        }
    }

    /// The last state along bounds.
    pub(crate) fn end(&self) -> Option<State> {
        match self {
            Self::StartLine { .. } => None,
            Self::Bounds { stretches, .. } => stretches.last().map(|last| last.to),
        }
    }
}
