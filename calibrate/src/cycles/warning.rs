//! Warnings about a run's cycles, and reasons to leave one out.

use std::fmt;

use super::periodicity::Periodicity;

/// Warning about a run's cycles.
#[derive(Debug, Clone, PartialEq)]
pub enum CycleWarning {
    /// The period differs from the commanded one by more than 0.5 %.
    Period {
        /// The commanded period \[s\].
        commanded_s: f64,
        /// The measured period \[s\].
        found_s: f64,
    },
    /// No period within ±2 % of the commanded one is best.
    PeriodNotFound {
        /// The commanded period \[s\].
        commanded_s: f64,
    },
    /// Only one cycle: X is its drift, and there is no deviation.
    OneCycle,
    /// The start-up cycle could not be dropped, because it is the only one.
    StartUpKept,
    /// The heading says that cycles began at another time than the log or the flash does.
    PhaseDiffers {
        /// By how much later \[s\].
        by_s: f64,
        /// The period \[s\].
        period_s: f64,
    },
    /// The heading hardly repeats with the period.
    Repeats(Periodicity),
}

/// Phases may differ by this much of a period before it is worth a word.
pub(super) const SAME_PHASE: f64 = 0.02;

impl fmt::Display for CycleWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Period {
                commanded_s,
                found_s,
            } => write!(
                f,
                "the period is {found_s:.4} s, not {commanded_s} s as commanded ({:+.2} %): the clocks drift, or the command was another",
                100.0 * (found_s / commanded_s - 1.0)
            ),
            Self::PeriodNotFound { commanded_s } => write!(
                f,
                "no period within 2 % of {commanded_s} s fits best; {commanded_s} s was used; check period_s"
            ),
            Self::OneCycle => f.write_str(
                "there is only one clean cycle: X is taken from its drift, without a deviation",
            ),
            Self::StartUpKept => {
                f.write_str("the only cycle is the first, which may hold the start-up")
            }
            Self::PhaseDiffers { by_s, period_s } => write!(
                f,
                "by the heading, cycles began {by_s:+.3} s ({:+.1} % of a period) from where the log or the flash puts them: check \
                 clock_offset_s or cycle_start_s, and the gait",
                100.0 * by_s / period_s
            ),
            Self::Repeats(repeats) => repeats.fmt(f),
        }
    }
}

/// Reason for leaving out a whole cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LeftOut {
    /// The first one.
    StartUp,
    /// Too many samples are missing: the share.
    Missing(f64),
    /// Its poses are unlike the other cycles': residual \[m\].
    Unlike(f64),
    /// By the robot's log it was broken off, paused or swapped.
    Unsteady,
    /// The pose jumps in it.
    Jump,
    /// Not the cycle, but the step from it to the next one: how far it is from the run's other steps.
    Step {
        /// Deviation of the position \[m\].
        by_m: f64,
        /// Deviation of the turn \[rad\].
        by_rad: f64,
    },
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::StartUp => f.write_str("start-up: the first whole cycle is never used"),
            Self::Missing(share) => write!(f, "{:.0} % of its samples are missing", 100.0 * share),
            Self::Unlike(residual_m) => write!(
                f,
                "unlike the others: {:.2} mm (rms) from its own harmonic curve",
                1e3 * residual_m
            ),
            Self::Unsteady => {
                f.write_str("by the robot's log its pace changed (pause, swap or stop)")
            }
            Self::Jump => f.write_str("the pose jumps in it"),
            Self::Step { by_m, by_rad } => write!(
                f,
                "only the step from it to the next one: {:.1} mm and {:+.1}° from the other steps, as if the robot was pushed or the \
                 frame of the cameras moved",
                1e3 * by_m,
                by_rad.to_degrees()
            ),
        }
    }
}
