//! Errors of the search for efficiency gaits.

use super::{Branch, ReachedBounds};
use crate::immobile::Immobile;
use crate::optimal_gait::OptimalGait;
use crate::problem::InvalidProblem;

/// Failure of the search for an efficiency gait.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EfficiencyError {
    /// The problem is invalid.
    #[error(transparent)]
    Problem(#[from] InvalidProblem),
    /// No gait moves the swimmer.
    #[error(transparent)]
    Immobile(#[from] Immobile),
    /// The free gait violates a bound, and its branch ends before it satisfies the bound.
    #[error("the {branch} gait, followed as the bounds tighten, ends at {reached}: {reason}")]
    BranchEnds {
        /// Branch of the gait.
        branch: Branch,
        /// Bounds at the end of the branch.
        reached: ReachedBounds,
        /// Reason for the end.
        reason: String,
    },
    /// The free gait violates a bound, and the first step of the continuation failed.
    #[error("the free {branch} gait breaks a bound and cannot be followed along it: {reason}")]
    NotFollowed {
        /// Branch of the gait.
        branch: Branch,
        /// Reason for the failure.
        reason: String,
    },
    /// No circle or ellipse is a local optimum.
    #[error(
        "this swimmer has no {branch} gait of most efficiency, or one at larger angles than are searched"
    )]
    NoStart {
        /// Branch of the gait.
        branch: Branch,
        /// Largest |X|/S of the required sign among the circles and ellipses.
        best: f64,
    },
    /// The amplitude of the Fourier gaits grows without limit.
    #[error(
        "this swimmer has no {branch} gait of most efficiency: gaits get better until a joint turns further than \
         {farthest:.2} rad; `swimmer atlas --objective efficiency --max-angle 2.8` finds those within a bound"
    )]
    RunsAway {
        /// Branch of the gait.
        branch: Branch,
        /// Amplitude of the initial circle \[rad\].
        amplitude: f64,
        /// Order of the series that did not converge.
        order: usize,
        /// Efficiency of the previous order.
        efficiency: f64,
        /// Largest joint angle of the search \[rad\].
        farthest: f64,
    },
    /// The Fourier gaits of the branch cross themselves, and shooting does not converge from them.
    #[error(
        "this swimmer has no simple {branch} gait of most efficiency: the best one crosses itself; `swimmer atlas --objective \
         efficiency` lists such gaits, too"
    )]
    CrossesItself {
        /// Branch of the gait.
        branch: Branch,
        /// Order of the series.
        order: usize,
        /// Its efficiency.
        efficiency: f64,
        /// Number of self-crossings.
        crossings: usize,
    },
    /// Shooting does not converge from the best initial guess.
    #[error(
        "the {branch} gait was not found: the search does not converge for this swimmer; it may be met from a swimmer that \
         works, by following its gait with `swimmer atlas --objective efficiency --continue chi=FROM..TO` or \
         `link-ratio=FROM..TO`"
    )]
    NotConverged {
        /// Branch of the gait.
        branch: Branch,
        /// Order of the series.
        order: usize,
        /// Its efficiency.
        efficiency: f64,
    },
    /// Shooting converged to a gait outside the requested branch.
    #[error(
        "there is no {branch} gait here: what was found starts at {start_angle:.3} rad with X/L = {displacement_over_length:.6}, \
         and a {branch} gait is one with {definition}"
    )]
    OtherBranch {
        /// Branch of the gait.
        branch: Branch,
        /// Its efficiency.
        efficiency: f64,
        /// Its net displacement over L.
        displacement_over_length: f64,
        /// φ₁ = φ₂ at its start \[rad\].
        start_angle: f64,
        /// Definition of the requested branch.
        definition: &'static str,
    },
    /// The best gait with the paper's symmetries is a saddle among all closed curves.
    #[error(
        "the {branch} gait with the paper's two symmetries is no optimum: curves without them that lie near are better; `swimmer \
         atlas --objective efficiency` finds those"
    )]
    Saddle {
        /// Branch of the gait.
        branch: Branch,
        /// The gait, whose certificate fails only in the second variation.
        gait: Box<OptimalGait>,
    },
    /// An extremal was found, but its certificate fails.
    #[error(
        "the {branch} gait found does not meet all conditions of an optimum, so it is not returned; try other bounds"
    )]
    NotCertified {
        /// Branch of the gait.
        branch: Branch,
        /// Its efficiency.
        efficiency: f64,
        /// Failed conditions with their values.
        failed: String,
    },
}

impl EfficiencyError {
    /// Returns the error of the search that progressed further.
    pub(super) fn or_farther(self, other: Self) -> Self {
        if other.distance() > self.distance() {
            other
        } else {
            self
        }
    }

    fn distance(&self) -> u8 {
        match self {
            Self::Saddle { .. } => 6,
            Self::NotCertified { .. } => 5,
            Self::NotConverged { .. } => 4,
            Self::CrossesItself { .. } => 3,
            Self::RunsAway { .. } => 2,
            Self::NoStart { .. } => 0,
            _ => 1,
        }
    }

    /// Details of the search for experts. Returns `None` if the error itself is complete.
    pub fn details(&self) -> Option<String> {
        Some(match self {
            Self::NoStart { best, .. } => format!(
                "|X|/S has no local maximum over circles and ellipses of 0.3 to 4.6 rad with this sign of X; the largest at the \
                 rim is {best:.3e}, in units of L and c_t"
            ),
            Self::RunsAway {
                amplitude,
                order,
                efficiency,
                ..
            } => format!(
                "from the circle of {amplitude:.3} rad the Fourier gaits of order {order} run away (efficiency {efficiency:.6e} at \
                 the order before)"
            ),
            Self::CrossesItself {
                order,
                efficiency,
                crossings,
                ..
            } => format!(
                "the Fourier gait of order {order} (efficiency {efficiency:.9e}) crosses itself {crossings} times"
            ),
            Self::NotConverged {
                order, efficiency, ..
            } => format!(
                "the Fourier gait of order {order} has efficiency {efficiency:.9e}, but shooting does not converge from it to a \
                 residual of 1e-10"
            ),
            Self::OtherBranch { efficiency, .. } => format!("its efficiency is {efficiency:.9e}"),
            Self::Saddle { gait, .. } => format!(
                "it has efficiency {:.9e} and X/L = {:.6}; it fails {}",
                gait.efficiency,
                gait.displacement_over_length,
                gait.certificate.failures()
            ),
            Self::NotCertified {
                efficiency, failed, ..
            } => format!("its efficiency is {efficiency:.9e}; it fails {failed}"),
            _ => return None,
        })
    }

    /// Returns `true` if the problem is invalid, and `false` if a valid problem has no solution.
    pub fn is_bad_input(&self) -> bool {
        matches!(self, Self::Problem(_))
    }
}
