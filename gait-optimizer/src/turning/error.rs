//! Why there is no turning gait to return.

use swimmer_model::InvalidSwimmer;

/// Why there is no turning gait to return.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TurningError {
    /// The swimmer's parameters are out of range.
    #[error("cannot optimise this swimmer: {0}")]
    Swimmer(#[from] InvalidSwimmer),
    /// The upper bound makes no sense.
    #[error(
        "max_angle = {value} rad: an upper bound must be above 0 and at most one turn, 6.283 rad"
    )]
    MaxAngle {
        /// Its value \[rad\].
        value: f64,
    },
    /// The clearance makes no sense.
    #[error("clearance = {value} m: give 0 or more, and less than the middle link, {middle} m")]
    Clearance {
        /// Its value \[m\].
        value: f64,
        /// l₀ \[m\].
        middle: f64,
    },
    /// Lower bounds and the sector only make sense for quarters.
    #[error(
        "a lower bound and the sector belong to gaits made of four like quarters; a turning gait takes an upper bound and \
         links kept from crossing"
    )]
    QuarterBounds,
    /// The border of the region cannot be seen from the straight shape.
    #[error(
        "the shapes that these bounds allow are hidden from the straight shape in part; give a tighter upper bound"
    )]
    Border,
    /// A region of the curvature could not be gone round.
    #[error(
        "cannot go round a region of the curvature: near ({}, {}) rad {what}; change the bound a little",
        near[0],
        near[1]
    )]
    Lost {
        /// Joint angles \[rad\].
        near: [f64; 2],
        /// What stands in the way.
        what: &'static str,
    },
    /// The curvature is nowhere positive.
    #[error("the curvature of the heading is nowhere positive within these bounds: no gait turns")]
    NoRegion,
    /// A gait was found, but it fails its certificate.
    #[error("the best loop found (it turns {rotation} rad) is no optimum: it fails {failed}")]
    NotCertified {
        /// Its net rotation \[rad\].
        rotation: f64,
        /// The checks that it fails, with their values.
        failed: String,
    },
}
