//! Round the regions where the curvature turns left, each on the left: along zero-level curves and along bounds alike. Both are
//! curves on which one of several functions vanishes while the others are positive, and where another one falls through zero, it
//! takes over. So every piece of either kind belongs to exactly one walk, and all walks together go round all regions.

use std::convert::Infallible;

use nalgebra::Vector2;
use swimmer_model::Model;

use super::error::TurningError;
use crate::arcs::Event;
use crate::height_map::{End, Level, LevelSearch, OnCurve, Stride, passes};
use crate::momentum::{Momentum, Motion, Track};
use crate::region::Region;

/// Inputs of the traces.
#[derive(Clone, Copy)]
pub(super) struct Domain<'a> {
    pub(super) model: &'a Model<f64>,
    pub(super) region: &'a Region,
    /// Longest step \[rad\].
    pub(super) step: f64,
    /// `true` to continue along bounds where the curvature is negative.
    pub(super) stays_on_border: bool,
}

/// One arc of a walk.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Piece {
    pub(super) motion: Motion,
    pub(super) points: Vec<Vector2<f64>>,
}

/// A place with what is run along there.
type WalkState = (Motion, OnCurve);

/// Curvatures this small count as zero.
const ZERO: f64 = 1e-13;
/// Another function takes over where it is below zero by more than this.
const BEYOND: f64 = 1e-13;
/// Distance beyond a corner at which the next piece of another bound is determined \[rad\].
const AHEAD: f64 = 1e-5;
/// A walk is back at a corner if it comes this near \[rad\].
const BACK: f64 = 1e-6;
/// Shorter arcs are crossings of a corner, not arcs \[rad\].
const LASTING: f64 = 1e-9;
/// After more arcs than this a walk has lost its way.
const MOST_ARCS: usize = 1000;

impl Domain<'_> {
    /// All walks, or where one loses its way: closed curves with a region of positive curvature on the left, each piece begins where
    /// the one before ends.
    pub(super) fn rounds(
        self,
        search: &LevelSearch,
        seeds: &[Vector2<f64>],
    ) -> Result<Vec<Vec<Piece>>, TurningError> {
        let along_border = self.border().ok_or(TurningError::Border)?;
        let places = along_border
            .iter()
            .flat_map(|piece| piece.points.iter().map(|phi| (piece.motion, *phi)));
        let border: Vec<_> = places
            .map(|(motion, phi)| (motion, phi, curvature(self.model, &phi).0))
            .collect();
        if border.iter().all(|(.., value)| value.abs() <= ZERO) {
            let what = "the curvature vanishes all along the bounds";
            return Err(TurningError::lost(Vector2::zeros(), what));
        }
        let mut rounds = Vec::new();
        if border.iter().all(|(.., value)| *value > ZERO) {
            rounds.push(along_border);
        }
        // Where walks leave the border; then what they did not meet.
        let pairs = border.iter().zip(border.iter().cycle().skip(1));
        let leaving = pairs.filter(|(here, next)| here.2 > ZERO && next.2 <= ZERO);
        let inland = seeds
            .iter()
            .rev()
            .filter(|seed| self.region.overstepped(seed) < -1e-7);
        let starts = leaving.map(|((motion, phi, _), _)| (*motion, phi));
        for (motion, phi) in starts.chain(inland.map(|seed| (Motion::Singular, seed))) {
            let mut known = rounds.iter().flatten();
            let is_known = known.any(|piece: &Piece| {
                piece.motion == motion && passes(&piece.points, phi, search.close())
            });
            if !is_known {
                rounds.push(self.round(motion, *phi)?);
            }
        }
        Ok(rounds)
    }

    /// Boundary of the admissible region around the straight shape. Returns `None` if it does not close.
    fn border(self) -> Option<Vec<Piece>> {
        // Where φ₂ = 0 no other link is near, and only the bound on φ₁ binds.
        let mut edges = self.region.edges().iter().enumerate();
        let (first, edge) = edges.find(|(_, edge)| edge.normal.x > 0.5)?;
        let start = Vector2::new(edge.offset, 0.0);
        let track = Track::new(self.region, first, &start, 1.0)?;
        let on_border = Self {
            stays_on_border: true,
            ..self
        };
        on_border.round(Motion::Along(track), start).ok()
    }

    /// From the first corner behind a shape once round to that corner; the whole curve from the shape where there is no corner.
    fn round(self, motion: Motion, phi: Vector2<f64>) -> Result<Vec<Piece>, TurningError> {
        let mut here = self.on(motion, phi)?;
        let mut pieces: Vec<Piece> = Vec::new();
        for number in 0..MOST_ARCS {
            if let Some(first) = pieces.first()
                && first.motion == here.0
                && (first.points[0] - here.1.phi).norm() < BACK
            {
                return Ok(pieces);
            }
            let (piece, next) = self.arc(here)?;
            let Some(next) = next else {
                return Ok(vec![piece]);
            };
            // The first one began anywhere.
            if number > 0 && piece.lasts() {
                pieces.push(piece);
            }
            here = next;
        }
        Err(TurningError::lost(phi, "a walk does not come round"))
    }

    /// Along one motion to where another one takes over; to no other one where it comes round.
    fn arc(self, (motion, from): WalkState) -> Result<(Piece, Option<WalkState>), TurningError> {
        let level = self.level(motion);
        let value = |event, at: &OnCurve| {
            let (value, gradient) = self.value(event, motion, &at.phi);
            (value, gradient.dot(&at.tangent))
        };
        let is_beyond = |event: &Event<Infallible>, at: &OnCurve| value(*event, at).0 < -BEYOND;
        let mut points = vec![from];
        let stride = Stride {
            longest: self.step,
            turn: if motion == Motion::Singular {
                0.12
            } else {
                0.02
            },
        };
        let end = level.walk(&mut points, stride, |at| {
            at.slope_left > 0.0 && !self.beside(motion).any(|event| is_beyond(&event, at))
        });
        let here = points.last().copied().unwrap_or(from);
        let lost = |what| TurningError::lost(here.phi, what);
        let gap = 0.3 * self.step;
        let mut points: Vec<_> = points.iter().map(|at| at.phi).collect();
        if motion != Motion::Singular {
            points.dedup_by(|next, kept| (*next - *kept).norm() < gap);
        }
        let next = match end {
            End::Closed => None,
            End::Stuck => return Err(lost("a curve has a kink, or nearly crosses another one")),
            End::Met(step, beyond) => {
                let events = self
                    .beside(motion)
                    .filter(|event| is_beyond(event, &beyond));
                let met = events.filter_map(|event| {
                    let (at, length) = level.cut(&here, step, |at| value(event, at))?;
                    (at.slope_left > 0.0).then_some((event, at, length))
                });
                let next = if let Some((event, at, _)) = met.min_by(|a, b| a.2.total_cmp(&b.2)) {
                    self.after(motion, event, &at)?
                } else {
                    let node = level.node(&here, &beyond);
                    let node = node.ok_or_else(|| lost("it is not clear what a curve meets"))?;
                    (motion, node)
                };
                close_up(&mut points, next.1.phi, gap);
                Some(next)
            }
        };
        Ok((Piece { motion, points }, next))
    }

    /// Level function of a motion: it vanishes along the motion and rises to its left.
    pub(super) fn level(
        self,
        motion: Motion,
    ) -> Level<impl Fn(&Vector2<f64>) -> (f64, Vector2<f64>)> {
        Level(move |phi: &Vector2<f64>| match motion {
            Motion::Singular => curvature(self.model, phi),
            Motion::Along(track) => {
                let level = track.wall.level(phi);
                (level.value, level.gradient)
            }
        })
    }

    /// Other functions that must stay positive along a motion.
    fn beside(self, motion: Motion) -> impl Iterator<Item = Event<Infallible>> {
        let is_heeded = motion != Motion::Singular && !self.stays_on_border;
        let bounds = 0..self.region.bounds().count();
        let others = bounds.filter(move |index| Some(*index) != motion.bound());
        let curvature = is_heeded.then_some(Event::HeightGone);
        let events = curvature.into_iter().chain(others.map(Event::Bound));
        events.chain([Event::PieceEnd])
    }

    /// Its value, and how that changes with the shape.
    fn value(
        self,
        event: Event<Infallible>,
        motion: Motion,
        phi: &Vector2<f64>,
    ) -> (f64, Vector2<f64>) {
        let none = (1.0, Vector2::zeros());
        match event {
            Event::Bound(index) => self
                .region
                .bound(index)
                .map_or(none, |bound| (bound.margin(phi), bound.gradient(phi))),
            Event::PieceEnd => motion.piece_end(phi).unwrap_or(none),
            _ => curvature(self.model, phi),
        }
    }

    /// Motion after an event.
    fn after(
        self,
        motion: Motion,
        event: Event<Infallible>,
        at: &OnCurve,
    ) -> Result<WalkState, TurningError> {
        let next = match event {
            Event::PieceEnd => motion.next_piece(),
            Event::Bound(index) => {
                let ahead = at.phi + at.tangent * AHEAD;
                Track::new(self.region, index, &ahead, 1.0).map(Motion::Along)
            }
            _ => Some(Motion::Singular),
        };
        let next = next.ok_or_else(|| TurningError::lost(at.phi, "a bound ends nowhere"))?;
        self.on(next, at.phi)
    }

    /// Start of a motion.
    fn on(self, motion: Motion, phi: Vector2<f64>) -> Result<WalkState, TurningError> {
        let on = self.level(motion).corrected(&phi, None, 1e-6);
        let on = on.ok_or_else(|| TurningError::lost(phi, "zero-level curves cross"))?;
        Ok((motion, OnCurve { phi, ..on }))
    }
}

impl Piece {
    /// `true` if it is longer than a corner.
    pub(super) fn lasts(&self) -> bool {
        let mut sides = self.points.array_windows();
        sides.any(|[a, b]| (b - a).norm() > LASTING)
    }
}

/// Ends a polyline at a point, without a last vertex too near to it.
pub(super) fn close_up(points: &mut Vec<Vector2<f64>>, end: Vector2<f64>, gap: f64) {
    while points.len() > 1 && points.last().is_some_and(|last| (last - end).norm() < gap) {
        points.pop();
    }
    points.push(end);
}

/// The curvature of θ with its gradient: the height of the momentum that is dual to the rotation alone.
fn curvature(model: &Model<f64>, phi: &Vector2<f64>) -> (f64, Vector2<f64>) {
    const TURNS: Momentum = Momentum {
        p: Vector2::new(0.0, 0.0),
        c: 1.0,
    };
    let (height, ..) = TURNS.evaluate(model, phi, &[0.0; 3]);
    (height.value, height.gradient)
}
