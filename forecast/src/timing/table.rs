//! Timing for the table: what the robot checks is not the curve but the cubics between the 512 knots of its table.
//!
//! Where a gait has a corner a joint's rate jumps, and a cubic through knots on both sides swings beyond both rates, by up to a
//! third. A curve that is timed to keep the limit then makes a table that is refused. So the curve is slowed where its
//! table is too fast, a few knots on either side of each corner, and nowhere else: every stretch of the curve has a floor
//! of its own, raised by as much as the table is too fast there, until the robot's own check allows the table. The floors
//! with nothing poured on them make the shortest period.

#![allow(
    clippy::cast_possible_truncation,
    reason = "limits are single precision on the robot"
)]

use gait_player::table::MAX_KNOTS;
use gait_player::{GaitTable, Limits};
use swimmer_files::{AnyGait, GaitFile};
use swimmer_model::{Gait, Model};

use super::{Curve, Timing, TimingError, check_period, check_rate};

/// Knots on either side of an interval that its cubic rests on.
const BESIDE: f64 = 2.0;
/// Most rounds of raising floors.
const ROUNDS: usize = 100;
/// Floors are raised until the table keeps within the limit by this share, which rounding may take.
const SPARE: f64 = 1e-5;

/// The best timing of a gait for the table of 512 knots that the robot makes of it: [`super::timing()`], slower beside
/// corners. Also the file with this timing, which makes the table. [`Timing::shortest_period`] is the table's.
///
/// A gait that no table holds (beyond 3.2767 rad) is timed as a curve; the robot refuses it in any case.
///
/// # Errors
/// As [`super::timing()`].
pub fn timing_of_table(
    model: &Model<f64>,
    file: &GaitFile,
    period: f64,
    max_rate: f64,
) -> Result<(Timing, GaitFile), TimingError> {
    check_rate(max_rate)?;
    check_period(period)?;
    let limits = Limits {
        max_rate: max_rate as f32,
        ..Limits::ROBOT
    };
    let asked = Asked { file, limits };
    let mut tightest = Curve::new(model, &AnyGait::from_file(file)?)?;
    let fastest = asked.allowed(&mut tightest, None)?;
    let shortest = fastest.period;
    if period < shortest {
        return Err(TimingError::TooFast {
            period,
            rate: max_rate,
            shortest,
        });
    }
    let mut curve = Curve::new(model, &AnyGait::from_file(file)?)?;
    let timing = match asked.allowed(&mut curve, Some(period)) {
        Ok(timing) => timing,
        // Next to the shortest period: the same, a little slower everywhere.
        Err(TimingError::TooFast { .. }) => fastest.stretched(period),
        Err(other) => return Err(other),
    };
    let timing = Timing {
        shortest_period: shortest,
        ..timing
    };
    let file = timing.retime_file(file);
    Ok((timing, file))
}

/// What is asked of a timing.
struct Asked<'a> {
    file: &'a GaitFile,
    limits: Limits,
}

impl Asked<'_> {
    /// The timing with this period (the shortest for none) whose table is allowed; raises the curve's floors for it.
    fn allowed(&self, curve: &mut Curve, period: Option<f64>) -> Result<Timing, TimingError> {
        let max_rate = f64::from(self.limits.max_rate);
        let mut timing = None;
        for _ in 0..ROUNDS {
            let shortest = curve.shortest(max_rate);
            let period = period.unwrap_or(shortest);
            if period < shortest {
                return Err(TimingError::TooFast {
                    period,
                    rate: max_rate,
                    shortest,
                });
            }
            let now = curve.timing(period, max_rate);
            let retimed = AnyGait::from_file(&now.retime_file(self.file))?;
            let Ok(table) = GaitTable::from_fn(MAX_KNOTS, |u| retimed.at(u).phi.into()) else {
                return Ok(now);
            };
            if !curve.raise(&now, &table, &self.limits) {
                return Ok(now);
            }
            timing = Some(now);
        }
        // Not reached: floors rise until all is slow enough. What is left over is spread evenly.
        let timing = timing.ok_or(TimingError::Still)?;
        let needed = self.needed(&timing)?;
        match period {
            Some(period) if needed > period => Err(TimingError::TooFast {
                period,
                rate: max_rate,
                shortest: needed,
            }),
            _ => Ok(timing.stretched(needed)),
        }
    }

    /// The period that the robot asks for the table of a timing, at least its own \[s\].
    fn needed(&self, timing: &Timing) -> Result<f64, TimingError> {
        let retimed = AnyGait::from_file(&timing.retime_file(self.file))?;
        let table = GaitTable::from_fn(MAX_KNOTS, |u| retimed.at(u).phi.into());
        Ok(table.map_or(timing.period, |table| {
            let of = |interval| f64::from(table.interval_period(interval, &self.limits));
            let all = (0..table.knots()).map(of);
            all.fold(timing.period, f64::max) * (1.0 + SPARE)
        }))
    }
}

impl Curve {
    /// Raises the floors where a table is too fast for its period; whether it is anywhere. By half of what is missing, since
    /// neighbours that are raised as well help.
    fn raise(&mut self, timing: &Timing, table: &GaitTable, limits: &Limits) -> bool {
        let knots = table.knots() as f64;
        let k = timing.pour;
        let max_rate = f64::from(limits.max_rate);
        let mut raised = false;
        let mut factors = vec![1.0_f64; self.cells.len()];
        for interval in 0..table.knots() {
            let too_fast = f64::from(table.interval_period(interval, limits)) / timing.period;
            if too_fast <= 1.0 - SPARE {
                continue;
            }
            raised = raised || too_fast > 1.0 - 0.5 * SPARE;
            let middle = (interval as f64 + 0.5) / knots;
            let reach = (BESIDE + 0.5) / knots;
            let ends = timing.cells.iter().zip(timing.cells.iter().skip(1));
            for (factor, (from, to)) in factors.iter_mut().zip(ends) {
                let at = 0.5 * (from.time + to.time) / timing.period;
                let off = (at - middle).abs();
                if off.min(1.0 - off) < reach {
                    *factor = factor.max((too_fast / (1.0 - SPARE)).sqrt());
                }
            }
        }
        if raised {
            for (samples, factor) in self.samples.iter_mut().zip(factors) {
                for sample in samples.iter_mut().filter(|_| factor > 1.0) {
                    // A floor below what is poured would change nothing.
                    let poured = k * sample.power_root * max_rate;
                    sample.floor = sample.floor.max(poured) * factor;
                }
            }
        }
        raised
    }
}

impl Timing {
    /// The same with a longer period, slower by the same share everywhere.
    fn stretched(mut self, period: f64) -> Self {
        let by = period / self.period;
        self.period = period;
        self.energy /= by;
        self.power /= by * by;
        self.rate_at_constant_power /= by;
        self.at_limit = if by > 1.0 { 0.0 } else { self.at_limit };
        for cell in &mut self.cells {
            cell.time *= by;
            cell.power /= by * by;
        }
        self
    }
}

#[cfg(test)]
mod tests;
