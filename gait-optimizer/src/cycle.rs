//! From a quarter gait to the full cycle: traced again at constant power with its costates, then mirrored twice.
//!
//! A gait with the paper's two symmetries is mapped onto itself, run backwards, by reflection in φ₁ = φ₂ and in φ₁ = −φ₂.

mod trace;

use nalgebra::Vector2;
use swimmer_files::{AnyGait, GaitArc};
use swimmer_model::{InvalidSamples, Model, Stroke, Tolerance, crossing_share, swim};

pub(crate) use trace::QuarterTrace;

/// A full cycle, sampled.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cycle {
    /// Fractions of the period, 0 to 1, proportional to ∫√P.
    pub(crate) u: Vec<f64>,
    pub(crate) phi: Vec<Vector2<f64>>,
    /// Some of the `u` below 1.
    pub(crate) corners: Vec<f64>,
    pub(crate) arcs: Vec<GaitArc>,
}

/// Directions this close in angle \[rad\] make no corner.
const SMOOTH: f64 = 1e-7;

impl Cycle {
    /// The same cycle run backwards, each shape as `image` maps it.
    pub(crate) fn reversed(&self, image: impl Fn(&Vector2<f64>) -> Vector2<f64>) -> Self {
        let back = |u: f64| if u > 0.0 { 1.0 - u } else { 0.0 };
        let mut corners: Vec<f64> = self.corners.iter().map(|&corner| back(corner)).collect();
        corners.sort_by(f64::total_cmp);
        let arcs = self.arcs.iter().rev().map(|arc| GaitArc {
            kind: arc.kind,
            from: 1.0 - arc.to,
            to: 1.0 - arc.from,
        });
        Self {
            u: self.u.iter().rev().map(|u| 1.0 - u).collect(),
            phi: self.phi.iter().rev().map(image).collect(),
            corners,
            arcs: arcs.collect(),
        }
    }

    pub(crate) fn of_quarter(trace: &QuarterTrace) -> Self {
        let count = trace.phi.len();
        let total = trace.power_length.last().copied().unwrap_or(1.0);
        let fraction = |i: usize| {
            trace
                .power_length
                .get(i)
                .map_or(0.25, |length| 0.25 * length / total)
        };
        let (mut u, mut phi) = (Vec::with_capacity(4 * count), Vec::with_capacity(4 * count));
        for half in 0..2u32 {
            let (before, sign) = (0.5 * f64::from(half), if half == 0 { 1.0 } else { -1.0 });
            for (i, shape) in trace.phi.iter().enumerate().take(count - 1) {
                u.push(before + fraction(i));
                phi.push(shape * sign);
            }
            for (i, shape) in trace.phi.iter().enumerate().skip(1).rev() {
                u.push(before + 0.5 - fraction(i));
                phi.push(Vector2::new(-shape.y, -shape.x) * sign);
            }
        }
        u.push(1.0);
        phi.extend(phi.first().copied());
        Self {
            corners: corners(trace, &fraction),
            arcs: arcs(trace, &fraction),
            u,
            phi,
        }
    }

    pub(crate) fn gait(&self) -> Result<AnyGait, InvalidSamples> {
        let corners: Vec<usize> = self
            .corners
            .iter()
            .filter_map(|corner| self.u.iter().position(|u| u.to_bits() == corner.to_bits()))
            .collect();
        AnyGait::from_samples(&self.u, &self.phi, &corners)
    }

    /// One cycle swum by the model, which shares no code with the arcs; none where the samples make no gait.
    pub(crate) fn swum(&self, model: &Model<f64>) -> Option<Stroke<f64>> {
        let gait = self.gait().ok()?;
        Some(swim(model, &gait, &Tolerance::new(1e-12)))
    }

    /// Share of the cycle in which links cross; NaN where the samples make no gait.
    pub(crate) fn links_cross(&self, model: &Model<f64>) -> f64 {
        self.gait().map_or(f64::NAN, |gait| {
            crossing_share(&model.swimmer().links, &gait).of_cycle
        })
    }
}

/// Corners of the whole cycle, in order: those of the quarter and their images, and the two symmetry lines where the curve
/// does not cross them at a right angle.
fn corners(trace: &QuarterTrace, fraction: &impl Fn(usize) -> f64) -> Vec<f64> {
    let inner: Vec<f64> = trace.corners.iter().map(|&i| fraction(i)).collect();
    // Square to φ₁ = φ₂ (φ₁ = −φ₂) is a direction without a part along it.
    let starts_square = (trace.first_direction.x + trace.first_direction.y).abs() < SMOOTH;
    let ends_square = (trace.last_direction.x - trace.last_direction.y).abs() < SMOOTH;
    let mut corners = Vec::new();
    for half in [0.0, 0.5] {
        corners.extend((!starts_square).then_some(half));
        corners.extend(inner.iter().map(|u| half + u));
        corners.extend((!ends_square).then_some(half + 0.25));
        corners.extend(inner.iter().rev().map(|u| half + 0.5 - u));
    }
    corners
}

/// Arcs of the whole cycle; an arc that crosses a symmetry line smoothly is one with its image.
fn arcs(trace: &QuarterTrace, fraction: &impl Fn(usize) -> f64) -> Vec<GaitArc> {
    let quarter = trace.kinds.iter().map(|&(kind, from, to)| GaitArc {
        kind,
        from: fraction(from),
        to: fraction(to),
    });
    let ends_square = (trace.last_direction.x - trace.last_direction.y).abs() < SMOOTH;
    let mut half: Vec<GaitArc> = quarter.clone().collect();
    for arc in quarter.rev() {
        let image = GaitArc {
            kind: arc.kind,
            from: 0.5 - arc.to,
            to: 0.5 - arc.from,
        };
        match half.last_mut() {
            Some(last)
                if last.kind == image.kind
                    && ends_square
                    && last.to >= 0.25
                    && image.from <= 0.25 =>
            {
                last.to = image.to;
            }
            _ => half.push(image),
        }
    }
    let starts_square = (trace.first_direction.x + trace.first_direction.y).abs() < SMOOTH;
    let mut cycle = half.clone();
    for arc in half {
        let image = GaitArc {
            kind: arc.kind,
            from: arc.from + 0.5,
            to: arc.to + 0.5,
        };
        match cycle.last_mut() {
            Some(last)
                if last.kind == image.kind
                    && starts_square
                    && last.to >= 0.5
                    && image.from <= 0.5 =>
            {
                last.to = image.to;
            }
            _ => cycle.push(image),
        }
    }
    cycle
}
