//! Check of the period by the heading. A wrong period cuts a run into stretches that look clean, each fitted well by its own
//! harmonics; the result is wrong, with small errors. The heading over the whole run shows it: harmonics of a wrong period leave
//! most of it unexplained, and if the period holds several cycles, only every second or third harmonic is there.

// Indices come from bounded, positive numbers.
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use std::fmt;

use super::clock::{BINS, Bin, PERIOD_HARMONICS, PERIOD_RANGE, harmonic_fit};
use super::curve::{HARMONICS, Harmonics};
use crate::golden::golden;
use crate::median::median;

/// Periodicity of the heading at the stated period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Periodicity {
    /// The stated period \[s\].
    pub period_s: f64,
    /// Share of the heading's swing that harmonics of this period explain.
    pub share: f64,
    /// The period with which it does repeat \[s\], if the search finds one.
    pub found_s: Option<f64>,
}

impl fmt::Display for Periodicity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (period_s, percent) = (self.period_s, 100.0 * self.share);
        match self.found_s {
            Some(found_s) if found_s < period_s && self.share > WELL => write!(
                f,
                "the heading repeats every {found_s:.3} s, {:.0} times in the assumed cycle of {period_s:.3} s",
                period_s / found_s
            )?,
            found => {
                write!(
                    f,
                    "the heading does not repeat every {period_s:.3} s: harmonics of that period explain only {percent:.0} % of it"
                )?;
                if let Some(found_s) = found {
                    write!(f, "; it repeats about every {found_s:.2} s")?;
                }
            }
        }
        f.write_str("; check period_s")
    }
}

/// Result of the check.
pub(super) enum Judgement {
    Fine,
    /// The period is doubtful; the run is used.
    Doubtful(Periodicity),
    /// The period is wrong; cycles of it would be meaningless.
    Hopeless(Periodicity),
}

/// Share of the heading that harmonics explain if it repeats.
const WELL: f64 = 0.9;
/// Share up to which it does not repeat.
const BADLY: f64 = 0.5;
/// Another period counts, rather than chance, if it leaves at most this share of the unexplained part.
const FAR_LESS: f64 = 0.3;
/// Range of the search: periods up to this factor longer or shorter.
const RANGE: f64 = 8.0;
/// Length of the run in periods that the search uses: enough to distinguish periods, few enough to be quick.
const SEARCHED: f64 = 24.0;
/// Least share of the model's swing in harmonics that the measured heading lacks, and largest share of the measured swing in
/// them.
const LACKS: (f64, f64) = (0.5, 0.02);

/// Sums of squares of the heading about its drift, with the part of camera noise.
struct Swing<'a> {
    bins: &'a [Bin],
    total: f64,
    noise: f64,
}

impl<'a> Swing<'a> {
    /// Returns `None` if the heading shows nothing but noise.
    fn of(bins: &'a [Bin], period_s: f64) -> Option<Self> {
        let (_, total) = harmonic_fit(bins, period_s, 0.0, 0)?;
        // Median of a normal variable's size over its deviation, and six variances in a second difference.
        let bends = bins.windows(3).filter_map(|w| match w {
            [a, b, c] if c.time_s - a.time_s < 2.5 * period_s / BINS => {
                Some((a.theta - 2.0 * b.theta + c.theta).abs())
            }
            _ => None,
        });
        let deviation = median(bends).unwrap_or(0.0) / 0.6745 / 6f64.sqrt();
        let noise = deviation.powi(2) * bins.len() as f64;
        (total > 4.0 * noise).then_some(Self { bins, total, noise })
    }

    fn share(&self, period_s: f64) -> f64 {
        let rest = harmonic_fit(self.bins, period_s, 0.0, PERIOD_HARMONICS)
            .map_or(self.total, |(_, rest)| rest);
        1.0 - (rest - self.noise).max(0.0) / (self.total - self.noise)
    }

    /// The shortest period that explains about as much as any, and that share.
    fn best_period(&self, near_s: f64) -> Option<(f64, f64)> {
        let span = self.bins.last()?.time_s - self.bins.first()?.time_s;
        // Three cycles at least: with fewer, harmonics draw any heading that wanders.
        let (highest, lowest) = (RANGE / near_s, (2.9 / span).max(1.0 / RANGE / near_s));
        // The peak of the highest harmonic is 1/(span · harmonics) wide.
        let step = 1.0 / (2.0 * PERIOD_HARMONICS as f64 * span);
        let looks = ((highest - lowest) / step).ceil().max(2.0) as usize;
        let frequency = |i: usize| highest + (lowest - highest) * i as f64 / looks as f64;
        let shares: Vec<f64> = (0..=looks)
            .map(|i| self.share(1.0 / frequency(i)))
            .collect();
        let most = shares.iter().copied().fold(0.0, f64::max);
        let first = shares.iter().position(|share| *share > 0.9 * most)?;
        // Up to the peak, and between its neighbours.
        let climbs = shares.get(first..)?.windows(2);
        let peak = first + climbs.take_while(|w| matches!(w, [a, b] if b > a)).count();
        let ends = [
            frequency(peak.saturating_sub(1)),
            frequency((peak + 1).min(looks)),
        ];
        let (best, unexplained) = golden(ends[1], ends[0], 40, |f| 1.0 - self.share(1.0 / f));
        Some((1.0 / best, 1.0 - unexplained))
    }
}

/// Checks that the heading repeats with the period. If the robot's log states the period and no other period fits clearly, the
/// robot may have been paused.
pub(super) fn judge(bins: &[Bin], period_s: f64, logged: bool) -> Judgement {
    let Some(whole) = Swing::of(bins, period_s) else {
        return Judgement::Fine;
    };
    let share = whole.share(period_s);
    if share > WELL {
        return Judgement::Fine;
    }
    let from = bins.first().map_or(0.0, |bin| bin.time_s);
    let until = bins.partition_point(|bin| bin.time_s < from + SEARCHED * period_s);
    let other = bins
        .get(..until)
        .and_then(|bins| Swing::of(bins, period_s))
        .and_then(|part| part.best_period(period_s))
        .filter(|(found_s, _)| (found_s / period_s - 1.0).abs() > PERIOD_RANGE)
        .filter(|(_, explained)| 1.0 - explained < FAR_LESS * (1.0 - share));
    let repeats = Periodicity {
        period_s,
        share,
        found_s: other.map(|(found_s, _)| found_s),
    };
    match other {
        // Another period fits, or this one does not: what is cut by it are no cycles.
        Some((_, explained)) if explained > WELL && !logged => Judgement::Hopeless(repeats),
        _ if share < BADLY && !logged => Judgement::Hopeless(repeats),
        Some((_, explained)) if explained > WELL || !logged => Judgement::Doubtful(repeats),
        _ => Judgement::Fine,
    }
}

/// Detects a period that holds several cycles of the model: then only multiples of their number are among its harmonics, though
/// the model has others. Returns `None` if it holds one.
pub(super) fn several_times(
    measured: &Harmonics,
    model: &Harmonics,
    period_s: f64,
) -> Option<Periodicity> {
    let between = |harmonics: &Harmonics, times: usize| {
        let energy = |(_, [c, s]): (usize, &[f64; 2])| c * c + s * s;
        let numbered = || (1..).zip(harmonics);
        let total: f64 = numbered().map(energy).sum();
        let others = numbered().filter(|(number, _)| number % times != 0);
        others.map(energy).sum::<f64>() / total
    };
    let lacks =
        |times: &usize| between(model, *times) > LACKS.0 && between(measured, *times) < LACKS.1;
    (2..=HARMONICS).rev().find(lacks).map(|times| Periodicity {
        period_s,
        share: 1.0,
        found_s: Some(period_s / times as f64),
    })
}
