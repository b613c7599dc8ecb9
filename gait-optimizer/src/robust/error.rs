//! Errors of robust designs.

use swimmer_files::{ArcKind, Bounds};
use swimmer_model::InvalidSwimmer;

use crate::displacement::DisplacementError;
use crate::immobile::Immobile;
use crate::speed::SpeedError;

/// Failure of a robust design.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RobustError {
    /// The nominal optimum does not exist.
    #[error("the nominal problem comes first, and there: {0}")]
    Nominal(#[from] DisplacementError),
    /// The nominal fastest gait does not exist.
    #[error("the nominal problem comes first, and there: {0}")]
    NominalSpeed(#[from] SpeedError),
    /// A member of the ensemble is an invalid swimmer.
    #[error("{0}")]
    Swimmer(#[from] InvalidSwimmer),
    /// No gait moves the swimmer of the estimates.
    #[error(transparent)]
    Immobile(#[from] Immobile),
    /// The uncertainty is invalid.
    #[error("the {name} is {value}; {problem}")]
    Uncertainty {
        /// Name of the number.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Requirement that the value violates.
        problem: &'static str,
    },
    /// The order of the Fourier series is invalid.
    #[error("a Fourier gait of order {order}: give 1 to 12")]
    Order {
        /// The order.
        order: usize,
    },
    /// The nominal gait is not a member of the family.
    #[error("{problem}")]
    Structure {
        /// Reason.
        problem: &'static str,
    },
    /// The nominal gait has an arc that the family does not support.
    #[error(
        "a robust design follows free arcs and arcs along the largest angle only, and the nominal optimum has one of the kind `{}`",
        kind.word()
    )]
    Arc {
        /// Kind of the arc.
        kind: ArcKind,
    },
    /// The gait rotates members other than the swimmer of the estimates.
    #[error(
        "the gait turns swimmers that are not as estimated by up to {rotation:.1e} rad a cycle, so that what they swim \
         in one depends on where it begins; a robust design follows gaits that turn nobody, as loops that are their own image in \
         φ1 = -φ2 are where both side links are alike: other bounds or another heading may have such a fastest gait"
    )]
    Turns {
        /// Largest rotation per cycle \[rad\].
        rotation: f64,
    },
    /// The clearance cannot be guaranteed with an uncertain servo gain.
    #[error(
        "with a servo gain in doubt no gait along the clearance of the links keeps it: bound the angles, or know the gain"
    )]
    Clearance,
    /// The iteration did not converge.
    #[error(
        "the robust gait did not converge{}: its arcs are not those of the nominal optimum, or the intervals are too wide for one \
         gait; give narrower intervals, or optimise for their corners one by one",
        left_over(*residual)
    )]
    NotConverged {
        /// Last residual; infinite if it is unknown.
        residual: f64,
    },
    /// A bound that the family does not support is violated.
    #[error(
        "the robust gait oversteps its bounds by {by:.4} rad ({bounds}); Fourier gaits are designed without bounds, so take a lower \
         order, the small gait, or other bounds"
    )]
    Bound {
        /// Violation \[rad\].
        by: f64,
        /// The bounds.
        bounds: Bounds,
    },
    /// A condition of the certificate is violated.
    #[error("a robust gait was found, but it does not hold: {failed}")]
    NotCertified {
        /// Violated conditions.
        failed: String,
    },
}

/// Text of the residual, if it is finite.
fn left_over(residual: f64) -> String {
    if residual.is_finite() {
        format!(" (residual {residual:.1e})")
    } else {
        String::new()
    }
}
