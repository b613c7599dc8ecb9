//! Why there is no robust design.

use swimmer_files::{ArcKind, Bounds};
use swimmer_model::InvalidSwimmer;

use crate::displacement::DisplacementError;
use crate::immobile::Immobile;
use crate::speed::SpeedError;

/// Why there is no robust design.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RobustError {
    /// The nominal optimum does not exist.
    #[error("the nominal problem comes first, and there: {0}")]
    Nominal(#[from] DisplacementError),
    /// The nominal fastest gait does not exist.
    #[error("the nominal problem comes first, and there: {0}")]
    NominalSpeed(#[from] SpeedError),
    /// A member is no swimmer.
    #[error("{0}")]
    Swimmer(#[from] InvalidSwimmer),
    /// Gaits do not move the swimmer of the estimates.
    #[error(transparent)]
    Immobile(#[from] Immobile),
    /// The uncertainty makes no sense.
    #[error("the {name} is {value}; {problem}")]
    Uncertainty {
        /// Which number.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        problem: &'static str,
    },
    /// The order of the Fourier series.
    #[error("a Fourier gait of order {order}: give 1 to 12")]
    Order {
        /// The order.
        order: usize,
    },
    /// The nominal gait is not of the family.
    #[error("{problem}")]
    Structure {
        /// What stands against it.
        problem: &'static str,
    },
    /// The nominal gait has an arc that the family does not know.
    #[error(
        "a robust design follows free arcs and arcs along the largest angle only, and the nominal optimum has one of the kind `{}`",
        kind.word()
    )]
    Arc {
        /// Its kind.
        kind: ArcKind,
    },
    /// The gait turns other swimmers than that of the estimates.
    #[error(
        "the gait turns swimmers that are not as estimated by up to {rotation:.1e} rad a cycle, so that what they swim \
         in one depends on where it begins; a robust design follows gaits that turn nobody, as loops that are their own image in \
         φ1 = -φ2 are where both side links are alike: other bounds or another heading may have such a fastest gait"
    )]
    Turns {
        /// The most of a cycle \[rad\].
        rotation: f64,
    },
    /// Links cannot be kept apart where nobody knows how far servos turn.
    #[error(
        "with a servo gain in doubt no gait along the clearance of the links keeps it: bound the angles, or know the gain"
    )]
    Clearance,
    /// The search did not end.
    #[error(
        "the robust gait did not converge{}: its arcs are not those of the nominal optimum, or the intervals are too wide for one \
         gait; give narrower intervals, or optimise for their corners one by one",
        left_over(*residual)
    )]
    NotConverged {
        /// What was left; infinite where nothing was reached that could tell.
        residual: f64,
    },
    /// A bound that the family does not know is broken.
    #[error(
        "the robust gait oversteps its bounds by {by:.4} rad ({bounds}); Fourier gaits are designed without bounds, so take a lower \
         order, the small gait, or other bounds"
    )]
    Bound {
        /// By how much \[rad\].
        by: f64,
        /// The bounds.
        bounds: Bounds,
    },
    /// A condition does not hold.
    #[error("a robust gait was found, but it does not hold: {failed}")]
    NotCertified {
        /// What failed.
        failed: String,
    },
}

/// What is left of the equations, where it is a number.
fn left_over(residual: f64) -> String {
    if residual.is_finite() {
        format!(" (residual {residual:.1e})")
    } else {
        String::new()
    }
}
