//! Errors of the displacement search.

use std::fmt;

use super::Heading;
use crate::immobile::Immobile;
use crate::optimal_gait::OptimalGait;
use crate::problem::InvalidProblem;

/// Outcomes of the extremals that the search traced.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ExtremalOutcomes {
    /// Number of quarters traced.
    pub sent: usize,
    /// Reached φ₁ = −φ₂.
    pub ended: usize,
    /// The smallest |λ₄| (over L) with which one reached φ₁ = −φ₂; an optimum has 0.
    pub nearest: Option<f64>,
    /// Came back to φ₁ = φ₂ where they or their mirror images had been.
    pub came_back: usize,
    /// Left the horizon of the search.
    pub left_horizon: usize,
    /// The Legendre–Clebsch condition would lead them out of the quarter at once.
    pub wrong_way: usize,
    /// Never ended, or the singular control broke down.
    pub lost: usize,
}

impl ExtremalOutcomes {
    /// Those of two searches.
    fn and(self, more: &Self) -> Self {
        Self {
            sent: self.sent + more.sent,
            ended: self.ended + more.ended,
            nearest: [self.nearest, more.nearest]
                .into_iter()
                .flatten()
                .reduce(f64::min),
            came_back: self.came_back + more.came_back,
            left_horizon: self.left_horizon + more.left_horizon,
            wrong_way: self.wrong_way + more.wrong_way,
            lost: self.lost + more.lost,
        }
    }
}

impl fmt::Display for ExtremalOutcomes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "of {} extremals, {} reach phi1 = -phi2",
            self.sent, self.ended
        )?;
        if let Some(nearest) = self.nearest {
            write!(
                f,
                " (but miss lambda4 = 0 there by at least {nearest:.2e} L)"
            )?;
        }
        write!(
            f,
            ", {} come back to phi1 = phi2, {} leave the angles searched, {} start out of the quarter, {} get lost",
            self.came_back, self.left_horizon, self.wrong_way, self.lost
        )
    }
}

/// Error of the displacement search.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DisplacementError {
    /// It makes no sense.
    #[error(transparent)]
    Problem(#[from] InvalidProblem),
    /// Gaits do not move it.
    #[error(transparent)]
    Immobile(#[from] Immobile),
    /// Without bounds on the angles there is no optimum.
    #[error(
        "this swimmer has no gait of most displacement without a bound on the joint angles; give one, as --max-angle 2.8: a \
         gait can then run along it"
    )]
    NoUnboundedOptimum {
        /// Counts of how the traced quarters ended.
        outcomes: ExtremalOutcomes,
    },
    /// Under these bounds there is no optimum with this sign of X.
    #[error("{}", no_optimum(*.heading))]
    NoOptimum {
        /// Requested sense; `None` for either.
        heading: Option<Heading>,
        /// Outcomes of the extremals.
        outcomes: ExtremalOutcomes,
    },
    /// The best gait with the paper's symmetries is a saddle among all closed curves.
    #[error(
        "the best gait with the paper's two symmetries is no optimum: curves without them that lie near carry farther; `swimmer atlas \
         --objective displacement` finds those"
    )]
    Saddle {
        /// The gait, whose certificate fails in that alone.
        gait: Box<OptimalGait>,
    },
    /// Extremals were found, but the best of them fails its certificate.
    #[error(
        "the best gait found (X/L = {displacement_over_length:.6}) does not meet all conditions of an optimum, so it is not \
         returned; try other bounds"
    )]
    NotCertified {
        /// Its net displacement over L.
        displacement_over_length: f64,
        /// The checks that it fails, with their values.
        failed: String,
    },
}

impl DisplacementError {
    /// The reason why neither sense has a gait: that of the sense that came closer to one.
    pub(crate) fn or_backwards(self, backwards: Self) -> Self {
        match (self, backwards) {
            (
                Self::NoUnboundedOptimum { outcomes },
                Self::NoUnboundedOptimum { outcomes: more },
            ) => {
                let outcomes = outcomes.and(&more);
                Self::NoUnboundedOptimum { outcomes }
            }
            (Self::NoOptimum { outcomes, .. }, Self::NoOptimum { outcomes: more, .. }) => {
                Self::NoOptimum {
                    heading: None,
                    outcomes: outcomes.and(&more),
                }
            }
            (Self::NoOptimum { .. } | Self::NoUnboundedOptimum { .. }, closer) => closer,
            (forwards, _) => forwards,
        }
    }

    /// Summary of the search in the terms of the maximum principle. Returns `None` if the error is complete without it.
    pub fn details(&self) -> Option<String> {
        match self {
            Self::NoUnboundedOptimum { outcomes } => Some(format!(
                "a gait without bounds follows a zero-level curve of the height function from phi1 = phi2 to phi1 = -phi2 and \
                 ends with lambda4 = 0: {outcomes}"
            )),
            Self::NoOptimum { outcomes, .. } => Some(outcomes.to_string()),
            Self::Saddle { gait } => Some(format!(
                "it carries X/L = {:.6}; it fails {}",
                gait.displacement_over_length,
                gait.certificate.failures()
            )),
            Self::NotCertified { failed, .. } => Some(format!("it fails {failed}")),
            _ => None,
        }
    }
}

fn no_optimum(heading: Option<Heading>) -> String {
    heading.map_or_else(
        || "no gait is a local optimum of displacement under these bounds; try other bounds".to_owned(),
        |heading| {
            format!(
                "no {heading} gait is a local optimum of displacement under these bounds; try other bounds or the other direction"
            )
        },
    )
}
