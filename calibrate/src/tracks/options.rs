//! What the user knows about a recording and the file does not say.

use swimmer_files::Axes;

use super::{TrackError, TrackProblem, TrackWarning, Unit};
use crate::tracks::lines::Line;
use std::path::Path;

/// What the user knows about a recording and the file does not say.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TrackOptions {
    /// Metres per unit of the file (per pixel); `None` where the file says its unit.
    pub metres_per_unit: Option<f64>,
    /// Rows a second: needed for files with frame numbers and no times, and wins over what any file says.
    pub rate_hz: Option<f64>,
    /// Which of the file's axes are the tank's x and y.
    pub axes: Option<Axes>,
    /// The least likelihood that counts (`DeepLabCut`); 0.9 unless said.
    pub likelihood: Option<f64>,
    /// Further points of a table by the names of their x and y columns; each is named `x,y`.
    pub pairs: Vec<[String; 2]>,
}

impl TrackOptions {
    /// The unit that holds, its metres (1 where nobody knows), and a warning where the user's overrides the file's.
    pub(super) fn unit(&self, own: Unit) -> (Unit, f64, Option<TrackWarning>) {
        let given = self
            .metres_per_unit
            .filter(|metres| metres.is_finite() && *metres > 0.0);
        match given {
            Some(metres) => {
                let overridden = own.metres().map(|_| TrackWarning::UnitOverridden {
                    unit: own.to_string(),
                });
                (Unit::Scaled(metres), metres, overridden)
            }
            None => (own, own.metres().unwrap_or(1.0), None),
        }
    }

    /// The rate that the user gave.
    pub(super) fn rate(&self) -> Option<f64> {
        self.rate_hz.filter(|rate| *rate > 0.0 && rate.is_finite())
    }

    /// The rate that holds where a header says this one, and a warning where the user's is another.
    pub(super) fn rate_over(&self, header_hz: f64) -> (f64, Option<TrackWarning>) {
        let Some(used_hz) = self.rate() else {
            return (header_hz, None);
        };
        let file_hz = header_hz;
        let other = (used_hz / file_hz - 1.0).abs() > 1e-4;
        let warning = other.then_some(TrackWarning::RateOverridden { file_hz, used_hz });
        (used_hz, warning)
    }

    /// The same where nothing else can tell it.
    pub(super) fn need_rate(&self, line: &Line<'_>, file: &Path) -> Result<f64, TrackError> {
        self.rate()
            .ok_or_else(|| line.error(file, 0, TrackProblem::NoRate))
    }

    pub(super) fn least_likelihood(&self) -> f64 {
        self.likelihood.unwrap_or(0.9)
    }
}
