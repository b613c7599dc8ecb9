//! Objective and constraints of a fastest-gait search, shared by all its steps.

use nalgebra::{DMatrix, DVector, Vector2};
use swimmer_model::Model;

use super::arc::Jet;
use super::chain::{self, Layout, Net, Weights};
use super::quadrature::Rule;
use crate::member::Member;
use crate::region::Region;

/// Quantity to maximise per unit of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Goal {
    /// Net displacement, without net rotation.
    #[default]
    Distance,
    /// Net rotation, whatever the displacement.
    Rotation,
}

/// Direction of the displacement, relative to the gait's mean heading.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum HeadingRule {
    /// Any way.
    #[default]
    Any,
    /// Along the mean heading.
    Forward,
    /// Across it.
    Sideways,
}

impl HeadingRule {
    /// Deviation from a heading, modulo half a turn, because the reversed gait leads the other way. Returns `None` for any direction.
    pub(crate) fn off(self, heading: f64) -> Option<f64> {
        use std::f64::consts::{FRAC_PI_2, PI};
        let aim = match self {
            Self::Any => return None,
            Self::Forward => 0.0,
            Self::Sideways => FRAC_PI_2,
        };
        let off = heading - aim;
        Some(off - PI * (off / PI).round())
    }
}

/// Requirements on a gait other than bounds and limits.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct GaitRequirements {
    pub(crate) heading: HeadingRule,
    /// The period, if it is prescribed.
    pub(crate) period: Option<f64>,
    pub(crate) goal: Goal,
    /// A shape that the gait must pass. Gaits join there, and the costate may jump in any direction.
    pub(crate) anchor: Option<Vector2<f64>>,
}

/// Problem data of every step of the search.
#[derive(Debug, Clone)]
pub(crate) struct Setting<'a> {
    /// Model of the swimmer with L = 1.
    pub(crate) model: &'a Model<f64>,
    pub(crate) region: &'a Region,
    /// Largest |φ̇ᵢ|.
    pub(crate) rates: [f64; 2],
    pub(crate) asked: GaitRequirements,
    /// Weighted members of an ensemble whose displacement is maximised; if empty, that of the model. Constraints on the whole
    /// chain hold for the model alone.
    pub(crate) members: &'a [(Member, f64)],
}

impl Setting<'_> {
    /// Shortest time in which the servos turn by this step.
    pub(crate) fn time(&self, way: &Vector2<f64>) -> f64 {
        (way.x.abs() / self.rates[0]).max(way.y.abs() / self.rates[1])
    }

    /// Quantity to maximise per unit of time.
    pub(crate) fn measure(&self, net: &Net) -> f64 {
        match self.asked.goal {
            Goal::Distance => net.distance(),
            Goal::Rotation => net.rotation.abs(),
        }
    }

    /// Measure below which a gait does not swim. The least measures, of gaits that turn or swim sideways, grow as the cube of small angles.
    pub(crate) fn least_measure(&self) -> f64 {
        1e-9 * self.region.scale().powi(3)
    }

    /// Returns true if the heading is prescribed.
    fn heads(&self) -> bool {
        self.asked.goal == Goal::Distance && self.asked.heading != HeadingRule::Any
    }

    /// Number of constraints on the whole chain.
    pub(crate) fn equality_count(&self) -> usize {
        usize::from(self.asked.goal == Goal::Distance)
            + usize::from(self.heads())
            + usize::from(self.asked.period.is_some())
    }

    /// Residuals of these constraints: rotation, heading and period, if required.
    pub(crate) fn residuals(&self, net: &Net, period: f64) -> Vec<f64> {
        let mut values = Vec::with_capacity(3);
        if self.asked.goal == Goal::Distance {
            values.push(net.rotation);
            values.extend(self.asked.heading.off(net.heading()));
        }
        values.extend(self.asked.period.map(|asked| period / asked - 1.0));
        values
    }

    /// Residuals of these constraints and their gradients.
    pub(crate) fn equalities(
        &self,
        layout: &Layout,
        jets: &[Jet],
        z: &DVector<f64>,
    ) -> (Net, Vec<f64>, Vec<DVector<f64>>) {
        let slope = |rotation: f64, heading: f64| {
            let weights = Weights {
                rotation,
                heading,
                ..Weights::default()
            };
            chain::gradient(layout, jets, z, weights)
        };
        let (net, rotation) = slope(1.0, 0.0);
        let mut slopes = Vec::with_capacity(3);
        if self.asked.goal == Goal::Distance {
            slopes.push(rotation);
        }
        if self.heads() {
            slopes.push(slope(0.0, 1.0).1);
        }
        if let Some(asked) = self.asked.period {
            let times = layout.times();
            slopes.push(DVector::from_fn(layout.size, |i, _| {
                f64::from(u8::from(times.contains(&i))) / asked
            }));
        }
        (net, self.residuals(&net, layout.period(z)), slopes)
    }

    /// Second derivatives of −ln of the measure, or of the Lagrangian if multipliers of the constraints are given.
    pub(crate) fn weights(&self, net: &Net, multipliers: Option<&[f64]>) -> Weights {
        let multiplier = |at: usize| {
            let all = multipliers.unwrap_or_default();
            all.get(at).copied().unwrap_or(0.0)
        };
        match self.asked.goal {
            Goal::Distance => Weights {
                // The terms of the members are added.
                log_distance: if self.members.is_empty() { -1.0 } else { 0.0 },
                rotation: multiplier(0),
                heading: if self.heads() { multiplier(1) } else { 0.0 },
            },
            Goal::Rotation => Weights {
                rotation: -1.0 / net.rotation,
                ..Weights::default()
            },
        }
    }

    /// Second derivatives of ln(period / measure) of the model alone, with the multipliers of the constraints.
    pub(super) fn hessian(
        &self,
        (layout, rule, jets): (&Layout, &Rule, &[Jet]),
        z: &DVector<f64>,
        (net, multipliers): (&Net, &[f64]),
    ) -> DMatrix<f64> {
        let weights = self.weights(net, Some(multipliers));
        let of = (layout, self.model, rule);
        let mut hessian = chain::hessian(of, jets, z, weights);
        if self.asked.goal == Goal::Rotation {
            // The weight changes with the measure.
            let (_, slope) = chain::gradient(layout, jets, z, self.weights(net, None));
            hessian.ger(1.0, &slope, &slope, 1.0);
        }
        let period = layout.period(z);
        for one in layout.times() {
            for other in layout.times() {
                hessian[(one, other)] -= 1.0 / (period * period);
            }
        }
        hessian
    }
}
