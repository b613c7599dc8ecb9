//! Profile likelihoods of r_s and χ, the intervals at which they fall below Student's threshold, and the ridge between both.

use std::f64::consts::TAU;

use super::surface::Surface;
use super::{Contour, Profile, Ridge};
use crate::fit::likelihood::Estimate;
use crate::fit::run_values::RunValues;
use crate::least_squares::{Model as _, minimise};
use crate::student;

/// Points of a profile.
const POINTS: usize = 61;
/// Points along each axis of the ridge's grid.
const GRID: usize = 41;
/// Corners of a contour.
const CORNERS: usize = 96;
/// Halvings of a search for a threshold: to 1e-9 of the stretch.
const HALVINGS: usize = 30;
/// Levels of the ridge's contours.
const LEVELS: [f64; 2] = [0.68, 0.95];

/// A point of the surface in natural units.
pub(super) struct Scale {
    /// L \[m\].
    pub(super) length: f64,
}

impl Scale {
    /// r_s \[m\] or χ.
    pub(super) fn natural(&self, parameter: usize, value: f64) -> f64 {
        if parameter == 0 {
            value * self.length
        } else {
            value.exp()
        }
    }
}

/// By how much the log-likelihood falls where one parameter is held fast and the other is free.
fn fall(
    surface: &Surface,
    data: &RunValues,
    estimate: &Estimate,
    parameter: usize,
    value: f64,
) -> f64 {
    let mut start = estimate.at.clone();
    // Along the ridge: where the other parameter goes to first order.
    let covariance = estimate.components.covariance();
    let other = 1 - parameter;
    let slope = covariance[(0, 1)] / covariance[(parameter, parameter)];
    start[other] += slope * (value - start[parameter]);
    start[parameter] = value;
    let mut bounds = surface.bounds();
    bounds[parameter] = (value, value);
    minimise(surface, &data.values, &estimate.weights, &start, &bounds)
        .map_or(f64::NEG_INFINITY, |end| {
            ((estimate.cost - end.cost) / 2.0).min(0.0)
        })
}

/// The profile of one parameter with its interval.
pub(super) fn profile(
    surface: &Surface,
    data: &RunValues,
    estimate: &Estimate,
    scale: &Scale,
    parameter: usize,
    level: f64,
) -> Option<Profile> {
    let variance = estimate.components.of_parameter(parameter);
    let quantile = student::quantile(variance.freedom, level)?;
    let threshold = -quantile * quantile / 2.0;
    let centre = estimate.at[parameter];
    let (low, high) = (
        surface.rectangle.low[parameter],
        surface.rectangle.high[parameter],
    );
    let down = |value: f64| fall(surface, data, estimate, parameter, value);
    let end = |limit: f64| {
        if down(limit) >= threshold {
            return (limit, true);
        }
        let (mut inside, mut outside) = (centre, limit);
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(inside, outside);
            if down(middle) >= threshold {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        (f64::midpoint(inside, outside), false)
    };
    let ((from, below), (to, above)) = (end(low), end(high));
    let reach = |end: f64, limit: f64| {
        let wide = centre + 1.6 * (end - centre);
        if limit < centre {
            wide.max(limit)
        } else {
            wide.min(limit)
        }
    };
    let (first, last) = (reach(from, low), reach(to, high));
    let points = (0..POINTS).map(|i| {
        let value = first + (last - first) * i as f64 / (POINTS - 1) as f64;
        (scale.natural(parameter, value), down(value))
    });
    Some(Profile {
        points: points.collect(),
        threshold,
        interval: [scale.natural(parameter, from), scale.natural(parameter, to)],
        // The border r_s = 0 is an end like any other.
        open: [below && !(parameter == 0 && low <= 0.0), above],
        freedom: variance.freedom,
    })
}

/// The log-likelihood over both parameters.
pub(super) fn ridge(
    surface: &Surface,
    data: &RunValues,
    estimate: &Estimate,
    scale: &Scale,
) -> Option<Ridge> {
    let covariance = estimate.components.covariance();
    let freedom = estimate
        .components
        .of_parameter(0)
        .freedom
        .min(estimate.components.of_parameter(1).freedom);
    let threshold = |level: f64| -student::fisher_of_two(freedom, level);
    let outer = LEVELS.iter().copied().fold(0.0, f64::max);
    let root = covariance.clone().cholesky()?.l();
    let ray = |angle: f64, length: f64| {
        let (sin, cos) = angle.sin_cos();
        [
            estimate.at[0] + length * root[(0, 0)] * cos,
            estimate.at[1] + length * (root[(1, 0)] * cos + root[(1, 1)] * sin),
        ]
    };
    let contour = |level: f64| {
        let threshold = threshold(level);
        let corner = |i: usize| {
            let angle = TAU * i as f64 / CORNERS as f64;
            let (mut inside, mut outside) = (0.0, 4.0 * (-2.0 * threshold).sqrt());
            for _ in 0..HALVINGS {
                let middle = f64::midpoint(inside, outside);
                let at = ray(angle, middle);
                let within = surface.rectangle.contains(at);
                if within && estimate.log_ratio(surface, data, &at) >= threshold {
                    inside = middle;
                } else {
                    outside = middle;
                }
            }
            let at = ray(angle, inside);
            (scale.natural(0, at[0]), scale.natural(1, at[1]))
        };
        Contour {
            level,
            threshold,
            corners: (0..CORNERS).map(corner).collect(),
        }
    };
    let contours = LEVELS.iter().map(|level| contour(*level)).collect();
    let wide = 1.3 * (-2.0 * threshold(outer)).sqrt();
    let axis = |parameter: usize| -> Vec<f64> {
        let half = wide * covariance[(parameter, parameter)].sqrt();
        let centre = estimate.at[parameter];
        let low = (centre - half).max(surface.rectangle.low[parameter]);
        let high = (centre + half).min(surface.rectangle.high[parameter]);
        let place = |i: usize| low + (high - low) * i as f64 / (GRID - 1) as f64;
        (0..GRID).map(place).collect()
    };
    let axes = [axis(0), axis(1)];
    let row = |chi: &f64| {
        let ratio = |radius: &f64| estimate.log_ratio(surface, data, &[*radius, *chi]);
        axes[0].iter().map(ratio).collect()
    };
    let log_ratio = axes[1].iter().map(row).collect();
    let natural = |parameter: usize| {
        let values = axes[parameter].iter();
        values.map(|v| scale.natural(parameter, *v)).collect()
    };
    Some(Ridge {
        sphere_radius: natural(0),
        chi: natural(1),
        log_ratio,
        contours,
    })
}
