//! Errors of the pose reconstruction.

/// Error of the pose reconstruction.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PoseError {
    /// A reflector's point is not in the file.
    #[error(
        "the {reflector} reflector is called `{wanted}`, but the points in the track are {points}; change `point` in the campaign"
    )]
    NoPoint {
        /// `front` or `back`.
        reflector: &'static str,
        /// The requested name.
        wanted: String,
        /// The names that are there.
        points: String,
    },
    /// Nobody said how long the track's unit is.
    #[error(
        "the track's lengths are in `{unit}`; give that length in metres (`scale` under [tracks] in the campaign, or --scale){}",
        scale.map_or(String::new(), |scale| format!("; by the reflectors' distance it is {scale:.6e}"))
    )]
    NoScale {
        /// The unit.
        unit: crate::Unit,
        /// The scale at which the reflectors' distance is right, if they can be distinguished.
        scale: Option<f64>,
    },
    /// No rigid body of this name has an orientation in the file.
    #[error(
        "the track has no rigid body called `{wanted}` with an orientation{}; change `body` in the campaign, export rotations too, or \
         name two reflectors", if bodies.is_empty() { String::new() } else { format!("; those with one are {bodies}") }
    )]
    NoBody {
        /// The name.
        wanted: String,
        /// The bodies that are there.
        bodies: String,
    },
    /// The rigid body is never tracked.
    #[error("the rigid body `{body}` is tracked in none of {frames} frames")]
    BodyUnseen {
        /// Its name.
        body: String,
        /// Rows of the file.
        frames: usize,
    },
    /// The axis that is to show the heading is the normal of the plane.
    #[error(
        "the {axis} axis of the rigid body `{body}` stands upright on the tank's plane, so it shows no heading; name another `axis`"
    )]
    BodyAxis {
        /// Its name.
        body: String,
        /// The axis.
        axis: &'static str,
    },
    /// Both reflectors are at the same place on the link.
    #[error("both reflectors sit at the same place of the link, so they show no heading")]
    SamePlace,
    /// No two points ever have the right distance.
    #[error(
        "no two points are {expected_m:.5} m apart (within {tolerance_m:.5} m) in any of {frames} frames; check `at` of both \
         reflectors, the unit and the points' names"
    )]
    NoPair {
        /// Distance by `at` of the campaign \[m\].
        expected_m: f64,
        /// Tolerance \[m\].
        tolerance_m: f64,
        /// Rows that were searched.
        frames: usize,
    },
    /// Front and back are one and the same point.
    #[error(
        "front and back both name `{point}`: it is at no distance from itself; name another point for one of them, or, if it is a rigid \
         body, write body = \"{point}\" in their place"
    )]
    SamePoint {
        /// The point's name.
        point: String,
    },
    /// The named points have another distance than `at` says.
    #[error(
        "the reflectors are {measured_m:.5} m apart in the track but {expected_m:.5} m by `at`; if the track is in other units, a \
         scale of {scale:.6} makes them agree"
    )]
    Distance {
        /// Median distance in the track \[m\].
        measured_m: f64,
        /// Distance by `at` \[m\].
        expected_m: f64,
        /// Expected over measured.
        scale: f64,
    },
}
