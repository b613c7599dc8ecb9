//! Certificate of a gait: the necessary conditions of an optimum, each with its value and tolerance.

use gait_optimizer::{Certificate, CertifyError, Verdict, certify, farthest_in_period};
use serde::Serialize;
use swimmer_files::{AnyGait, Bounds, GaitFile, Objective, SwimmerFile};

use crate::bounds::BoundsRequest;
use crate::{Context, Error, robot_limits};

/// Optimum that a gait is held against. The default is what the gait file states.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Options {
    /// Objective; `None` for that of the gait file.
    pub objective: Option<Objective>,
    /// For speed: the farthest gait in its own period, instead of the fastest of any period.
    pub fixed_period: bool,
    /// Bounds; if none is given, those of the gait file.
    pub bounds: BoundsRequest,
}

/// A certificate. The JSON document of `swimmer certify`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CertifyOutput")
)]
pub struct Output {
    /// Objective of the certificate, for text output.
    #[serde(skip)]
    pub objective: Objective,
    /// Bounds of the certificate, for text output.
    #[serde(skip)]
    pub bounds: Bounds,
    /// The conditions.
    #[serde(flatten)]
    pub certificate: Certificate,
    /// Angle \[rad\] that the faster servo turns in the period for which the gait goes farthest, if it is not the fastest of any
    /// period.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub passes_for_period_rad: Option<f64>,
}

/// Evaluates the conditions. Warns if the gait exceeds a limit of the swimmer file's robot.
///
/// # Errors
/// Neither the options nor the gait file name an objective, or no condition can be evaluated.
pub fn run(
    swimmer: &SwimmerFile,
    mut gait: GaitFile,
    options: &Options,
    context: &mut Context,
) -> Result<Output, Error> {
    if options.fixed_period {
        // The conditions are the same for every rate of the servos, and so for every length of the period.
        gait.optimal_period.get_or_insert(1.0);
    }
    let objective = options.objective.unwrap_or(gait.objective);
    if objective == Objective::Unspecified {
        return Err(Error::refused(
            "the gait states no objective to certify; choose displacement, efficiency, turning, sideways or speed",
        ));
    }
    if let Ok(curve) = AnyGait::from_file(&gait) {
        let warning = robot_limits::warning(swimmer, &curve, robot_limits::PERIOD_S);
        context.warnings.extend(warning);
    }
    let given = options.bounds.of(swimmer);
    let bounds = if given == Bounds::default() {
        gait.bounds
    } else {
        given
    };
    let certificate = certify(&swimmer.swimmer, &gait, objective, &bounds)?;
    let may_have_own_period = objective == Objective::Speed
        && gait.optimal_period.is_none()
        && certificate.verdict() != Verdict::Pass;
    let passes_for_period_rad = if may_have_own_period {
        farthest_in_period(&swimmer.swimmer, &gait, &bounds)?
    } else {
        None
    };
    Ok(Output {
        objective,
        bounds,
        certificate,
        passes_for_period_rad,
    })
}

impl From<CertifyError> for Error {
    /// No condition can be evaluated: bad input.
    fn from(error: CertifyError) -> Self {
        Self::bad_input(&error)
    }
}
