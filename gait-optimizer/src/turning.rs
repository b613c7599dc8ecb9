//! The simple closed gait that turns the swimmer most per cycle.
//!
//! Rotations of the plane commute, so the net rotation of a closed gait is exactly ∬ F_θ dφ₁ dφ₂ over what it encloses
//! (F_θ is the θ row of the curvature, the same in every frame). The best simple loop round one
//! connected region of one sign runs along the region's edge: zero-level curves of F_θ, and arcs along the bounds where the
//! region reaches them.
//!
//! **Which way.** Mirroring the swimmer, Φ → −Φ, turns F_θ round, whatever the links: regions of either sign are mirror
//! images. The gait returned encloses a positive region and runs counter-clockwise: it turns the swimmer to the left
//! (rotation > 0). Reversed, or mirrored, it turns right.
//!
//! **Bounds.** F_θ has period 2π in both angles, so without any bound loops could grow over region after region. Without
//! one the angles are kept within ±π, where a side link lies folded on the middle one.
//!
//! **Holes.** A region with a hole is gone round outside: the hole counts against it.

#![allow(
    clippy::doc_markdown,
    reason = "formulas in the docs read like the paper's: F_θ"
)]

mod error;
mod walk;

use nalgebra::{DMatrix, Vector2};
use swimmer_files::{AnyGait, Bounds, Objective};
use swimmer_model::{Gait as _, Model, Swimmer};

pub use error::TurningError;

use crate::certificate::double_area;
use crate::certify::certified;
use crate::cycle::{Samples, power};
use crate::height_map::legendre::gauss;
use crate::height_map::{LevelSearch, level_seeds};
use crate::momentum::Motion;
use crate::optimal_gait::OptimalGait;
use crate::problem::{GaitClass, validated};
use crate::region::Region;
use walk::{Domain, Piece, close_up};

/// Inputs of the turning search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurningProblem {
    /// Swimmer. Side links may differ.
    pub swimmer: Swimmer<f64>,
    /// An upper bound of the angles, and links kept from crossing; lower bounds and the sector belong to quarter gaits.
    pub bounds: Bounds,
}

/// The gait that turns most, and the number of regions that were compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Turning {
    /// The gait; its bounds are those it was found within.
    pub gait: OptimalGait,
    /// Number of connected regions of positive F_θ; the rim of each hole counts as one.
    pub regions: usize,
}

/// Vertices nearer than this to where the cycle begins give way \[rad\].
const CROWDED: f64 = 1e-3;
/// Steps along zero-level curves and bounds, in a half width of the region.
const STEPS: f64 = 240.0;

/// Finds the simple closed gait that turns most within the bounds.
///
/// # Errors
/// [`TurningError`]: what is wrong with the problem, or why there is no such gait.
///
/// ```
/// use gait_optimizer::{Bounds, TurningProblem, turning};
/// use swimmer_model::Swimmer;
///
/// let bounds = Bounds::within(1.2);
/// let found = turning(&TurningProblem { swimmer: Swimmer::purcell(), bounds })?;
/// assert!(found.gait.certificate.pass() && found.gait.rotation > 0.0);
/// # Ok::<(), gait_optimizer::TurningError>(())
/// ```
pub fn turning(problem: &TurningProblem) -> Result<Turning, TurningError> {
    let model = validated(&problem.swimmer, &problem.bounds, GaitClass::Closed)?;
    let mut found = at_resolution(problem, &model, 1.0)?;
    // As many samples as the certificate needs, up to a limit.
    for times in FINER {
        if found.gait.certificate.pass() {
            break;
        }
        if let Ok(finer) = at_resolution(problem, &model, times) {
            found = finer;
        }
    }
    let Turning { gait, .. } = &found;
    if gait.certificate.pass() {
        return Ok(found);
    }
    Err(TurningError::NotCertified {
        rotation: gait.rotation,
        failed: gait.certificate.failures(),
    })
}

/// Factors by which the sampling is refined.
const FINER: [f64; 3] = [2.0, 4.0, 8.0];

/// [`turning`] with `times` as many samples, certified or not.
fn at_resolution(
    problem: &TurningProblem,
    model: &Model<f64>,
    times: f64,
) -> Result<Turning, TurningError> {
    let mut bounds = problem.bounds;
    if bounds.max_angle.is_none() && !bounds.no_overlap {
        bounds.max_angle = Some(std::f64::consts::PI);
    }
    let region = Region::new(&bounds, &problem.swimmer.links);
    let reach = region.reach();
    let domain = Domain {
        model,
        region: &region,
        step: reach / (STEPS * times),
        stays_on_border: false,
    };
    let search = LevelSearch::new(reach);
    let level = domain.level(Motion::Singular);
    let seeds = level_seeds(&level, &search, |first, second| {
        DMatrix::from_fn(first.len(), second.len(), |i, j| {
            let at = |places: &[f64], i: usize| places.get(i).copied().unwrap_or(0.0) * reach;
            let phi = Vector2::new(at(first, i), at(second, j));
            model.first_derivatives(&phi).curvature().z
        })
    });
    let rounds = domain.rounds(&search, &seeds)?;
    let of = (Objective::Turning, &problem.swimmer, &bounds);
    let mut best: Option<OptimalGait> = None;
    for round in &rounds {
        let pieces = begun_on_diagonal(round, domain);
        let found = gait(of, &pieces, model).ok_or_else(|| no_gait(&pieces))?;
        let outside = double_area(found.phi()) > 0.0;
        let least = best
            .as_ref()
            .map_or(f64::NEG_INFINITY, |most| most.rotation);
        if outside && found.rotation > least {
            best = Some(found);
        }
    }
    Ok(Turning {
        gait: certified(best.ok_or(TurningError::NoRegion)?),
        regions: rounds.len(),
    })
}

/// An edge whose points make no closed gait: too small, or closed only nearly.
fn no_gait(pieces: &[Piece]) -> TurningError {
    let first = pieces.first().and_then(|piece| piece.points.first());
    let nowhere = Vector2::repeat(f64::NAN);
    TurningError::lost(first.copied().unwrap_or(nowhere), "it is too small")
}

/// The pieces in order from where the curve first meets φ₁ = φ₂ > 0; from where they are where it does not.
fn begun_on_diagonal(round: &[Piece], domain: Domain<'_>) -> Vec<Piece> {
    let off = |phi: &Vector2<f64>| phi.x - phi.y;
    let sides = round.iter().enumerate().flat_map(|(number, piece)| {
        let sides = piece.points.array_windows().enumerate();
        sides.map(move |(at, side)| (number, at, side))
    });
    let met = sides.filter_map(|(number, at, [a, b])| {
        if (off(a) >= 0.0) == (off(b) >= 0.0) || a.sum() + b.sum() < 1e-6 {
            return None;
        }
        let middle = 0.5 * (a + (b - a) * (off(a) / (off(a) - off(b)))).sum();
        let [low, high] = [-1.0, 1.0].map(|way| Vector2::repeat(middle + way * (b - a).norm()));
        let level = domain.level(round[number].motion);
        Some((number, at, level.between(&low, &high)?))
    });
    let Some((number, at, met)) = met.min_by(|a, b| a.2.sum().total_cmp(&b.2.sum())) else {
        return round.to_vec();
    };
    let mut pieces = round.to_vec();
    pieces.rotate_left(number);
    let mut tail = pieces[0].clone();
    let mut head = tail.points.split_off(at + 1);
    close_up(&mut tail.points, met, CROWDED);
    head.reverse();
    close_up(&mut head, met, CROWDED);
    head.reverse();
    pieces[0].points = head;
    pieces.push(tail);
    // Cut at a corner, one of both parts is nothing.
    pieces.retain(Piece::lasts);
    pieces
}

/// The pieces' points at constant power. Returns `None` if they make no gait.
fn sampled(pieces: &[Piece], model: &Model<f64>) -> Option<Samples> {
    let mut samples = Samples::default();
    for piece in pieces {
        let from = samples.phi.len().saturating_sub(1);
        let new = piece.points.iter().skip(usize::from(from > 0));
        samples.phi.extend(new.copied());
        let to = samples.phi.len() - 1;
        samples.arcs.push((piece.motion.kind(), from, to));
        samples.corners.push(from);
    }
    // Exactly closed.
    *samples.phi.last_mut()? = *samples.phi.first()?;
    if begins_smoothly(pieces) {
        samples.corners.remove(0);
    }
    samples.along.push(0.0);
    for [a, b] in samples.phi.array_windows() {
        samples.along.push(samples.along.last()? + (b - a).norm());
    }
    let by_chord = samples.closed();
    samples.along = power_lengths(&by_chord.gait().ok()?, &by_chord.u, model);
    Some(samples)
}

/// `true` if the last piece of a closed curve continues into the first without a corner.
fn begins_smoothly(pieces: &[Piece]) -> bool {
    let Some((first, last)) = pieces.first().zip(pieces.last()) else {
        return false;
    };
    let starts = first.points.array_windows().next();
    let ends = last.points.array_windows().next_back();
    let goes_on = starts.zip(ends).is_some_and(|([a, b], [c, d])| {
        let (before, after) = (d - c, b - a);
        before.perp(&after).abs() < 0.1 * before.dot(&after)
    });
    first.motion == last.motion && goes_on
}

/// ∫√(Φ′ᵀWΦ′) up to each knot.
fn power_lengths(gait: &AnyGait, u: &[f64], model: &Model<f64>) -> Vec<f64> {
    let (nodes, weights) = gauss(4);
    let (mut length, mut lengths) = (0.0, vec![0.0]);
    for [a, b] in u.array_windows() {
        for (s, w) in nodes.iter().zip(&weights) {
            let point = gait.at(a + 0.5 * (s + 1.0) * (b - a));
            let power = power(model, &point.phi, &point.rate);
            length += 0.5 * (b - a) * w * power.max(0.0).sqrt();
        }
        lengths.push(length);
    }
    lengths
}

/// A loop around a region, not yet certified. Returns `None` if the pieces make no gait.
fn gait(
    of: (Objective, &Swimmer<f64>, &Bounds),
    pieces: &[Piece],
    model: &Model<f64>,
) -> Option<OptimalGait> {
    let cycle = sampled(pieces, model)?.closed();
    let stroke = cycle.swum(model)?;
    Some(OptimalGait::of_cycle(of, false, cycle, &stroke))
}
