//! Irregularities of the rows.

use crate::tracks::TrackWarning;

/// A header's rate is wrong if it differs by more than this share from the time column's; clocks differ by far less.
const CONTRADICTS: f64 = 0.01;

/// The clock of a time column: a frame, its time, and frames a second.
#[derive(Debug, Clone, Copy)]
pub(in crate::tracks) struct ColumnClock {
    pub(in crate::tracks) frame: u64,
    pub(in crate::tracks) time_s: f64,
    pub(in crate::tracks) rate_hz: f64,
}

/// Irregularities that give a warning at the end.
#[derive(Default)]
pub(super) struct Notes {
    jumps: usize,
    skipped: u64,
    half_blank: Option<(usize, usize)>,
    pub(super) unlikely: usize,
    first_time: Option<(u64, f64)>,
    last_time: Option<(u64, f64)>,
}

impl Notes {
    pub(super) fn jumped(&mut self, skipped: u64) {
        self.jumps += usize::from(skipped > 0);
        self.skipped = self.skipped.saturating_add(skipped);
    }

    pub(super) fn half_blank(&mut self, line: usize) {
        self.half_blank.get_or_insert((0, line)).0 += 1;
    }

    /// The row's before in the time column.
    pub(super) fn last_stamp(&self) -> Option<f64> {
        self.last_time.map(|(_, time)| time)
    }

    pub(super) fn time(&mut self, frame: u64, time: f64) {
        self.first_time.get_or_insert((frame, time));
        self.last_time = Some((frame, time));
    }

    /// Adds the warnings. Returns the clock of the time column if it contradicts the header's rate by so much that the header is
    /// wrong.
    pub(super) fn tell(
        &self,
        rate_hz: Option<f64>,
        threshold: f64,
        warnings: &mut Vec<TrackWarning>,
    ) -> Option<ColumnClock> {
        if self.jumps > 0 {
            warnings.push(TrackWarning::FrameJumps {
                jumps: self.jumps,
                frames: self.skipped,
            });
        }
        if let Some((count, first_line)) = self.half_blank {
            warnings.push(TrackWarning::HalfBlank { count, first_line });
        }
        if self.unlikely > 0 {
            warnings.push(TrackWarning::Unlikely {
                count: self.unlikely,
                threshold,
            });
        }
        if let (Some((f0, t0)), Some((f1, t1)), Some(rate_hz)) =
            (self.first_time, self.last_time, rate_hz)
        {
            let (frames, time) = (f1.saturating_sub(f0) as f64, t1 - t0);
            // Two rounded times may be a unit of their last digit off, whatever the span.
            if f1 > f0 && (time - frames / rate_hz).abs() > 1e-3 * (1.0 + frames / rate_hz) {
                let column_hz = frames / time;
                let column_used = time > 0.0 && (column_hz / rate_hz - 1.0).abs() > CONTRADICTS;
                warnings.push(TrackWarning::TimeColumn {
                    header_hz: rate_hz,
                    column_hz,
                    column_used,
                });
                return column_used.then_some(ColumnClock {
                    frame: f0,
                    time_s: t0,
                    rate_hz: column_hz,
                });
            }
        }
        None
    }
}
