//! Gait files with fewer digits, or changed by what no rounding does.

use nalgebra::Vector2;
use rand::{Rng, RngExt};
use swimmer_files::{GaitArc, GaitFile};

/// Rounds every number to this number of digits after the point.
pub(crate) fn rounded(file: &GaitFile, digits: i32) -> GaitFile {
    let scale = 10.0_f64.powi(digits);
    let round = |value: f64| (value * scale).round() / scale;
    GaitFile {
        u: file.u.iter().map(|&u| round(u)).collect(),
        phi: file.phi.iter().map(|phi| phi.map(round)).collect(),
        corners: file.corners.iter().map(|&u| round(u)).collect(),
        arcs: file
            .arcs
            .iter()
            .map(|arc| GaitArc {
                from: round(arc.from),
                to: round(arc.to),
                ..*arc
            })
            .collect(),
        ..file.clone()
    }
}

/// Perturbation of a gait: size, centre and width as a fraction of the cycle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Change {
    size: f64,
    centre: f64,
    width: f64,
}

impl Change {
    pub(crate) const KINDS: usize = 4;

    pub(crate) fn drawn(rng: &mut impl Rng) -> Self {
        Self {
            size: 10.0_f64.powf(rng.random_range(-4.0..-2.0)),
            centre: rng.random_range(0.0..1.0),
            width: rng.random_range(0.01..0.1),
        }
    }

    /// With a bump, a smooth wave, another size, or noise at every sample.
    pub(crate) fn of(&self, file: &GaitFile, kind: usize, rng: &mut impl Rng) -> GaitFile {
        let mut changed = file.clone();
        let last = changed.u.len() - 1;
        for at in 0..=last {
            let (before, after) = (at.checked_sub(1).unwrap_or(last - 1), (at % last) + 1);
            let along = file.phi[after] - file.phi[before];
            let across = Vector2::new(-along.y, along.x).normalize();
            let away = (file.u[at] - self.centre + 0.5).rem_euclid(1.0) - 0.5;
            changed.phi[at] += match kind {
                0 => across * (-(away / self.width).powi(2)).exp(),
                1 => across * (0.5 + 0.5 * (std::f64::consts::TAU * away).sin()),
                2 => -file.phi[at],
                _ => across * rng.random_range(0.0..1.0),
            } * self.size;
        }
        changed.phi[last] = changed.phi[0];
        changed
    }
}
