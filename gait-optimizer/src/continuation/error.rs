//! Errors of continuations, and the validation of their problems.

use swimmer_files::Objective;
use swimmer_model::InvalidSwimmer;

use super::{ContinuationProblem, Parameter, Start};

/// Failure of a continuation.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ContinuationError {
    /// The swimmer's parameters are out of range.
    #[error("cannot follow gaits of this swimmer: {0}")]
    Swimmer(#[from] InvalidSwimmer),
    /// Unsupported objective, or a start with another objective.
    #[error(
        "gaits can be followed for the objectives displacement and efficiency, with starts of the same objective, not for \
         `{objective}` from here"
    )]
    Objective {
        /// Requested objective.
        objective: Objective,
    },
    /// The range of the parameter is invalid.
    #[error("cannot follow {parameter} from {from} to {to}: {problem}")]
    Range {
        /// The parameter.
        parameter: Parameter,
        /// Requested start.
        from: f64,
        /// Requested end.
        to: f64,
        /// Requirement that is violated.
        problem: &'static str,
    },
    /// A number of steps or starts is invalid.
    #[error("{steps} steps, {starts} branches: give 1 to 10000 steps and 1 to 16 branches")]
    Size {
        /// Requested number of steps.
        steps: usize,
        /// Requested number of starts.
        starts: usize,
    },
    /// There is no initial gait.
    #[error("no gait to follow from {parameter} = {from} (branch {branch}): {reason}")]
    NoStart {
        /// The parameter.
        parameter: Parameter,
        /// Its first value.
        from: f64,
        /// Index of the start.
        branch: usize,
        /// Reason.
        reason: String,
    },
}

impl ContinuationError {
    /// Returns `true` if the problem is invalid, and `false` if a valid problem has no initial gait.
    pub fn is_bad_input(&self) -> bool {
        !matches!(self, Self::NoStart { .. })
    }
}

impl ContinuationProblem {
    pub(super) fn validate(&self) -> Result<(), ContinuationError> {
        let (parameter, from, to) = (self.parameter, self.from, self.to);
        self.swimmer.check_regular()?;
        if self.objective == Objective::Efficiency {
            self.swimmer.check_efficiency()?;
        }
        if matches!(parameter, Parameter::Chi | Parameter::SphereRadius) {
            let common = self.swimmer.common_drag();
            common.map_err(InvalidSwimmer::Uncommon)?;
        }
        let range = |problem| {
            Err(ContinuationError::Range {
                parameter,
                from,
                to,
                problem,
            })
        };
        if !(from.is_finite() && to.is_finite()) {
            return range("both must be finite numbers");
        }
        if (to - from).abs() <= 1e-9 * from.abs().max(to.abs()) {
            return range("they are the same");
        }
        if parameter != Parameter::SphereRadius && from.min(to) <= 0.0 {
            return range("both must be above 0");
        }
        if from.min(to) < 0.0 {
            return range("no value may be below 0");
        }
        if parameter == Parameter::MaxAngle && from.max(to) > std::f64::consts::TAU {
            return range("a largest angle is at most one turn, 6.283 rad");
        }
        if !(1..=10_000).contains(&self.steps) || !(1..=16).contains(&self.starts.len()) {
            return Err(ContinuationError::Size {
                steps: self.steps,
                starts: self.starts.len(),
            });
        }
        self.swimmer_at(from).validate()?;
        self.swimmer_at(to).validate()?;
        let fits = |start: &Start| match start {
            Start::Efficiency(_) => self.objective == Objective::Efficiency,
            Start::Displacement { .. } => self.objective == Objective::Displacement,
            Start::Gait(gait) => gait.objective == self.objective,
        };
        let known = matches!(
            self.objective,
            Objective::Efficiency | Objective::Displacement
        );
        if !known || !self.starts.iter().all(fits) {
            return Err(ContinuationError::Objective {
                objective: self.objective,
            });
        }
        Ok(())
    }
}
