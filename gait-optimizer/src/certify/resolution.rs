//! What its samples leave open in each number of a certificate: they are rounded, and there are only so many of them.
//!
//! A condition that does not hold is decided only where neither may be the reason. What rounding may do is tried: the samples
//! are moved by as much as their last digit leaves open, and each number changes by so much. What the spacing may do is told by
//! every second sample: a number that the curve has, not its samples, hardly changes.

use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_files::{AnyGait, GaitFile};
use swimmer_model::Gait as _;

use super::grid::knot;
use crate::certificate::{Certificate, Check, Condition, SeenBy};

/// Numbers with more digits than these were not rounded by a writer.
const MOST_DIGITS: i32 = 13;
/// Times that the samples are moved.
const TRIALS: u64 = 4;
/// What is rounded already is about as far off as what is moved once more, so that differences tell only part of it.
const MARGIN: f64 = 4.0;

/// A curve that may be further off between its samples is not told to be so \[rad\].
pub(super) const MOST_MISSED: f64 = 1e-3;
/// Slopes that are known no better than this, as a share, decide nothing.
const UNKNOWN: f64 = 0.05;
/// Fewer samples may zigzag by where they stand.
const ENOUGH: usize = 400;
/// How far the written numbers may be from those that were meant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rounding {
    /// Of joint angles \[rad\]; 0 for numbers in full.
    pub(super) phi: f64,
    u: f64,
}

impl Rounding {
    /// By the digits that the file's numbers have.
    pub(super) fn of(gait: &GaitFile) -> Self {
        let phi = half_a_digit(gait.phi.iter().flat_map(|phi| [phi.x, phi.y]));
        // Evenly spaced u often have few digits, and are none the less exact: only beside rounded angles are they doubted.
        let u = if phi > 0.0 {
            half_a_digit(gait.u.iter().copied())
        } else {
            0.0
        };
        Self { phi, u }
    }

    /// The gait with its numbers moved within what is open.
    fn moved(self, gait: &GaitFile, seed: u64) -> GaitFile {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut by = |most: f64| {
            if most > 0.0 {
                rng.random_range(-most..=most)
            } else {
                0.0
            }
        };
        let last = gait.u.len().saturating_sub(1);
        let gaps = gait.u.windows(2).map(|pair| pair[1] - pair[0]);
        let most = self.u.min(0.3 * gaps.fold(1.0, f64::min));
        let inner = |at: usize| at > 0 && at < last;
        let u: Vec<f64> = gait
            .u
            .iter()
            .enumerate()
            .map(|(at, &u)| if inner(at) { u + by(most) } else { u })
            .collect();
        let mut phi: Vec<Vector2<f64>> = gait
            .phi
            .iter()
            .map(|phi| phi + Vector2::new(by(self.phi), by(self.phi)))
            .collect();
        let first = phi.first().copied();
        if let (Some(first), Some(last)) = (first, phi.last_mut()) {
            *last = first;
        }
        let place = |old: f64| knot(gait, old).map_or(old, |at| u[at]);
        let mut moved = gait.clone();
        for arc in &mut moved.arcs {
            (arc.from, arc.to) = (place(arc.from), place(arc.to));
        }
        moved.corners = gait.corners.iter().map(|&u| place(u)).collect();
        (moved.u, moved.phi) = (u, phi);
        moved
    }
}

/// Half of the last digit of the largest number; 0 where some number is written in full.
fn half_a_digit(numbers: impl Iterator<Item = f64>) -> f64 {
    let (mut digits, mut largest) = (0, 0.0_f64);
    for number in numbers {
        let shortest = format!("{:e}", number.abs());
        let mantissa = shortest.split('e').next().unwrap_or_default();
        let count = mantissa.chars().filter(char::is_ascii_digit).count();
        digits = digits.max(i32::try_from(count).unwrap_or(i32::MAX));
        // Of a gait in full this is one of the first samples.
        if digits > MOST_DIGITS {
            return 0.0;
        }
        largest = largest.max(number.abs());
    }
    if largest == 0.0 {
        return 0.0;
    }
    #[allow(clippy::cast_possible_truncation)] // the exponent of a number
    let exponent = largest.log10().floor() as i32;
    0.5 * 10.0_f64.powi(exponent + 1 - digits)
}

/// How far the curve between its samples may be from the gait that was meant \[rad\]: what every second sample misses of the
/// others, an eighth of it, for cubic pieces miss a sixteenth at half the spacing.
pub(super) fn missed_between(gait: &GaitFile) -> f64 {
    let fewer = every_second(gait, 0);
    let Ok(curve) = AnyGait::from_file(&fewer) else {
        return 0.0;
    };
    let missed = gait.u.iter().zip(&gait.phi);
    let missed = missed.map(|(&u, phi)| (curve.at(u).phi - phi).norm());
    (0.125 * missed.fold(0.0, f64::max)).min(MOST_MISSED)
}

/// Every second sample between the ends of arcs and corners, counted from the first or from the second.
fn every_second(gait: &GaitFile, from: usize) -> GaitFile {
    let fixed = |u: f64| {
        let ends = gait.arcs.iter().flat_map(|arc| [arc.from, arc.to]);
        ends.chain(gait.corners.iter().copied())
            .chain([0.0, 0.25, 0.5, 0.75, 1.0])
            .any(|end| (end - u).abs() <= 1e-12)
    };
    let kept = |at: &usize| at % 2 == from || gait.u.get(*at).is_some_and(|&u| fixed(u));
    let kept: Vec<usize> = (0..gait.u.len()).filter(kept).collect();
    GaitFile {
        u: kept
            .iter()
            .filter_map(|&at| gait.u.get(at).copied())
            .collect(),
        phi: kept
            .iter()
            .filter_map(|&at| gait.phi.get(at).copied())
            .collect(),
        ..gait.clone()
    }
}

/// Whether the samples zigzag, half of them at least: a gait that does so at full precision is no smooth one seen coarsely.
fn zigzags(gait: &GaitFile) -> bool {
    let bends = gait.phi.windows(3).map(|three| {
        let (into, out) = (three[1] - three[0], three[2] - three[1]);
        into.perp(&out).atan2(into.dot(&out))
    });
    let bends: Vec<f64> = bends.collect();
    let changes = bends.windows(2).map(|pair| pair[1] - pair[0]);
    let changes: Vec<f64> = changes.filter(|change| change.abs() > 1e-6).collect();
    let turns = changes.windows(2).filter(|pair| pair[0] * pair[1] < 0.0);
    changes.len() > ENOUGH && 2 * turns.count() > changes.len()
}

/// The certificate, each failed condition with what the samples leave open in its number; `asked` works out the certificate of
/// other samples of the same gait.
pub(super) fn with_uncertainty(
    certificate: Certificate,
    gait: &GaitFile,
    efficiency: bool,
    asked: impl Fn(&GaitFile) -> Option<Certificate>,
) -> Certificate {
    if certificate.pass() {
        return certificate;
    }
    let rounding = Rounding::of(gait);
    if rounding.phi == 0.0 && zigzags(gait) {
        return certificate.with_uncertainty(|_| 0.0);
    }
    let trials = if rounding.phi > 0.0 { TRIALS } else { 0 };
    let moved: Vec<_> = (0..trials)
        .map(|seed| asked(&rounding.moved(gait, seed)))
        .collect();
    let fewer = [0, 1].map(|from| asked(&every_second(gait, from)));
    let changed = |check: &Check, other: &Option<Certificate>| {
        let value = other
            .as_ref()
            .and_then(|other| other.value(check.condition));
        // A condition that other samples do not even pose is open.
        value.map_or(f64::INFINITY, |value| (value - check.value).abs())
    };
    let value = |condition| certificate.value(condition).unwrap_or(0.0);
    let (slope, pose) = (value(Condition::SlopesKnown), value(Condition::PosesKnown));
    let coarse = certificate.is_too_coarse();
    certificate.with_uncertainty(|check| {
        if check.seen_by == SeenBy::Spacing {
            return f64::INFINITY;
        }
        let rounded = moved.iter().map(|other| changed(check, other));
        let rounded = MARGIN * rounded.fold(0.0, f64::max);
        if check.seen_by == SeenBy::Samples {
            return rounded;
        }
        let spaced = fewer.iter().map(|other| changed(check, other));
        if !coarse {
            return rounded.max(spaced.fold(f64::INFINITY, f64::min));
        }
        if slope > UNKNOWN {
            return f64::INFINITY;
        }
        let spaced = spaced.fold(0.0, f64::max);
        let by_slopes = if efficiency { 1.0 } else { check.value.abs() };
        rounded.max(spaced).max(10.0 * (slope * by_slopes + pose))
    })
}
