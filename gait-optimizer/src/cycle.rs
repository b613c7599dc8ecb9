//! A full cycle at constant power, sampled: of a closed curve, or of a quarter mirrored twice.
//!
//! A gait with the paper's two symmetries is mapped onto itself, run backwards, by reflection in φ₁ = φ₂ and in φ₁ = −φ₂.

use nalgebra::Vector2;
use swimmer_files::{AnyGait, ArcKind, Bounds, GaitArc, GaitFile};
use swimmer_model::{InvalidSamples, Model, Stroke, Tolerance, crossing_share, swim};

/// One arc of a gait.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Arc {
    /// Kind of arc.
    pub kind: ArcKind,
    /// Joint angles where it starts \[rad\].
    pub from: [f64; 2],
    /// Joint angles where it ends \[rad\].
    pub to: [f64; 2],
}

/// The power at a shape whose joints turn at a rate.
pub(crate) fn power(model: &Model<f64>, phi: &Vector2<f64>, rate: &Vector2<f64>) -> f64 {
    rate.dot(&(model.power_matrix(phi) * rate))
}

/// A full cycle, sampled.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Cycle {
    /// Fractions of the period, 0 to 1, proportional to ∫√P.
    pub(crate) u: Vec<f64>,
    pub(crate) phi: Vec<Vector2<f64>>,
    /// Some of the `u` below 1.
    pub(crate) corners: Vec<f64>,
    pub(crate) arcs: Vec<GaitArc>,
}

/// Arcs one after the other, sampled.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Samples {
    pub(crate) phi: Vec<Vector2<f64>>,
    /// ∫√P up to each sample.
    pub(crate) along: Vec<f64>,
    /// Samples where the direction jumps, or its rate does.
    pub(crate) corners: Vec<usize>,
    /// Arcs with their first and last sample.
    pub(crate) arcs: Vec<(ArcKind, usize, usize)>,
}

impl Cycle {
    /// The same cycle run backwards, each shape as `image` maps it.
    pub(crate) fn reversed(&self, image: impl Fn(&Vector2<f64>) -> Vector2<f64>) -> Self {
        let back = self.file(Bounds::default()).reversed();
        Self {
            u: back.u,
            phi: back.phi.iter().map(image).collect(),
            corners: back.corners,
            arcs: back.arcs,
        }
    }

    /// The shapes of the first quarter, its end among them.
    pub(crate) fn quarter(&self) -> &[Vector2<f64>] {
        let end = self.u.partition_point(|&u| u < 0.25 - 1e-12);
        self.phi.get(..=end).unwrap_or(&self.phi)
    }

    /// The cycle of servos that turn by `gain` times the commanded angle.
    pub(crate) fn turned(&self, gain: f64) -> Self {
        Self {
            phi: self.phi.iter().map(|phi| phi * gain).collect(),
            ..self.clone()
        }
    }

    /// Gait file without objective and swimmer.
    pub(crate) fn file(&self, bounds: Bounds) -> GaitFile {
        GaitFile {
            bounds,
            arcs: self.arcs.clone(),
            corners: self.corners.clone(),
            u: self.u.clone(),
            phi: self.phi.clone(),
            ..GaitFile::default()
        }
    }

    /// Arcs with their joint angles; for a symmetric cycle, those of the first quarter only.
    pub(crate) fn arcs(&self, symmetric: bool) -> Vec<Arc> {
        let until = if symmetric { 0.25 } else { 1.0 };
        let at = |u: f64, close: f64| {
            let index = self.u.partition_point(|&place| place < u - close);
            let phi = self.phi.get(index);
            phi.map_or([f64::NAN; 2], |phi| [phi.x, phi.y])
        };
        let arcs = self.arcs.iter().filter(|arc| arc.from < until - 1e-9);
        arcs.map(|arc| Arc {
            kind: arc.kind,
            from: at(arc.from, 1e-12),
            to: if arc.to > until + 1e-9 {
                at(until, 1e-9)
            } else {
                at(arc.to, 1e-12)
            },
        })
        .collect()
    }

    pub(crate) fn gait(&self) -> Result<AnyGait, InvalidSamples> {
        AnyGait::from_file(&self.file(Bounds::default()))
    }

    /// Stroke of one cycle, integrated by the model, which shares no code with the arcs. Returns `None` if the samples make no
    /// gait.
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

impl Samples {
    /// Share of the whole at a sample, 0 to 1.
    fn place(&self, sample: usize) -> f64 {
        let whole = self.along.last().copied().unwrap_or(1.0);
        self.along.get(sample).map_or(1.0, |along| along / whole)
    }

    /// The cycle of a closed curve.
    pub(crate) fn closed(&self) -> Cycle {
        let mut phi = self.phi.clone();
        // The last sample repeats the first to the last bit.
        if let (Some(first), Some(last)) = (phi.first().copied(), phi.last_mut()) {
            *last = first;
        }
        let arcs = self.arcs.iter().map(|&(kind, from, to)| GaitArc {
            kind,
            from: self.place(from),
            to: self.place(to),
        });
        Cycle {
            u: (0..phi.len()).map(|i| self.place(i)).collect(),
            phi,
            corners: self.corners.iter().map(|&i| self.place(i)).collect(),
            arcs: arcs.collect(),
        }
    }

    /// The cycle of a quarter from φ₁ = φ₂ to φ₁ = −φ₂, with its images: run backwards and reflected in φ₁ = −φ₂, then both turned
    /// by half a turn. Where it begins or ends `square` to its symmetry line, it meets its images smoothly.
    pub(crate) fn unfolded(&self, [starts_square, ends_square]: [bool; 2]) -> Cycle {
        let half = self.mirrored(|phi| Vector2::new(-phi.y, -phi.x), ends_square);
        let mut whole = half.mirrored(|phi| Vector2::new(phi.y, phi.x), starts_square);
        if !starts_square {
            whole.corners.insert(0, 0);
        }
        whole.closed()
    }

    /// With its image run backwards behind it, which it meets smoothly or in a corner.
    fn mirrored(&self, image: impl Fn(&Vector2<f64>) -> Vector2<f64>, smoothly: bool) -> Self {
        let last = self.phi.len().saturating_sub(1);
        let whole = self.along.last().copied().unwrap_or_default();
        let back = |sample: &usize| 2 * last - sample;
        let mut both = self.clone();
        both.corners.retain(|&sample| sample > 0);
        both.phi.extend(self.phi.iter().rev().skip(1).map(image));
        let along = self.along.iter().rev().skip(1);
        both.along.extend(along.map(|along| 2.0 * whole - along));
        let images: Vec<usize> = both.corners.iter().rev().map(back).collect();
        both.corners.extend((!smoothly).then_some(last));
        both.corners.extend(images);
        let images = self.arcs.iter().rev();
        let mut images = images.map(|(kind, from, to)| (*kind, back(to), back(from)));
        // An arc that crosses a symmetry line smoothly is one with its image.
        if smoothly && let Some((arc, (_, _, to))) = both.arcs.last_mut().zip(images.next()) {
            arc.2 = to;
        }
        both.arcs.extend(images);
        both
    }
}
