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
//! **The supremum.** A loop may join several regions by bridges run there and back, which cost nothing and enclose
//! nothing: the more bridges, the nearer to ∬ max(F_θ, 0), which no simple loop reaches. That is the bridged supremum. A
//! region with a hole is gone round outside: the hole counts against it.

#![allow(
    clippy::doc_markdown,
    reason = "formulas in the docs read like the paper's: F_θ"
)]

mod border;
mod crossing;
mod error;
mod piece;
mod walk;

use nalgebra::{DMatrix, Vector2};
use swimmer_files::{AnyGait, ArcKind, Bounds, Objective};
use swimmer_model::{Gait as _, Model, Swimmer};

pub use error::TurningError;

use crate::certificate::double_area;
use crate::certify::certified;
use crate::cycle::Samples;
use crate::height_map::legendre::gauss;
use crate::height_map::{Level, LevelSearch, level_seeds};
use crate::optimal_gait::OptimalGait;
use crate::problem::{GaitClass, validated};
use crate::region::Region;
use border::Border;
use piece::{Piece, close_up};
use walk::{Domain, curvature};

/// Whose gait, and within what.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurningProblem {
    /// Whose gait. Side links may differ.
    pub swimmer: Swimmer<f64>,
    /// An upper bound of the angles, and links kept from crossing; lower bounds and the sector belong to quarter gaits.
    pub bounds: Bounds,
}

/// The gait that turns most, and what bridges could add.
#[derive(Debug, Clone, PartialEq)]
pub struct Turning {
    /// The gait; its bounds are those it was found within.
    pub gait: OptimalGait,
    /// ∬ max(F_θ, 0) \[rad\]: what loops with ever more bridges come near to.
    pub bridged_supremum: f64,
    /// How many connected regions of positive F_θ there are, counting what lies round each hole apart.
    pub regions: usize,
}

/// From point to point of the border \[rad\].
const SPACING: f64 = 0.012;
/// Vertices nearer than this to where the cycle begins give way \[rad\].
const CROWDED: f64 = 1e-3;
/// Steps along zero-level curves, in a half width of the region.
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
/// assert!(found.gait.certificate.pass() && found.gait.rotation.abs() <= found.bridged_supremum.abs() + 1e-9);
/// # Ok::<(), gait_optimizer::TurningError>(())
/// ```
pub fn turning(problem: &TurningProblem) -> Result<Turning, TurningError> {
    let model = validated(&problem.swimmer, &problem.bounds, GaitClass::Closed)?;
    let mut found = at_resolution(problem, &model, 1.0)?;
    // As many samples as the certificate asks for, where some number of them will do.
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

/// How many times as close samples may lie.
const FINER: [f64; 3] = [2.0, 4.0, 8.0];

/// As [`turning`], with so many times as many samples, whether it is certified or not.
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
    let border = Border::new(&region, SPACING / times).ok_or(TurningError::Border)?;
    let reach = border.reach();
    let level = Level(|phi: &Vector2<f64>| curvature(model, phi));
    let domain = Domain {
        region: &region,
        border: &border,
        level: &level,
        step: reach / (STEPS * times),
    };
    let search = LevelSearch::new(reach);
    let seeds = level_seeds(&level, &search, |first, second| {
        DMatrix::from_fn(first.len(), second.len(), |i, j| {
            let at = |places: &[f64], i: usize| places.get(i).copied().unwrap_or(0.0) * reach;
            let phi = Vector2::new(at(first, i), at(second, j));
            model.first_derivatives(&phi).curvature().z
        })
    });
    let rounds = domain.rounds(&search, seeds)?;
    let mut bridged_supremum = 0.0;
    let of = (Objective::Turning, &problem.swimmer, &bounds);
    let mut best: Option<OptimalGait> = None;
    for round in &rounds {
        let pieces = begun_on_diagonal(round, &border, &level);
        let found = gait(of, &pieces, model).ok_or_else(|| no_gait(&pieces))?;
        bridged_supremum += found.rotation;
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
        bridged_supremum,
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
fn begun_on_diagonal<F: Fn(&Vector2<f64>) -> (f64, Vector2<f64>)>(
    round: &[Piece],
    border: &Border,
    level: &Level<F>,
) -> Vec<Piece> {
    let off = |phi: &Vector2<f64>| phi.x - phi.y;
    let mut first: Option<(usize, usize, Vector2<f64>)> = None;
    for (number, piece) in round.iter().enumerate() {
        for (at, [a, b]) in piece.points.array_windows().enumerate() {
            if (off(a) >= 0.0) == (off(b) >= 0.0) || a.sum() + b.sum() < 1e-6 {
                continue;
            }
            let middle = 0.5 * (a + (b - a) * (off(a) / (off(a) - off(b)))).sum();
            let step = (b - a).norm();
            let diagonal = |angle: f64| Vector2::repeat(angle);
            let met = if piece.kind == ArcKind::Singular {
                level.between(&diagonal(middle - step), &diagonal(middle + step))
            } else {
                border
                    .on_diagonal()
                    .filter(|phi| (phi - diagonal(middle)).norm() < step)
            };
            if let Some(met) = met
                && first.is_none_or(|(.., other)| met.sum() < other.sum())
            {
                first = Some((number, at, met));
            }
        }
    }
    let Some((number, at, met)) = first else {
        return round.to_vec();
    };
    let mut pieces = round.to_vec();
    pieces.rotate_left(number);
    let Some(cut) = pieces.first().cloned() else {
        return pieces;
    };
    let (before, after) = cut.points.split_at(at + 1);
    let (mut tail, mut head) = (before.to_vec(), after.to_vec());
    close_up(&mut tail, met, CROWDED);
    head.reverse();
    close_up(&mut head, met, CROWDED);
    head.reverse();
    if let Some(first) = pieces.first_mut() {
        first.points = head;
    }
    pieces.push(Piece {
        kind: cut.kind,
        points: tail,
    });
    // Cut at a corner, one of both parts is nothing.
    pieces.retain(|piece| {
        let mut sides = piece.points.array_windows();
        sides.any(|[a, b]| (b - a).norm() > 1e-9)
    });
    pieces
}

/// The pieces' points at constant power; none where they make no gait.
fn sampled(pieces: &[Piece], model: &Model<f64>) -> Option<Samples> {
    let mut samples = Samples::default();
    for piece in pieces {
        let from = samples.phi.len().saturating_sub(1);
        let new = piece.points.iter().skip(usize::from(from > 0));
        samples.phi.extend(new.copied());
        let to = samples.phi.len() - 1;
        samples.arcs.push((piece.kind, from, to));
        samples.corners.push(from);
    }
    // Exactly closed.
    *samples.phi.last_mut()? = *samples.phi.first()?;
    if begins_smoothly(&samples.phi) {
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

/// Whether the last side of a closed curve goes on into the first: it bends there no more than the neighbours' bends explain.
fn begins_smoothly(phi: &[Vector2<f64>]) -> bool {
    let count = phi.len();
    let side = |i: usize| match (phi.get(i), phi.get(i + 1)) {
        (Some(a), Some(b)) => b - a,
        _ => Vector2::zeros(),
    };
    if count < 8 {
        return false;
    }
    let turn = |before: Vector2<f64>, after: Vector2<f64>| {
        before.perp(&after).atan2(before.dot(&after)).abs()
    };
    let bend = |before: Vector2<f64>, after: Vector2<f64>| {
        turn(before, after) / (before.norm() + after.norm())
    };
    let (last, first) = (side(count - 2), side(0));
    let beside = bend(side(count - 3), last).max(bend(first, side(1)));
    turn(last, first) < 0.1 && bend(last, first) < 3.0 * beside + SHARP
}

/// A curve that bends this much more than beside has a corner \[1/rad\].
const SHARP: f64 = 0.05;

/// ∫√(Φ′ᵀWΦ′) up to each knot.
fn power_lengths(gait: &AnyGait, u: &[f64], model: &Model<f64>) -> Vec<f64> {
    let (nodes, weights) = gauss(4);
    let (mut length, mut lengths) = (0.0, vec![0.0]);
    for [a, b] in u.array_windows() {
        for (s, w) in nodes.iter().zip(&weights) {
            let point = gait.at(a + 0.5 * (s + 1.0) * (b - a));
            let power = point
                .rate
                .dot(&(model.power_matrix(&point.phi) * point.rate));
            length += 0.5 * (b - a) * w * power.max(0.0).sqrt();
        }
        lengths.push(length);
    }
    lengths
}

/// A loop round a region, not yet certified; none where the pieces make no gait.
fn gait(
    of: (Objective, &Swimmer<f64>, &Bounds),
    pieces: &[Piece],
    model: &Model<f64>,
) -> Option<OptimalGait> {
    let cycle = sampled(pieces, model)?.closed();
    let stroke = cycle.swum(model)?;
    Some(OptimalGait::of_cycle(of, false, cycle, &stroke))
}
