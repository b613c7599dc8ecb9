//! Uncertainty of the conditions of a certificate due to rounding and spacing of the samples.
//!
//! A violation is decided only if neither can explain it. The effect of rounding is measured by perturbing the samples within their
//! last digit. The effect of the spacing is measured with every second sample: a property of the curve hardly changes.

use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use swimmer_files::{AnyGait, GaitFile};
use swimmer_model::Gait as _;

use super::grid::knot;
use crate::certificate::{Certificate, Check, Condition, Dependence};

/// Number of digits above which a number counts as not rounded.
const MOST_DIGITS: i32 = 13;
/// Number of perturbations of the samples.
const TRIALS: u64 = 4;
/// Factor on the measured differences, since the samples are already rounded before they are perturbed.
const MARGIN: f64 = 4.0;

/// Largest interpolation error for which a violation is decided \[rad\].
pub(super) const MOST_MISSED: f64 = 1e-3;
/// Relative error of derivatives above which nothing is decided.
const UNKNOWN: f64 = 0.05;
/// Number of samples below which zigzags may be an effect of their placement.
const ENOUGH: usize = 400;
/// Rounding errors of the numbers in a gait file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rounding {
    /// Rounding error of joint angles \[rad\]; 0 for full precision.
    pub(super) phi: f64,
    u: f64,
}

impl Rounding {
    /// Determines the rounding errors from the number of digits in the file.
    pub(super) fn of(gait: &GaitFile) -> Self {
        let phi = half_a_digit(gait.phi.iter().flat_map(|phi| [phi.x, phi.y]));
        // Uniform values of u often have few digits but are exact, so they count as rounded only if the angles are rounded too.
        let u = if phi > 0.0 {
            half_a_digit(gait.u.iter().copied())
        } else {
            0.0
        };
        Self { phi, u }
    }

    /// Perturbs the numbers of a gait within their rounding errors.
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

/// Half a unit of the last digit of the largest number; 0 if any number has full precision.
fn half_a_digit(numbers: impl Iterator<Item = f64>) -> f64 {
    let (mut digits, mut largest) = (0, 0.0_f64);
    for number in numbers {
        let shortest = format!("{:e}", number.abs());
        let mantissa = shortest.split('e').next().unwrap_or_default();
        let count = mantissa.chars().filter(char::is_ascii_digit).count();
        digits = digits.max(i32::try_from(count).unwrap_or(i32::MAX));
        // For a gait in full precision this returns at one of the first samples.
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

/// Estimate of the interpolation error between samples \[rad\]: one eighth of the error with every second sample, since the error of
/// cubic pieces falls to a sixteenth at half the spacing.
pub(super) fn missed_between(gait: &GaitFile) -> f64 {
    let fewer = every_second(gait, 0);
    let Ok(curve) = AnyGait::from_file(&fewer) else {
        return 0.0;
    };
    let missed = gait.u.iter().zip(&gait.phi);
    let missed = missed.map(|(&u, phi)| (curve.at(u).phi - phi).norm());
    (0.125 * missed.fold(0.0, f64::max)).min(MOST_MISSED)
}

/// Keeps every second sample between the ends of arcs and corners, starting with the first or the second.
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

/// Returns `true` if at least half of the samples zigzag, which a coarsely sampled smooth gait does not.
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

/// Adds the uncertainty due to the samples to each violated condition. The callback computes the certificate for other samples of
/// the same gait.
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
        // A condition that other samples do not have is undecided.
        value.map_or(f64::INFINITY, |value| (value - check.value).abs())
    };
    let value = |condition| certificate.value(condition).unwrap_or(0.0);
    let (slope, pose) = (value(Condition::SlopesKnown), value(Condition::PosesKnown));
    let coarse = certificate.is_too_coarse();
    certificate.with_uncertainty(|check| {
        if check.depends_on == Dependence::Spacing {
            return f64::INFINITY;
        }
        let rounded = moved.iter().map(|other| changed(check, other));
        let rounded = MARGIN * rounded.fold(0.0, f64::max);
        if check.depends_on == Dependence::Samples {
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
