//! What the rows were like.

use crate::tracks::TrackWarning;

/// What is worth a warning at the end.
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

    pub(super) fn tell(
        &self,
        rate_hz: Option<f64>,
        threshold: f64,
        warnings: &mut Vec<TrackWarning>,
    ) {
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
                warnings.push(TrackWarning::TimeColumn {
                    header_hz: rate_hz,
                    column_hz: frames / time,
                });
            }
        }
    }
}
