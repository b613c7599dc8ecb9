//! Timing of an optimised gait under a limit on the servos' rate.

use forecast::{Timing, TimingError, timing_of_table};
use gait_optimizer::OptimalGait;
use serde::{Deserialize, Serialize};
use swimmer_files::{AnyGait, GaitFile};
use swimmer_model::{Model, Tolerance, swim};

use crate::Error;

/// Rate of the servos, and period of the gait.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Request {
    /// Largest rate of each servo \[rad/s\].
    pub max_rate: f64,
    /// Duration of a cycle \[s\].
    pub period: f64,
}

/// A gait's timing under the limit.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GaitTiming {
    /// The timing.
    #[serde(flatten)]
    pub timing: Timing,
    /// Displacement over the period \[m/s\].
    pub speed_m_per_s: f64,
}

/// A gait with its timing.
#[derive(Debug, Clone)]
pub(super) struct TimedGait {
    pub(super) timing: GaitTiming,
    /// The gait with this timing.
    pub(super) file: GaitFile,
    /// Efficiency of that file as timed.
    pub(super) efficiency: f64,
}

impl TimedGait {
    /// Times a gait, if a rate is requested.
    ///
    /// # Errors
    /// Servos of that rate cannot play the gait in this period.
    pub(super) fn new(
        request: Option<Request>,
        name: &str,
        gait: &OptimalGait,
    ) -> Result<Option<Self>, Error> {
        let Some(Request { max_rate, period }) = request else {
            return Ok(None);
        };
        if !super::ALL_SEARCHES {
            return Err(super::left_out("the timing under a rate"));
        }
        let model = Model::new(&gait.swimmer).map_err(|error| Error::failed(&error))?;
        let (timing, file) = timing_of_table(&model, &gait.gait_file(name), period, max_rate)?;
        let timed = AnyGait::from_file(&file).map_err(|error| Error::failed(&error))?;
        let length = gait.swimmer.total_length();
        let distance = gait
            .displacement_over_length
            .hypot(gait.lateral_over_length)
            * length;
        Ok(Some(Self {
            efficiency: swim(&model, &timed, &Tolerance::default()).efficiency(),
            timing: GaitTiming {
                speed_m_per_s: distance / timing.period,
                timing,
            },
            file,
        }))
    }
}

impl From<TimingError> for Error {
    /// Invalid numbers are bad input; a gait that servos cannot play in time is a failure.
    fn from(error: TimingError) -> Self {
        match error {
            TimingError::Rate { .. } | TimingError::Period { .. } => Self::bad_input(&error),
            _ => Self::failed(&error),
        }
    }
}
