//! Progress of a play, and its end time.

use std::fmt;

use link_protocol::{StateName, Status, Telemetry};

use super::outputs::state;
use crate::progress::Progress;

/// A play, according to the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Playing {
    /// Cycles done, with the fraction of the present one.
    pub(super) done: f64,
    /// Requested cycles; `None`: without end.
    pub(super) cycles: Option<u32>,
    /// Duration of a cycle, s; 0 before the first play.
    pub(super) period_s: f64,
}

impl Playing {
    pub(super) fn of(status: &Status) -> Self {
        Self {
            done: done(status.cycle, status.phase),
            cycles: (status.cycles > 0).then_some(status.cycles),
            period_s: f64::from(status.period_us) / 1e6,
        }
    }

    /// The same play, later.
    pub(super) fn at(self, telemetry: &Telemetry) -> Self {
        Self {
            done: done(telemetry.cycle, telemetry.phase),
            cycles: (telemetry.cycles > 0).then_some(telemetry.cycles),
            ..self
        }
    }

    /// Time to the end of the last cycle, s, without pauses; `None` for a play without end.
    pub(super) fn remaining_s(&self) -> Option<f64> {
        let cycles = f64::from(self.cycles?);
        Some((cycles - self.done).max(0.0) * self.period_s)
    }

    /// Progress of a play that is over.
    pub(super) fn so_far(&self) -> String {
        match self.cycles {
            _ if self.period_s <= 0.0 => "nothing played yet".to_owned(),
            Some(cycles) => format!("played {:.2} of {cycles} cycles", self.done),
            None => format!("played {:.2} cycles", self.done),
        }
    }

    /// Share of the play that is done; `None` for a play without end.
    pub(super) fn share(&self) -> Option<f64> {
        self.cycles
            .map(|cycles| (self.done / f64::from(cycles)).clamp(0.0, 1.0))
    }
}

fn done(cycle: u32, phase: u16) -> f64 {
    f64::from(cycle) + f64::from(phase) / 65_536.0
}

impl fmt::Display for Playing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.cycles, self.remaining_s()) {
            (Some(cycles), Some(remaining)) => write!(
                f,
                "cycle {:.2} of {cycles}, {} to go",
                self.done,
                duration(remaining)
            ),
            _ => write!(f, "cycle {:.2}, without end", self.done),
        }
    }
}

/// The play on a progress line.
pub(super) struct PlayProgress {
    play: Playing,
    progress: Progress,
}

impl PlayProgress {
    pub(super) fn new(play: Playing) -> Self {
        Self {
            play,
            progress: Progress::with_share(""),
        }
    }

    /// Takes new telemetry.
    pub(super) fn update(&mut self, telemetry: &Telemetry) {
        self.play = self.play.at(telemetry);
        if let Some(share) = self.play.share() {
            self.progress.at_share(share);
        }
        let prefix = match telemetry.state {
            StateName::Playing => String::new(),
            other => format!("{}: ", state(other)),
        };
        self.progress.doing(format!("{prefix}{}", self.play));
    }
}

/// Announces a play: its cycles and duration, and how to stop it.
pub(super) fn announcement(cycles: Option<u32>, period_s: f64) -> String {
    cycles.map_or_else(
        || "Playing without end. Ctrl-C stops.".to_owned(),
        |cycles| {
            format!(
                "Playing {cycles} cycles of {period_s} s: {} and the start. Ctrl-C stops.",
                duration(f64::from(cycles) * period_s)
            )
        },
    )
}

/// A duration as people say it: `42.0 s`, `5:02 min`, `1:02:03 h`.
pub(super) fn duration(seconds: f64) -> String {
    if seconds < 59.95 {
        return format!("{seconds:.1} s");
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // positive; saturates
    let whole = seconds.round() as u64;
    let (hours, minutes, seconds) = (whole / 3600, whole / 60 % 60, whole % 60);
    if hours > 0 {
        format!("{hours}:{minutes:02}:{seconds:02} h")
    } else {
        format!("{minutes}:{seconds:02} min")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_is_told_in_cycles_and_time() {
        let play = Playing {
            done: 2.5,
            cycles: Some(10),
            period_s: 30.0,
        };
        assert_eq!(play.to_string(), "cycle 2.50 of 10, 3:45 min to go");
        assert_eq!(play.share(), Some(0.25));
        let endless = Playing {
            cycles: None,
            ..play
        };
        assert_eq!(endless.to_string(), "cycle 2.50, without end");
        assert_eq!((endless.share(), endless.remaining_s()), (None, None));
        assert_eq!(play.so_far(), "played 2.50 of 10 cycles");
        assert_eq!(endless.so_far(), "played 2.50 cycles");
    }

    #[test]
    fn durations_read_well() {
        for (seconds, text) in [
            (0.0, "0.0 s"),
            (59.9, "59.9 s"),
            (59.97, "1:00 min"),
            (302.0, "5:02 min"),
            (3723.4, "1:02:03 h"),
        ] {
            assert_eq!(duration(seconds), text);
        }
    }
}
