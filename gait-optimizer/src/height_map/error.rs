//! Errors of height maps.

use swimmer_model::InvalidSwimmer;

use super::HeightMap;

/// Failure to compute a height map or to apply the area rule.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum HeightMapError {
    /// The swimmer's parameters are out of range.
    #[error("cannot map this swimmer: {0}")]
    Swimmer(#[from] InvalidSwimmer),
    /// The half width of the square is out of range.
    #[error(
        "cannot map joint angles up to {value} rad: give a bound between {} and {:.3} rad",
        HeightMap::NARROWEST,
        HeightMap::WIDEST
    )]
    HalfWidth {
        /// D \[rad\].
        value: f64,
    },
    /// The frame did not converge at the highest order.
    #[error(
        "the minimum-perturbation coordinates on joint angles up to {half_width} rad do not converge with \
         polynomials of order {order}; map smaller angles"
    )]
    NotConverged {
        /// D \[rad\].
        half_width: f64,
        /// Highest order.
        order: usize,
    },
    /// A gait leaves the square.
    #[error(
        "the gait reaches {reach:.4} rad, beyond the map's {half_width:.4} rad; map joint angles up to its reach or further"
    )]
    GaitBeyondMap {
        /// The gait's largest |φᵢ| \[rad\].
        reach: f64,
        /// D \[rad\].
        half_width: f64,
    },
}
