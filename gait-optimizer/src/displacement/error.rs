//! Why there is no displacement gait to return.

use std::fmt;

use super::Heading;
use crate::immobile::Immobile;
use crate::optimal_gait::OptimalGait;
use crate::problem::InvalidProblem;

/// What became of the extremals that the search sent out.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Fates {
    /// How many were sent out.
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

impl fmt::Display for Fates {
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

/// Why there is no displacement gait to return.
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
        /// What the search saw.
        fates: Fates,
    },
    /// Under these bounds there is no optimum with this sign of X.
    #[error(
        "no {heading} gait is a local optimum of displacement under these bounds{}; try other bounds or the other direction",
        outdone_words(*.outdone)
    )]
    NoOptimum {
        /// Direction asked for.
        heading: Heading,
        /// What the search saw.
        fates: Fates,
        /// X over L of a gait within the bounds that is no extremal; none where the search saw no such gait.
        outdone: Option<f64>,
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
    /// What the search saw, for who knows the maximum principle; none where the error itself says it all.
    pub fn details(&self) -> Option<String> {
        match self {
            Self::NoUnboundedOptimum { fates } => Some(format!(
                "a gait without bounds follows a zero-level curve of the height function from phi1 = phi2 to phi1 = -phi2 and \
                 ends with lambda4 = 0: {fates}"
            )),
            Self::NoOptimum { fates, .. } => Some(fates.to_string()),
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

/// That there are gaits all the same.
fn outdone_words(outdone: Option<f64>) -> String {
    outdone.map_or_else(String::new, |carried| {
        format!(
            ". There are gaits: one that is no extremal carries X/L = {carried:.6}, and the farthest go round shapes off all \
             bounds along a slit, which this search does not know"
        )
    })
}
