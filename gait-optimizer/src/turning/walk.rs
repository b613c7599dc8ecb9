//! Round the regions where the curvature turns left: along zero-level curves and along the border, the region always on
//! the left. Every piece of either belongs to exactly one such walk, so all walks together go round all regions.

use nalgebra::Vector2;
use swimmer_files::ArcKind;
use swimmer_model::Model;

use super::border::Border;
use super::error::TurningError;
use super::piece::{Piece, close_up, pieces_of, singular};
use crate::height_map::{Level, LevelSearch, OnCurve, passes};
use crate::numerics::halved;
use crate::region::Region;

/// What the walks go by.
pub(super) struct Domain<'a, F> {
    pub(super) region: &'a Region,
    pub(super) border: &'a Border,
    pub(super) level: &'a Level<F>,
    pub(super) step: f64,
}

/// A place of the border where the curvature changes sign.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    phi: Vector2<f64>,
    /// Index of the point before it.
    after: usize,
    /// Whether the curvature falls there, going counter-clockwise: a walk leaves the border.
    leaves: bool,
}

/// Halvings that place a crossing.
const HALVINGS: usize = 60;
/// Curvatures this small count as zero.
const ZERO: f64 = 1e-13;
/// A curve ends at a crossing if it comes this near \[rad\].
const ARRIVED: f64 = 1e-6;
/// More points than this and the walk has lost its way.
const MOST_POINTS: usize = 60_000;

/// The curvature of θ and its gradient.
pub(super) fn curvature(model: &Model<f64>, phi: &Vector2<f64>) -> (f64, Vector2<f64>) {
    let second = model.second_derivatives(phi);
    let [along1, along2] = second.d_curvature();
    (second.first.curvature().z, Vector2::new(along1.z, along2.z))
}

impl<F: Fn(&Vector2<f64>) -> (f64, Vector2<f64>)> Domain<'_, F> {
    /// All walks, or where one loses its way: closed curves with a region of positive curvature on the left, each piece begins where
    /// the one before ends.
    pub(super) fn rounds(
        &self,
        search: &LevelSearch,
        seeds: Vec<Vector2<f64>>,
    ) -> Result<Vec<Vec<Piece>>, TurningError> {
        let crossings = self.crossings().ok_or_else(|| {
            TurningError::lost(
                Vector2::zeros(),
                "the curvature vanishes all along the bounds",
            )
        })?;
        let mut rounds: Vec<Vec<Piece>> = Vec::new();
        let mut unused: Vec<usize> = (0..crossings.len())
            .filter(|&i| crossings[i].leaves)
            .collect();
        while let Some(&first) = unused.first() {
            let mut round = Vec::new();
            let mut at = first;
            loop {
                unused.retain(|&crossing| crossing != at);
                let (inland, arrived) = self.across(&crossings, at)?;
                round.extend(inland);
                let (along, left) = self.along_border(&crossings, arrived)?;
                round.extend(along);
                at = left;
                if at == first {
                    break;
                }
                if !unused.contains(&at) {
                    let place = crossings[at].phi;
                    return Err(TurningError::lost(place, "two regions share an edge"));
                }
            }
            rounds.push(round);
        }
        if crossings.is_empty() {
            let (points, first) = (&self.border.points, self.border.points[0]);
            if self.sign(&first.phi) > 0 {
                let gap = 0.3 * self.step;
                rounds.push(pieces_of(first.phi, first.track, points, first.phi, gap));
            }
        }
        // What the walks from the border did not meet is closed.
        let mut seeds = seeds;
        seeds.retain(|seed| self.region.overstepped(seed) < -1e-7);
        while !seeds.is_empty() {
            seeds.retain(|seed| {
                !rounds.iter().flatten().any(|piece| {
                    piece.kind == ArcKind::Singular && passes(&piece.points, seed, search.close())
                })
            });
            let Some(seed) = seeds.pop() else { break };
            rounds.push(self.inland_round(&seed)?);
        }
        Ok(rounds)
    }

    fn value(&self, phi: &Vector2<f64>) -> f64 {
        self.level.at(phi).0
    }

    /// The sign of the curvature; 0 where it is zero but for rounding.
    fn sign(&self, phi: &Vector2<f64>) -> i8 {
        let value = self.value(phi);
        i8::from(value > ZERO) - i8::from(value < -ZERO)
    }

    /// All crossings, counter-clockwise.
    fn crossings(&self) -> Option<Vec<Crossing>> {
        let points = &self.border.points;
        let signs: Vec<i8> = points.iter().map(|s| self.sign(&s.phi)).collect();
        let count = points.len();
        let start = signs.iter().position(|&sign| sign != 0)?;
        let mut crossings = Vec::new();
        let (mut last, mut last_sign) = (start, signs[start]);
        for k in 1..=count {
            let i = (start + k) % count;
            let sign = signs[i];
            if sign == 0 {
                continue;
            }
            if sign != last_sign {
                crossings.push(self.crossing(last, i, last_sign > 0));
            }
            (last, last_sign) = (i, sign);
        }
        crossings.sort_by_key(|crossing| crossing.after);
        Some(crossings)
    }

    /// The crossing between two points of different sign; points between them, if any, are zeros.
    fn crossing(&self, last: usize, next: usize, leaves: bool) -> Crossing {
        let points = &self.border.points;
        let after = (last + 1) % points.len();
        if after != next {
            let phi = points[after].phi;
            return Crossing { phi, after, leaves };
        }
        let (a, b) = (&points[last], &points[next]);
        let before = |share| (self.value(&Border::between(a, b, share)) > 0.0) == leaves;
        let [_, share] = halved([0.0, 1.0], HALVINGS, before);
        Crossing {
            phi: Border::between(a, b, share),
            after: last,
            leaves,
        }
    }

    /// From a crossing inland along zero-level curves to the crossing where they meet the border again.
    fn across(
        &self,
        crossings: &[Crossing],
        from: usize,
    ) -> Result<(Vec<Piece>, usize), TurningError> {
        let phi = crossings[from].phi;
        let lost = |what| TurningError::lost(phi, what);
        let begin = self.level.corrected(&phi, None, 1e-6);
        let begin = begin.ok_or_else(|| lost("zero-level curves cross on the bound"))?;
        let begin = OnCurve {
            phi,
            ..positive_left(begin)
        };
        let (mut pieces, end) = self.inland(begin, None)?;
        let end = end.ok_or_else(|| lost("a zero-level curve does not end"))?;
        let gap = |i: usize| (crossings[i].phi - end).norm();
        let arrived = (0..crossings.len())
            .filter(|&i| !crossings[i].leaves && gap(i) < ARRIVED)
            .min_by(|&a, &b| gap(a).total_cmp(&gap(b)))
            .ok_or_else(|| TurningError::lost(end, "a zero-level curve touches the bound"))?;
        if let Some(last) = pieces.last_mut() {
            close_up(&mut last.points, crossings[arrived].phi, 0.3 * self.step);
        }
        Ok((pieces, arrived))
    }

    /// Along zero-level curves from a point on one, turning left where they cross, until the border (its place is
    /// returned) or, with `home`, until back there.
    fn inland(
        &self,
        begin: OnCurve,
        home: Option<Vector2<f64>>,
    ) -> Result<(Vec<Piece>, Option<Vector2<f64>>), TurningError> {
        let mut pieces = Vec::new();
        let mut points = vec![begin.phi];
        let (mut here, mut step) = (begin, self.step);
        let mut walked = 0;
        while walked < MOST_POINTS {
            if let Some(home) = home
                && walked > 8
            {
                let ahead = (home - here.phi).dot(&here.tangent);
                let off = (home - here.phi).perp(&here.tangent).abs();
                if ahead > 0.0 && ahead <= step && off <= 0.2 * ahead {
                    close_up(&mut points, home, 0.3 * self.step);
                    pieces.push(singular(points));
                    return Ok((pieces, None));
                }
            }
            let shorter = |step: f64, what| {
                if step > 1e-8 * self.step {
                    Ok(0.5 * step)
                } else {
                    Err(TurningError::lost(here.phi, what))
                }
            };
            let Some(next) = self.level.stepped(&here, step) else {
                step = shorter(step, "a zero-level curve has a kink")?;
                continue;
            };
            walked += 1;
            if self.region.overstepped(&next.phi) > 1e-12 {
                let end = self.leaving(&here, step).ok_or_else(|| {
                    TurningError::lost(here.phi, "a zero-level curve runs along the bound")
                })?;
                pieces.push(singular(points));
                return Ok((pieces, Some(end)));
            }
            if next.slope_left < 0.0 {
                // The curve has crossed another one: beyond, the region lies to the right.
                let Some((node, ahead)) = self.node(&here, &next) else {
                    step = shorter(step, "zero-level curves nearly cross")?;
                    continue;
                };
                close_up(&mut points, node, 0.3 * self.step);
                pieces.push(singular(points));
                points = vec![node];
                here = self.after(node, ahead)?;
            } else {
                here = next;
            }
            points.push(here.phi);
            step = (1.5 * step).min(self.step);
        }
        Err(TurningError::lost(
            here.phi,
            "a zero-level curve does not end",
        ))
    }

    /// Where a step leaves the region.
    fn leaving(&self, here: &OnCurve, step: f64) -> Option<Vector2<f64>> {
        let at = |length: f64| {
            let guess = here.phi + here.tangent * length;
            let point = self.level.corrected(&guess, Some(&here.tangent), step);
            point.map(|point| point.phi)
        };
        let inside = |length| at(length).is_some_and(|phi| self.region.overstepped(&phi) <= 0.0);
        let [_, length] = halved([0.0, step], HALVINGS, inside);
        at(length)
    }

    /// Counter-clockwise along the border from a crossing to the next one where the walk leaves it.
    fn along_border(
        &self,
        crossings: &[Crossing],
        from: usize,
    ) -> Result<(Vec<Piece>, usize), TurningError> {
        let points = &self.border.points;
        let to = (from + 1) % crossings.len();
        let (begin, end) = (&crossings[from], &crossings[to]);
        if !end.leaves {
            return Err(TurningError::lost(
                end.phi,
                "the curvature changes sign twice at one place of the bound",
            ));
        }
        let mut ahead = Vec::new();
        let mut i = begin.after;
        while i != end.after && ahead.len() <= points.len() {
            i = (i + 1) % points.len();
            ahead.push(points[i]);
        }
        // What ends at the crossing runs along the bound of the point before it.
        let track = points[begin.after].track;
        let pieces = pieces_of(begin.phi, track, &ahead, end.phi, 0.3 * self.step);
        Ok((pieces, to))
    }

    /// A walk that never meets the border.
    fn inland_round(&self, seed: &Vector2<f64>) -> Result<Vec<Piece>, TurningError> {
        let begin = self.level.corrected(seed, None, 1e-6);
        let begin = begin.ok_or_else(|| TurningError::lost(*seed, "zero-level curves branch"))?;
        let begin = positive_left(begin);
        match self.inland(begin, Some(begin.phi))? {
            (pieces, None) => Ok(pieces),
            (_, Some(end)) => Err(TurningError::lost(
                end,
                "a zero-level curve grazes the bound",
            )),
        }
    }
}

/// The same point, run with the function rising to the left.
fn positive_left(point: OnCurve) -> OnCurve {
    if point.slope_left < 0.0 {
        OnCurve {
            tangent: -point.tangent,
            slope_left: -point.slope_left,
            ..point
        }
    } else {
        point
    }
}
