//! Point of a branch, and the distance of two points.

use swimmer_files::{ArcKind, Objective};

use crate::atlas::distinct::{Outline, Symmetries};
use crate::extremal::Extremal;
use crate::optimal_gait::OptimalGait;

/// Largest change of a curve in one step \[rad\]; the next constant is that of the logarithm of its gain.
const MOST_MOVE: f64 = 0.15;
const MOST_CHANGE: f64 = 0.15;
/// Number of figures by which a gait is characterised.
pub(super) const FIGURES: usize = 4;

/// Gait at a value of the parameter.
#[derive(Debug, Clone)]
pub(super) struct BranchPoint {
    pub(super) value: f64,
    pub(super) gait: OptimalGait,
    /// Arcs of an efficiency gait, the initial guess of the next one.
    pub(super) extremal: Option<Extremal>,
    outline: Outline,
}

impl BranchPoint {
    pub(super) fn new(value: f64, gait: OptimalGait, extremal: Option<Extremal>) -> Self {
        Self {
            value,
            outline: Outline::new(gait.phi()),
            gait,
            extremal,
        }
    }

    pub(super) fn arcs(&self) -> Vec<ArcKind> {
        self.gait.arcs.iter().map(|arc| arc.kind).collect()
    }

    /// Returns `true` if it is an optimum, at least among gaits with its symmetries.
    pub(super) fn holds(&self) -> bool {
        self.gait.certificate.holds_among_symmetric()
    }

    /// Value of the objective.
    pub(super) fn gain(&self) -> f64 {
        match self.gait.objective {
            Objective::Efficiency => self.gait.efficiency,
            _ => self
                .gait
                .displacement_over_length
                .hypot(self.gait.lateral_over_length),
        }
    }

    /// Largest distance of the curves \[rad\].
    pub(super) fn apart(&self, other: &Self) -> f64 {
        self.outline.apart(&other.outline, Symmetries::default())
    }

    /// Distance of two gaits relative to the largest change per step.
    pub(super) fn off(&self, other: &Self) -> f64 {
        let change = (self.gain() / other.gain()).ln().abs() / MOST_CHANGE;
        let off = change.max(self.apart(other) / MOST_MOVE);
        if off.is_finite() { off } else { f64::INFINITY }
    }

    /// Figures that change smoothly with the gait.
    pub(super) fn figures(&self) -> [f64; FIGURES] {
        let gait = &self.gait;
        [
            gait.start_angle,
            gait.end_angle,
            gait.displacement_over_length
                .hypot(gait.lateral_over_length),
            gait.efficiency.ln(),
        ]
    }
}

/// Slope of the least-squares line. Returns `None` for fewer than three points.
pub(super) fn slope(points: &[[f64; 2]]) -> Option<f64> {
    let count = points.len() as f64;
    let mean = |axis: fn(&[f64; 2]) -> f64| points.iter().map(axis).sum::<f64>() / count;
    let (x, y) = (mean(|[x, _]| *x), mean(|[_, y]| *y));
    let rise: f64 = points.iter().map(|[a, b]| (a - x) * (b - y)).sum();
    let run: f64 = points.iter().map(|[a, _]| (a - x) * (a - x)).sum();
    let slope = rise / run;
    (points.len() >= 3 && slope.is_finite()).then_some(slope)
}
