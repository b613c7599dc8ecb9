//! State of the brain: one enum with data.

use crate::ramp::Ramp;
use link_protocol::{Play, StateName};

/// State of the brain. Times are ticks since the start, on the grid of the servo period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum State {
    /// Pulses off.
    Stopped,
    /// Pulses off, e-stop latched.
    EStopped,
    /// Pulses on, holding `pose`.
    Holding { pose: [f32; 2] },
    /// Ramp to the first knot, at the start of a play or before the first cycle of a swapped table.
    Starting {
        ramp: Ramp,
        since: u64,
        play: Progress,
    },
    /// Playing the table. At tick `since` the play's progress was `play`.
    Playing { since: u64, play: Progress },
    /// Holding `pose` within a play.
    Paused {
        pose: [f32; 2],
        since_us: u64,
        detached: bool,
        play: Progress,
    },
    /// Ramp to neutral.
    Stopping { ramp: Ramp, since: u64 },
    /// At neutral, with pulses on for the last half second.
    Settling { since: u64 },
}

/// Progress of a play.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Progress {
    /// Request of this play.
    pub(crate) request: Play,
    /// Time played, µs, without ramps and pauses: whole ticks, or whole periods after a swap.
    pub(crate) elapsed_us: u64,
}

impl Progress {
    pub(crate) fn period_us(&self) -> u64 {
        u64::from(self.request.period_us.max(1))
    }

    /// Number of finished cycles.
    pub(crate) fn cycles_done(&self) -> u64 {
        self.elapsed_us / self.period_us()
    }

    /// Time since the start of the present cycle, µs.
    pub(crate) fn in_cycle_us(&self) -> u32 {
        (self.elapsed_us % self.period_us()) as u32
    }

    /// Remaining time of the play, µs; 0 if it is endless.
    pub(crate) fn left_us(&self) -> u64 {
        let all_us = self.period_us() * u64::from(self.request.cycles);
        all_us.saturating_sub(self.elapsed_us)
    }

    /// Returns true if the last cycle is done.
    pub(crate) fn finished(&self) -> bool {
        self.request.cycles != 0 && self.cycles_done() >= u64::from(self.request.cycles)
    }
}

impl State {
    pub(crate) fn name(&self) -> StateName {
        match self {
            Self::Stopped => StateName::Stopped,
            Self::EStopped => StateName::EStopped,
            Self::Holding { .. } => StateName::Holding,
            Self::Starting { .. } => StateName::Starting,
            Self::Playing { .. } => StateName::Playing,
            Self::Paused { .. } => StateName::Paused,
            Self::Stopping { .. } => StateName::Stopping,
            Self::Settling { .. } => StateName::Settling,
        }
    }

    /// Returns true if the pulses are on.
    pub(crate) fn powered(&self) -> bool {
        !matches!(self, Self::Stopped | Self::EStopped)
    }

    /// Play in progress. Returns `None` in other states.
    pub(crate) fn play(&self) -> Option<&Progress> {
        match self {
            Self::Starting { play, .. }
            | Self::Playing { play, .. }
            | Self::Paused { play, .. } => Some(play),
            _ => None,
        }
    }

    /// Returns true if the motion continues without a link.
    pub(crate) fn detached(&self) -> bool {
        match self {
            Self::Starting { play, .. } | Self::Playing { play, .. } => play.request.detached,
            Self::Paused { detached, .. } => *detached,
            _ => false,
        }
    }
}
