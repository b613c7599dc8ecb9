//! When the rows were. Steps from row to row are counted in bins, so that the rate comes out of any length of file in the same
//! few kilobytes; the times themselves are kept only where places are.
//!
//! Programs round times: 30 Hz in milliseconds are steps of 33 and 34, in hundredths of a second 30 and 40, and their median is
//! 33.33 Hz. Where all steps are those of an even clock to a unit of the last digit, the rows are counted over their span.

use std::collections::HashMap;

use super::TrackWarning;
use super::grid::ColumnClock;

/// Digits after the decimal sign from which on rounding does not matter.
const FINE: usize = 4;
/// Steps that differ by less than this share are even.
const EVEN: f64 = 0.01;
/// Rates that differ by less than this share are the same.
const SAME_RATE: f64 = 1e-4;

/// Steps of about the same length.
#[derive(Debug, Clone, Copy)]
struct Bin {
    count: usize,
    sum: f64,
    shortest: f64,
    longest: f64,
}

impl Bin {
    fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }
}

/// The rows' numbers and times, one row after another.
#[derive(Debug, Default)]
pub(super) struct Timeline {
    keeps: bool,
    rows: usize,
    first: (u64, f64),
    last: (u64, f64),
    /// By the leading bits of the step: a thousandth of it.
    bins: HashMap<u32, Bin>,
    /// The most digits that any stamp had; `None` where times are no stamps.
    decimals: Option<usize>,
    /// Seconds of a stamp's unit.
    seconds: f64,
    /// The first line whose stamp repeats the one before, and that stamp.
    repeated: Option<(usize, f64)>,
    /// Frame numbers that did not grow, and the first line with one.
    renumbered: Option<(usize, usize)>,
    frames: Vec<u64>,
    times: Vec<f64>,
}

/// Timing of the rows.
#[derive(Debug)]
pub(super) struct Timing {
    pub(super) rate_hz: f64,
    pub(super) rows: usize,
    /// Frame numbers of all rows, if they are kept; otherwise empty.
    pub(super) frames: Vec<u64>,
    pub(super) times: Vec<f64>,
    pub(super) warnings: Vec<TrackWarning>,
}

/// Stamps that repeat without being rounded: where, and which.
#[derive(Debug, PartialEq)]
pub(super) struct Repeated {
    pub(super) line: usize,
    pub(super) time: f64,
}

/// An even clock behind the stamps.
struct Pace {
    rate_hz: f64,
    /// Unit to which the stamps were rounded \[s\], if that shows.
    unit_s: Option<f64>,
    /// Every row is one step on, whatever its stamp says.
    by_rows: bool,
}

impl Timeline {
    /// With `keeps` the times of all rows are kept, otherwise only those needed at the end.
    pub(super) fn new(keeps: bool) -> Self {
        Self {
            keeps,
            seconds: 1.0,
            ..Self::default()
        }
    }

    /// The same way of keeping and writing, without any row yet.
    pub(super) fn emptied(&self) -> Self {
        Self {
            decimals: self.decimals,
            ..Self::new(self.keeps)
        }
    }

    pub(super) fn len(&self) -> usize {
        self.rows
    }

    /// Frame number and time of the row before.
    pub(super) fn last(&self) -> Option<(u64, f64)> {
        (self.rows > 0).then_some(self.last)
    }

    /// Notes the number of digits of a stamp, in a unit of this many seconds.
    pub(super) fn written(&mut self, text: &str, seconds: f64) {
        let digits = text.trim().split_once(['.', ',']).map_or("", |cut| cut.1);
        let plain = digits.bytes().all(|b| b.is_ascii_digit());
        let count = if plain { digits.len() } else { FINE };
        self.decimals = Some(self.decimals.unwrap_or(0).max(count));
        self.seconds = seconds;
    }

    /// Returns `true` if equal stamps may be rounded ones.
    pub(super) fn may_repeat(&self) -> bool {
        self.decimals.is_some_and(|decimals| decimals < FINE)
    }

    /// This line's stamp repeats the one before.
    pub(super) fn repeats(&mut self, line: usize) {
        self.repeated.get_or_insert((line, self.last.1));
    }

    /// This line's frame number did not grow, though its time did.
    pub(super) fn renumbered(&mut self, line: usize) {
        self.renumbered.get_or_insert((0, line)).0 += 1;
    }

    pub(super) fn push(&mut self, frame: u64, time: f64) {
        if self.rows == 0 {
            self.first = (frame, time);
        } else {
            self.step(time - self.last.1);
        }
        self.last = (frame, time);
        self.rows += 1;
        if self.keeps {
            self.frames.push(frame);
            self.times.push(time);
        }
    }

    /// Puts the kept times on this clock.
    pub(super) fn follow(&mut self, clock: &ColumnClock) {
        for (time, frame) in self.times.iter_mut().zip(&self.frames) {
            *time = clock.time_s + (*frame as f64 - clock.frame as f64) / clock.rate_hz;
        }
    }

    fn step(&mut self, step: f64) {
        // Sign, exponent and ten bits of the mantissa.
        #[allow(clippy::cast_possible_truncation)]
        let key = (step.to_bits() >> 42) as u32;
        let bin = self.bins.entry(key).or_insert(Bin {
            count: 0,
            sum: 0.0,
            shortest: step,
            longest: step,
        });
        bin.count += 1;
        bin.sum += step;
        bin.shortest = bin.shortest.min(step);
        bin.longest = bin.longest.max(step);
    }

    /// The middle one of the steps.
    fn median(&self) -> Option<f64> {
        let mut keys: Vec<&u32> = self.bins.keys().collect();
        keys.sort_unstable();
        let mut left = self.rows.checked_sub(1)? / 2;
        for key in keys {
            let bin = self.bins.get(key)?;
            if left < bin.count {
                return Some(bin.mean());
            }
            left -= bin.count;
        }
        None
    }

    fn extremes(&self) -> (f64, f64) {
        self.bins
            .values()
            .fold((f64::INFINITY, 0.0), |(least, most), bin| {
                (bin.shortest.min(least), bin.longest.max(most))
            })
    }

    /// Returns `true` if all steps are whole multiples of the usual one, which is the shortest, and few are longer: rows are missing
    /// on a clock whose times are written exactly. (Ninety hertz in hundredths of a second look the same.)
    fn only_misses_rows(&self, median: f64, shortest: f64) -> bool {
        let whole = |bin: &Bin| {
            let times = bin.mean() / median;
            (times - times.round()).abs() < 1e-6 * times
        };
        let longer = self.bins.values().filter(|bin| bin.mean() > 1.5 * median);
        let longer: usize = longer.map(|bin| bin.count).sum();
        shortest > 0.999 * median && self.bins.values().all(whole) && 5 * longer < self.rows
    }

    fn pace(&self) -> Option<Pace> {
        let median = self.median()?;
        let span = self.last.1 - self.first.1;
        let (shortest, longest) = self.extremes();
        let unit_s = self
            .decimals
            .filter(|decimals| *decimals < FINE)
            .and_then(|decimals| Some(self.seconds * 0.1_f64.powi(i32::try_from(decimals).ok()?)));
        let uneven = longest - shortest > 1e-6 * median;
        let rounded = uneven && span > 0.0 && !self.only_misses_rows(median, shortest);
        if let Some(unit) = unit_s.filter(|_| rounded) {
            let rate_hz = (self.rows - 1) as f64 / span;
            let near = |step: f64| (step - 1.0 / rate_hz).abs() < 1.001 * unit;
            if near(shortest) && near(longest) {
                return Some(Pace {
                    rate_hz,
                    unit_s,
                    by_rows: true,
                });
            }
        }
        // Rows are missing: what is near the median is one step.
        let reach = unit_s.map_or(EVEN * median, |unit| 1.001 * unit);
        let usual = self
            .bins
            .values()
            .filter(|bin| (bin.mean() - median).abs() < reach);
        let (sum, count) = usual.fold((0.0, 0), |(sum, count), bin| {
            (sum + bin.sum, count + bin.count)
        });
        let step = if count > 0 {
            sum / count as f64
        } else {
            median
        };
        let steps = |bin: &Bin| (bin.mean() / step).round().max(1.0);
        let total: f64 = self
            .bins
            .values()
            .map(|bin| bin.count as f64 * steps(bin))
            .sum();
        let rate_hz = total / span;
        if !(rate_hz.is_finite() && (rate_hz * median - 1.0).abs() < 0.5) {
            return (median > 0.0).then_some(Pace {
                rate_hz: 1.0 / median,
                unit_s: None,
                by_rows: false,
            });
        }
        let rounded = |unit: &f64| {
            let near = |bin: &Bin| {
                let even = steps(bin) / rate_hz;
                (bin.shortest - even).abs() < 1.001 * unit
                    && (bin.longest - even).abs() < 1.001 * unit
            };
            // One kind of step and its multiples are even as they stand.
            let uneven = |bin: &Bin| (bin.mean() - steps(bin) / rate_hz).abs() > 1e-3 / rate_hz;
            self.bins.values().all(near) && self.bins.values().any(uneven)
        };
        Some(Pace {
            rate_hz,
            unit_s: unit_s.filter(rounded),
            by_rows: false,
        })
    }

    /// The rate: `header`'s, else by the frame numbers where rows are `numbered`, else by the stamps; `given` by the user, it
    /// wins over stamps (over a header it won before).
    ///
    /// # Errors
    /// [`Repeated`] stamps that no rounding explains.
    pub(super) fn finish(
        mut self,
        header: Option<f64>,
        given: Option<f64>,
        numbered: bool,
    ) -> Result<Timing, Repeated> {
        let mut warnings = Vec::new();
        let pace = self.pace();
        if let Some((line, time)) = self.repeated
            && !pace
                .as_ref()
                .is_some_and(|pace| pace.by_rows && pace.unit_s.is_some())
        {
            return Err(Repeated { line, time });
        }
        if let Some((count, first_line)) = self.renumbered {
            warnings.push(TrackWarning::Renumbered { count, first_line });
        }
        let rate_hz = match (header, pace) {
            (Some(rate), _) => rate,
            (None, None) => given.unwrap_or(0.0),
            (None, Some(pace)) => self.by_stamps(&pace, given, numbered, &mut warnings),
        };
        Ok(Timing {
            rate_hz,
            rows: self.rows,
            frames: self.frames,
            times: self.times,
            warnings,
        })
    }

    fn by_stamps(
        &mut self,
        pace: &Pace,
        given: Option<f64>,
        numbered: bool,
        warnings: &mut Vec<TrackWarning>,
    ) -> f64 {
        let own = self
            .by_frames()
            .filter(|_| numbered)
            .unwrap_or(pace.rate_hz);
        if let Some(used_hz) = given {
            if (used_hz / own - 1.0).abs() > SAME_RATE {
                let file_hz = own;
                warnings.push(TrackWarning::RateOverridden { file_hz, used_hz });
            }
            self.lay_out(pace, used_hz);
            return used_hz;
        }
        if let Some(unit_s) = pace.unit_s {
            let rate_hz = pace.rate_hz;
            warnings.push(TrackWarning::RoundedTimes { unit_s, rate_hz });
            self.lay_out(pace, rate_hz);
            return rate_hz;
        }
        let (shortest, longest) = self.extremes();
        if longest - shortest > EVEN * self.median().unwrap_or(0.0) {
            warnings.push(TrackWarning::UnevenTimes { shortest, longest });
        }
        own
    }

    /// Frames over time between the first and the last row.
    fn by_frames(&self) -> Option<f64> {
        let frames = self.last.0.checked_sub(self.first.0)?;
        let span = self.last.1 - self.first.1;
        (self.renumbered.is_none() && span > 0.0 && frames > 0).then(|| frames as f64 / span)
    }

    /// Puts the kept times on an even clock, as near to their stamps as it can be.
    fn lay_out(&mut self, pace: &Pace, rate_hz: f64) {
        let Some(first) = self.times.first().copied() else {
            return;
        };
        let mut count = 0.0;
        let mut before = first;
        let mut counts = Vec::with_capacity(self.times.len());
        for time in &self.times {
            if !counts.is_empty() {
                let steps = ((time - before) * pace.rate_hz).round().max(1.0);
                count += if pace.by_rows { 1.0 } else { steps };
            }
            before = *time;
            counts.push(count);
        }
        // In the stamps' own seconds: a clock that runs wrongly does so from its zero on.
        let late = self.times.iter().zip(&counts);
        let late = late
            .map(|(time, count)| time - count / pace.rate_hz)
            .sum::<f64>();
        let zero = late / counts.len() as f64 * pace.rate_hz / rate_hz;
        let zero = if pace.unit_s.is_some() {
            zero
        } else {
            first * pace.rate_hz / rate_hz
        };
        for (time, count) in self.times.iter_mut().zip(counts) {
            *time = zero + count / rate_hz;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The timing of stamps at a rate, written with this number of digits; `seen` lists the frames that are there.
    fn rounded(rate_hz: f64, digits: usize, seen: impl Fn(usize) -> bool) -> Timing {
        let mut timeline = Timeline::new(true);
        for frame in (0..2000).filter(|frame| seen(*frame)) {
            let text = format!("{:.digits$}", frame as f64 / rate_hz);
            timeline.written(&text, 1.0);
            let time: f64 = text.parse().unwrap();
            if timeline.last().is_some_and(|(_, last)| time <= last) {
                timeline.repeats(frame);
            }
            timeline.push(frame as u64, time);
        }
        timeline.finish(None, None, false).unwrap()
    }

    #[test]
    fn rounded_times_give_the_count_over_the_span() {
        for (rate_hz, digits) in [
            (30.0, 3),
            (30.0, 2),
            (59.94, 2),
            (70.0, 2),
            (120.0, 2),
            (240.0, 3),
        ] {
            let timing = rounded(rate_hz, digits, |_| true);
            assert!(
                (timing.rate_hz / rate_hz - 1.0).abs() < 1e-3,
                "{rate_hz}: {}",
                timing.rate_hz
            );
            assert!(
                matches!(timing.warnings[..], [TrackWarning::RoundedTimes { .. }]),
                "{rate_hz}: {:?}",
                timing.warnings
            );
            for (frame, time) in timing.times.iter().enumerate() {
                let unit = [1.0, 0.1, 0.01, 0.001][digits];
                assert!(
                    (time - frame as f64 / rate_hz).abs() < unit,
                    "{rate_hz}, frame {frame}"
                );
            }
        }
    }

    #[test]
    fn rows_that_are_missing_are_no_slower_clock() {
        let timing = rounded(30.0, 3, |frame| frame % 100 > 6);
        assert!((timing.rate_hz - 30.0).abs() < 0.03, "{}", timing.rate_hz);
        let last = timing.times.last().unwrap();
        assert!((last - 1999.0 / 30.0).abs() < 2e-3, "{last}");
    }

    #[test]
    fn even_times_are_left_alone() {
        let timing = rounded(100.0, 2, |frame| frame != 7);
        assert!((timing.rate_hz - 100.0).abs() < 1e-9, "{}", timing.rate_hz);
        assert!((timing.times[7] - 0.08).abs() < 1e-15);
    }

    #[test]
    fn repeated_times_that_no_rounding_explains() {
        let mut timeline = Timeline::new(false);
        for (line, text) in ["0.00", "0.10", "0.10", "0.20", "0.30"].iter().enumerate() {
            timeline.written(text, 1.0);
            if line == 2 {
                timeline.repeats(line);
            }
            timeline.push(line as u64, text.parse().unwrap());
        }
        let error = timeline.finish(None, None, false).unwrap_err();
        assert_eq!(error.line, 2);
    }
}
