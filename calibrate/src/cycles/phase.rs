//! When cycles begin, by the best that is known: the robot's log on a clock that is tied to the cameras', the log alone, the
//! flash of the robot's LED, or nothing but the heading.

use swimmer_files::Play;

/// More cycles than any recording has.
const MOST_CYCLES: u32 = 20_000;
/// A start may lie outside the stretch of motion by this much of a period.
const SLACK: f64 = 0.02;
/// From the first motion to the first cycle: half of the longest soft start \[s\].
const SOFT_START_S: f64 = 1.0;

/// Known starts of a run's cycles, apart from its track.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Timing {
    /// The cameras' time at which a cycle began \[s\]: the flash of the robot's LED.
    pub cycle_start_s: Option<f64>,
    /// The play by the robot's link log.
    pub play: Option<Play>,
    /// The robot's clock at the cameras' time 0 \[s\].
    pub clock_offset_s: Option<f64>,
}

/// Method by which the starts of cycles were determined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// The heading's harmonics were matched with the model's.
    Heading,
    /// A flash shows one start, and the period the others.
    Flash,
    /// By the robot's log, whose clock was tied to the cameras'.
    Log,
    /// By the robot's log, moved to where the heading's harmonics match the model's.
    LogAndHeading,
    /// X, ΔY and Δθ are stated; there is no track.
    Reported,
}

impl Phase {
    /// The word that stands for it in JSON.
    pub fn word(self) -> &'static str {
        match self {
            Self::Heading => "heading",
            Self::Flash => "flash",
            Self::Log => "log",
            Self::LogAndHeading => "log-and-heading",
            Self::Reported => "told",
        }
    }
}

/// [`Timing`] on the cameras' clock.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum CycleStarts {
    /// One each period, from wherever the heading says.
    Heading,
    /// One each period, from here.
    Flash(f64),
    /// The log's, from the play's first cycle on, and when that was, where the clocks are tied.
    Log { log: Log, first_s: Option<f64> },
}

/// Cycles of a play, seconds after its first one by the cameras' clock.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Log {
    starts: Vec<f64>,
    unsteady: Vec<f64>,
    /// A cycle that began at a flash, by the cameras.
    flash_s: Option<f64>,
}

impl Log {
    /// Start of the play's first cycle, if the flash may be that of any cycle of the play: soon after the first motion.
    fn first_by_flash(&self, motion_s: f64) -> Option<f64> {
        let flash_s = self.flash_s?;
        let wanted = motion_s + SOFT_START_S;
        let candidates = self
            .starts
            .iter()
            .chain(&self.unsteady)
            .map(|t| flash_s - t);
        candidates.min_by(|a, b| (a - wanted).abs().total_cmp(&(b - wanted).abs()))
    }
}

/// Cycles to look at.
pub(super) struct Listed {
    pub(super) starts: Vec<f64>,
    /// Those that the log says were not steady.
    pub(super) unsteady: Vec<f64>,
    /// `true` if the first of `starts` is start-up.
    pub(super) with_start_up: bool,
}

impl CycleStarts {
    /// `period_s` is that of the cameras' clock; with the log's period it gives the ratio of both clocks.
    pub(super) fn new(timing: &Timing, period_s: f64) -> Self {
        let Some(play) = &timing.play else {
            return timing.cycle_start_s.map_or(Self::Heading, Self::Flash);
        };
        let pace = period_s / play.period_s;
        let after_first =
            |times: &[f64]| times.iter().map(|t| (t - play.started_s) * pace).collect();
        Self::Log {
            log: Log {
                starts: after_first(&play.cycle_starts),
                unsteady: after_first(&play.unsteady),
                flash_s: timing.cycle_start_s,
            },
            first_s: timing
                .clock_offset_s
                .map(|offset| (play.started_s - offset) * pace),
        }
    }

    /// A start that needs no heading: of any cycle, or of the play's first one where there is a log.
    pub(super) fn known(&self, motion_s: f64) -> Option<f64> {
        match self {
            Self::Heading => None,
            Self::Flash(start) => Some(*start),
            Self::Log { first_s, log } => first_s.or_else(|| log.first_by_flash(motion_s)),
        }
    }

    /// Returns `true` if the cycles come from the log, which shows when the robot rested.
    pub(super) fn has_log(&self) -> bool {
        matches!(self, Self::Log { .. })
    }

    pub(super) fn phase(&self) -> Phase {
        match self {
            Self::Heading => Phase::Heading,
            Self::Flash(_) => Phase::Flash,
            Self::Log {
                first_s: Some(_), ..
            } => Phase::Log,
            Self::Log { log, .. } if log.flash_s.is_some() => Phase::Flash,
            Self::Log { .. } => Phase::LogAndHeading,
        }
    }

    /// The start that stands for this one, which may be that of any cycle: itself, or with a log that of the play's first
    /// cycle, which began soon after the first motion.
    pub(super) fn nearest(&self, start_s: f64, motion_s: f64, period_s: f64) -> f64 {
        match self {
            Self::Log { .. } => {
                let wanted = motion_s + SOFT_START_S;
                start_s + ((wanted - start_s) / period_s).round() * period_s
            }
            Self::Heading | Self::Flash(_) => start_s,
        }
    }

    /// The whole cycles between `from` and `to`, by one start as [`Self::known`] or [`Self::nearest`] give it.
    pub(super) fn listed(&self, start_s: f64, period_s: f64, (from, to): (f64, f64)) -> Listed {
        let slack = SLACK * period_s;
        let whole = |s: f64| s >= from - slack && s + period_s <= to + slack;
        match self {
            Self::Heading | Self::Flash(_) => {
                let first = ((from - start_s - slack) / period_s).ceil();
                let starts = (0..MOST_CYCLES)
                    .map(|k| start_s + (first + f64::from(k)) * period_s)
                    .take_while(|s| whole(*s));
                Listed {
                    starts: starts.collect(),
                    unsteady: Vec::new(),
                    with_start_up: true,
                }
            }
            Self::Log { log, .. } => {
                let on_camera = |times: &[f64]| -> Vec<f64> {
                    times
                        .iter()
                        .map(|t| start_s + t)
                        .filter(|s| whole(*s))
                        .collect()
                };
                let starts = on_camera(&log.starts);
                // A play's first cycle is start-up, wherever the recording begins.
                let with_start_up = starts.first().is_some_and(|s| s - start_s < 0.5 * period_s);
                Listed {
                    starts,
                    unsteady: on_camera(&log.unsteady),
                    with_start_up,
                }
            }
        }
    }
}
