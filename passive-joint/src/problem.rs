//! Search for the best waveform: what is given, what is free, and the bounds as linear inequalities.

use link_protocol::Joint;
use nalgebra::{DMatrix, DVector};
use swimmer_model::Model;

use crate::adjoint::CycleValues;
use crate::interior::Evaluation;
use crate::spring::straight_resistance;
use crate::{Objective, PassiveError, PassiveJoint, Waveform};

/// Spring of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SpringChoice {
    /// A spring of this k/μ \[m³/s\].
    OverViscosity(f64),
    /// The best spring is part of the search.
    Free,
}

/// Search for the best waveform of the driven joint.
#[derive(Debug, Clone, Copy)]
pub struct Problem<'a> {
    /// Model of the swimmer.
    pub model: &'a Model<f64>,
    /// The passive joint.
    pub joint: Joint,
    /// Quantity to maximise.
    pub objective: Objective,
    /// Spring.
    pub spring: SpringChoice,
    /// Period \[s\]; `None` if it is part of the search.
    pub period: Option<f64>,
    /// Largest angle of the driven joint \[rad\].
    pub max_angle: f64,
    /// Largest rate of the driven joint \[rad/s\].
    pub max_rate: Option<f64>,
    /// Odd harmonics of the waveform.
    pub harmonics: usize,
}

/// Largest number of odd harmonics; the quadrature resolves the eighth, of order 15.
pub(crate) const MOST_HARMONICS: usize = 8;
/// Instants of half a cycle at which the bounds hold. Between them an angle exceeds its bound by less than 1e-4 rad, the unit of a
/// gait table.
pub(crate) const INSTANTS: usize = 1000;
/// Smallest κ/W_pp(0) of a search: a spring that relaxes in a thousand cycles.
const SOFTEST: f64 = 1e-3;
/// Start of a search: amplitude as a share of its bound.
const FIRST_AMPLITUDE: f64 = 0.9;

/// Dependence of κ and the period on the variables.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Clock {
    /// Spring and period are given; κ is fixed.
    Fixed { kappa: f64, period: f64 },
    /// The spring is given: the period is κ over this k/μ.
    ByKappa { over_viscosity: f64 },
    /// The period is given; κ is a variable.
    FreeSpring { period: f64 },
    /// κ and the period are variables.
    Free,
}

/// The problem in scaled variables: coefficients \[rad\], then κ/W_pp(0), then the period over [`Self::time`], as far as they are free.
pub(crate) struct Scaled<'a> {
    problem: &'a Problem<'a>,
    clock: Clock,
    coefficients: usize,
    resistance: f64,
    /// Unit of a free period \[s\].
    time: f64,
    pub(crate) rows: DMatrix<f64>,
    pub(crate) limits: DVector<f64>,
}

impl Problem<'_> {
    fn clock(&self) -> Result<Clock, PassiveError> {
        let bound = |name, value: f64| {
            if value > 0.0 && value.is_finite() {
                Ok(value)
            } else {
                Err(PassiveError::Bound { name, value })
            }
        };
        if !self.model.swimmer().is_viscous() {
            return Err(PassiveError::NotViscous);
        }
        bound("largest angle [rad]", self.max_angle)?;
        if let Some(rate) = self.max_rate {
            bound("largest rate [rad/s]", rate)?;
        }
        if let Some(period) = self.period {
            bound("period [s]", period)?;
        }
        if !(1..=MOST_HARMONICS).contains(&self.harmonics) {
            return Err(PassiveError::Harmonics {
                harmonics: self.harmonics,
                most: MOST_HARMONICS,
            });
        }
        let is_unlimited = self.objective == Objective::Speed && self.max_rate.is_none();
        match (self.spring, self.period) {
            (SpringChoice::OverViscosity(stiffness), _)
                if !(stiffness > 0.0 && stiffness.is_finite()) =>
            {
                Err(PassiveError::Spring { kappa: stiffness })
            }
            (SpringChoice::OverViscosity(stiffness), Some(period)) => Ok(Clock::Fixed {
                kappa: stiffness * period,
                period,
            }),
            (SpringChoice::Free, Some(period)) => Ok(Clock::FreeSpring { period }),
            (_, None) if is_unlimited => Err(PassiveError::NeedsRate),
            (SpringChoice::OverViscosity(over_viscosity), None) => {
                Ok(Clock::ByKappa { over_viscosity })
            }
            (SpringChoice::Free, None) if self.objective == Objective::Speed => Ok(Clock::Free),
            (SpringChoice::Free, None) => Err(PassiveError::NeedsPeriod),
        }
    }
}

impl<'a> Scaled<'a> {
    pub(crate) fn new(problem: &'a Problem<'a>) -> Result<Self, PassiveError> {
        let clock = problem.clock()?;
        let coefficients = Waveform::count(problem.harmonics);
        let amplitude = FIRST_AMPLITUDE * problem.max_angle;
        let mut scaled = Self {
            problem,
            clock,
            coefficients,
            resistance: straight_resistance(problem.model, problem.joint),
            time: problem
                .max_rate
                .map_or(1.0, |rate| std::f64::consts::TAU * amplitude / rate),
            rows: DMatrix::zeros(0, 0),
            limits: DVector::zeros(0),
        };
        scaled.bound();
        Ok(scaled)
    }

    /// Number of variables.
    fn count(&self) -> usize {
        self.coefficients
            + match self.clock {
                Clock::Fixed { .. } => 0,
                Clock::ByKappa { .. } | Clock::FreeSpring { .. } => 1,
                Clock::Free => 2,
            }
    }

    /// Bounds as rows · x ≤ limits. The other half cycle has the same with the other sign.
    fn bound(&mut self) {
        let (count, problem) = (self.count(), self.problem);
        let rates = problem.max_rate;
        let softest = usize::from(count > self.coefficients);
        let each = if rates.is_some() { 4 } else { 2 };
        let mut rows = DMatrix::zeros(each * INSTANTS + softest, count);
        let mut limits = DVector::from_element(rows.nrows(), problem.max_angle);
        for instant in 0..INSTANTS {
            let u = 0.5 * instant as f64 / INSTANTS as f64;
            let at = each * instant;
            for k in 0..self.coefficients {
                let [angle, rate] = Waveform::basis(k, u);
                rows[(at, k)] = angle;
                rows[(at + 1, k)] = -angle;
                if rates.is_some() {
                    rows[(at + 2, k)] = rate;
                    rows[(at + 3, k)] = -rate;
                }
            }
            let Some(rate) = rates else { continue };
            for row in [at + 2, at + 3] {
                limits[row] = 0.0;
                match self.clock {
                    Clock::Fixed { period, .. } | Clock::FreeSpring { period } => {
                        limits[row] = rate * period;
                    }
                    Clock::ByKappa { over_viscosity } => {
                        rows[(row, self.coefficients)] = -rate * self.resistance / over_viscosity;
                    }
                    Clock::Free => rows[(row, self.coefficients + 1)] = -rate * self.time,
                }
                // Rates are 2πn times angles; rows of one size keep the slacks comparable.
                let scale = 1.0 / std::f64::consts::TAU;
                limits[row] *= scale;
                rows.row_mut(row).scale_mut(scale);
            }
        }
        if softest == 1 {
            let last = rows.nrows() - 1;
            rows[(last, self.coefficients)] = -1.0;
            limits[last] = -SOFTEST;
        }
        self.rows = rows;
        self.limits = limits;
    }

    /// Start of a search with one harmonic, strictly inside the bounds.
    pub(crate) fn sine(&self) -> DVector<f64> {
        let mut x = DVector::zeros(self.count());
        let tau = std::f64::consts::TAU;
        let mut amplitude = FIRST_AMPLITUDE * self.problem.max_angle;
        // Close to the best frequency of a small stroke.
        let mut kappa = tau;
        if let Some(rate) = self.problem.max_rate {
            match self.clock {
                Clock::Fixed { period, .. } | Clock::FreeSpring { period } => {
                    amplitude = amplitude.min(FIRST_AMPLITUDE * rate * period / tau);
                }
                Clock::ByKappa { over_viscosity } => {
                    let shortest = tau * amplitude / rate;
                    kappa =
                        kappa.max(shortest * over_viscosity / self.resistance / FIRST_AMPLITUDE);
                }
                Clock::Free => {}
            }
        }
        x[0] = amplitude;
        if self.count() > self.coefficients {
            x[self.coefficients] = kappa;
        }
        if self.clock == Clock::Free {
            x[self.coefficients + 1] = 1.0 / FIRST_AMPLITUDE;
        }
        x
    }

    /// Start from the result of a search with one harmonic, strictly inside the bounds.
    pub(crate) fn extended(&self, sine: &DVector<f64>) -> DVector<f64> {
        let mut x = DVector::zeros(self.count());
        x[0] = 0.98 * sine[0];
        x.rows_mut(self.coefficients, self.count() - self.coefficients)
            .copy_from(&sine.rows(1, sine.len() - 1));
        x
    }

    pub(crate) fn waveform(&self, x: &DVector<f64>) -> Waveform {
        Waveform::new(x.rows(0, self.coefficients).iter().copied().collect())
    }

    pub(crate) fn passive(&self, x: &DVector<f64>) -> Result<PassiveJoint, PassiveError> {
        let kappa = match self.clock {
            Clock::Fixed { kappa, .. } => kappa,
            _ => x[self.coefficients] * self.resistance,
        };
        PassiveJoint::new(self.problem.joint, kappa)
    }

    /// Period \[s\].
    pub(crate) fn period(&self, x: &DVector<f64>) -> f64 {
        match self.clock {
            Clock::Fixed { period, .. } | Clock::FreeSpring { period } => period,
            Clock::ByKappa { over_viscosity } => {
                x[self.coefficients] * self.resistance / over_viscosity
            }
            Clock::Free => x[self.coefficients + 1] * self.time,
        }
    }

    pub(crate) fn values(&self, x: &DVector<f64>) -> Result<CycleValues, PassiveError> {
        CycleValues::new(self.problem.model, &self.waveform(x), &self.passive(x)?)
    }

    /// Logarithm of the objective, and its gradient. Returns `None` without a limit cycle.
    pub(crate) fn value(&self, x: &DVector<f64>) -> Option<Evaluation> {
        let values = self.values(x).ok()?;
        let powers = self.problem.objective.exponents();
        let period = self.period(x);
        let value = powers.displacement * values.displacement.ln()
            + powers.energy * values.energy.ln()
            + powers.period * period.ln();
        if !value.is_finite() {
            return None;
        }
        let by_path = values.d_displacement * (powers.displacement / values.displacement)
            + values.d_energy * (powers.energy / values.energy);
        let mut gradient = DVector::zeros(self.count());
        gradient
            .rows_mut(0, self.coefficients)
            .copy_from(&by_path.rows(0, self.coefficients));
        if self.count() > self.coefficients {
            gradient[self.coefficients] = by_path[self.coefficients] * self.resistance;
        }
        match self.clock {
            Clock::ByKappa { .. } => {
                gradient[self.coefficients] += powers.period / x[self.coefficients];
            }
            Clock::Free => {
                gradient[self.coefficients + 1] = powers.period / x[self.coefficients + 1];
            }
            Clock::Fixed { .. } | Clock::FreeSpring { .. } => {}
        }
        Some(Evaluation { value, gradient })
    }
}
