//! Reasons for a track without cycles.

use std::fmt;

use super::LeftOut;
use super::periodicity::Periodicity;
use crate::poses::PoseTrack;

/// Reason for a track without cycles.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CycleError {
    /// The robot never moves.
    #[error("the robot does not move in this track")]
    NoMotion,
    /// The reflectors are lost in most frames.
    #[error("no cycle can be seen: {0}")]
    Lost(Loss),
    /// The track holds less than two cycles of this period.
    #[error(
        "the track is {track_s:.2} s long, less than two cycles of {period_s} s; check period_s, or record longer"
    )]
    TooShort {
        /// From the first to the last sample \[s\].
        track_s: f64,
        /// The period \[s\].
        period_s: f64,
    },
    /// A cycle of this period is over within a few samples.
    #[error(
        "the cameras took {samples:.2} samples in a cycle of {period_s} s, too few to see one; check period_s (it is in seconds)"
    )]
    TooQuick {
        /// Rows in one period.
        samples: f64,
        /// The period \[s\].
        period_s: f64,
    },
    /// Not one whole cycle.
    #[error(
        "the robot moves for {active_s:.2} s, from {from_s:.2} s on, and no cycle of {period_s:.3} s in it is whole and clean \
         ({left_out} left out); {}",
        loss.as_ref().map_or_else(|| "check period_s, or record longer".to_owned(), ToString::to_string)
    )]
    NoCycle {
        /// From when it moves \[s\].
        from_s: f64,
        /// Duration of the motion \[s\].
        active_s: f64,
        /// The period \[s\].
        period_s: f64,
        /// Cycles that were left out.
        left_out: usize,
        /// Lost reflectors, if these are why.
        loss: Option<Loss>,
    },
    /// The heading does not swing, so the start of a cycle is undetermined.
    #[error(
        "the heading does not swing with the period of {period_s:.3} s; check period_s and the gait"
    )]
    NoPhase {
        /// The period \[s\].
        period_s: f64,
    },
    /// The heading repeats, but with another period.
    #[error("{0}")]
    OtherPeriod(Periodicity),
}

/// Reflectors that are lost too often for any cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loss {
    /// Share of the frames in which both reflectors were followed.
    pub followed: f64,
    /// Standard deviation of their distance, as a share of it.
    pub scatter: f64,
}

/// Scatter of the reflectors' distance that makes following fail, as a share of it.
const NOISY: f64 = 0.03;

impl Loss {
    /// `None` if most cycles were left out for other reasons than missing samples.
    pub(super) fn of(track: &PoseTrack, left_out: &[(f64, LeftOut)]) -> Option<Self> {
        let whole = left_out.iter().filter(|(_, why)| *why != LeftOut::StartUp);
        let (mut missing, mut others) = (0, 0);
        for (_, why) in whole {
            match why {
                LeftOut::Missing(_) => missing += 1,
                _ => others += 1,
            }
        }
        (missing > others).then(|| Self::measured(track))
    }

    /// `None` if both reflectors were followed in half of the frames or more.
    pub(super) fn of_most(track: &PoseTrack) -> Option<Self> {
        Some(Self::measured(track)).filter(|loss| loss.followed < 0.5)
    }

    fn measured(track: &PoseTrack) -> Self {
        let report = &track.report;
        Self {
            followed: report.followed as f64 / track.frames.max(1) as f64,
            scatter: report.distance_sd_m / report.distance_m,
        }
    }
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "both reflectors are followed in only {:.0} % of the frames",
            100.0 * self.followed
        )?;
        if self.scatter > NOISY {
            write!(
                f,
                ", and their distance scatters by {:.1} %: noise hides them; check focus, exposure and the calibration of the cameras",
                100.0 * self.scatter
            )
        } else {
            f.write_str(": they are lost; check what hides them, exposure and thresholds, or track more reflectors as a rigid body")
        }
    }
}
