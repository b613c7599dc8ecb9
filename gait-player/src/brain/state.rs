//! State of the brain: one enum with data.

use crate::ramp::Ramp;
use link_protocol::{Play, StateName};

/// State of the brain. Ticks are counted on the servo period's grid since the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum State {
    /// Pulses off.
    Stopped,
    /// Pulses off, latched.
    EStopped,
    /// Pulses on, standing at `pose`.
    Holding { pose: [f32; 2] },
    /// On a ramp to the first knot, at the start of a play or of a swapped table's first cycle.
    Starting {
        ramp: Ramp,
        since: u64,
        play: Progress,
    },
    /// Playing the table; at tick `since` the play had come as far as `play`.
    Playing { since: u64, play: Progress },
    /// Standing at `pose` within a play.
    Paused {
        pose: [f32; 2],
        since_us: u64,
        detached: bool,
        play: Progress,
    },
    /// On the ramp to neutral.
    Stopping { ramp: Ramp, since: u64 },
    /// At neutral, pulses on for the last half second.
    Settling { since: u64 },
}

/// Progress of a play.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Progress {
    /// The request for it.
    pub(crate) request: Play,
    /// Time played, µs, without ramps and pauses; the sum of whole ticks, or of whole periods after a swap.
    pub(crate) elapsed_us: u64,
}

impl Progress {
    pub(crate) fn period_us(&self) -> u64 {
        u64::from(self.request.period_us.max(1))
    }

    /// Whole cycles done.
    pub(crate) fn cycles_done(&self) -> u64 {
        self.elapsed_us / self.period_us()
    }

    /// Time within the cycle, µs.
    pub(crate) fn in_cycle_us(&self) -> u32 {
        (self.elapsed_us % self.period_us()) as u32
    }

    /// Time until the last cycle is done, µs; 0 for a play without end.
    pub(crate) fn left_us(&self) -> u64 {
        let all_us = self.period_us() * u64::from(self.request.cycles);
        all_us.saturating_sub(self.elapsed_us)
    }

    /// The last cycle is done.
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

    /// Pulses are on.
    pub(crate) fn powered(&self) -> bool {
        !matches!(self, Self::Stopped | Self::EStopped)
    }

    /// The play that is under way.
    pub(crate) fn play(&self) -> Option<&Progress> {
        match self {
            Self::Starting { play, .. }
            | Self::Playing { play, .. }
            | Self::Paused { play, .. } => Some(play),
            _ => None,
        }
    }

    /// Goes on without a link.
    pub(crate) fn detached(&self) -> bool {
        match self {
            Self::Starting { play, .. } | Self::Playing { play, .. } => play.request.detached,
            Self::Paused { detached, .. } => *detached,
            _ => false,
        }
    }
}
