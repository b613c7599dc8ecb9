//! Timing of the table: the robot checks not the curve but the cubics between the 512 knots of its table ([`crate::table()`]).
//!
//! They may be slightly faster than the curve, by the rounding of their knots and near corners. If so, the fastest timing is
//! stretched accordingly; any other timing is changed only if its table is too fast.

#![allow(
    clippy::cast_possible_truncation,
    reason = "limits are single precision on the robot"
)]

use gait_player::Limits;
use gait_player::table::MAX_KNOTS;
use swimmer_files::{AnyGait, GaitFile};
use swimmer_model::Model;

use super::{Curve, Timing, TimingError, check_period, check_rate};

/// A table shall be allowed with this share to spare, which rounding may take.
const SPARE: f64 = 1e-5;

/// The best timing of a gait for the table of 512 knots that the robot is given of it. Also the file with this timing, which
/// makes the table. [`Timing::shortest_period`] is the table's.
///
/// A gait that no table holds (beyond 3.2767 rad) is timed as a curve; the robot refuses it in any case.
///
/// # Errors
/// [`TimingError`]; a period that is too short comes with the shortest one.
///
/// ```
/// use forecast::timing_of_table;
/// use swimmer_files::{AnyGait, GaitFile};
/// use swimmer_model::{Model, Swimmer};
///
/// let model = Model::new(&Swimmer::<f64>::robot()).unwrap();
/// let file = GaitFile::sampled(&AnyGait::circle(1.2), 200);
/// let (timing, timed) = timing_of_table(&model, &file, 10.0, 3.5).unwrap();
/// assert!(timing.shortest_period < 10.0 && timed.u.last() == Some(&1.0));
/// ```
pub fn timing_of_table(
    model: &Model<f64>,
    file: &GaitFile,
    period: f64,
    max_rate: f64,
) -> Result<(Timing, GaitFile), TimingError> {
    check_period(period)?;
    let (curve, fastest) = shortest(model, file, max_rate)?;
    let shortest = fastest.period;
    if period < shortest {
        return Err(TimingError::TooFast {
            period,
            rate: max_rate,
            shortest,
        });
    }
    let mut timing = curve.timing(period, max_rate);
    if needed(&timing, file, max_rate)? > period {
        timing = curve.stretched(period, max_rate);
    }
    timing.shortest_period = shortest;
    let file = timing.retime_file(file);
    Ok((timing, file))
}

/// A gait as fast as its table can run: its timing, with the file that makes the table.
///
/// # Errors
/// As [`timing_of_table`].
///
/// ```
/// use forecast::{shortest_of_table, timing_of_table};
/// use swimmer_files::{AnyGait, GaitFile};
/// use swimmer_model::{Model, Swimmer};
///
/// let model = Model::new(&Swimmer::<f64>::robot()).unwrap();
/// let file = GaitFile::sampled(&AnyGait::circle(1.2), 200);
/// let (quickest, _) = shortest_of_table(&model, &file, 3.5).unwrap();
/// assert!(timing_of_table(&model, &file, 0.9 * quickest.period, 3.5).is_err());
/// ```
pub fn shortest_of_table(
    model: &Model<f64>,
    file: &GaitFile,
    max_rate: f64,
) -> Result<(Timing, GaitFile), TimingError> {
    let (_, timing) = shortest(model, file, max_rate)?;
    let file = timing.retime_file(file);
    Ok((timing, file))
}

fn shortest(
    model: &Model<f64>,
    file: &GaitFile,
    max_rate: f64,
) -> Result<(Curve, Timing), TimingError> {
    check_rate(max_rate)?;
    let curve = Curve::new(model, &AnyGait::from_file(file)?)?;
    let fastest = curve.timing(curve.shortest(max_rate), max_rate);
    let period = needed(&fastest, file, max_rate)?;
    let timing = Timing {
        shortest_period: period,
        ..curve.stretched(period, max_rate)
    };
    Ok((curve, timing))
}

/// Shortest period that the robot allows for the table of a timing, at least the timing's own \[s\].
fn needed(timing: &Timing, file: &GaitFile, max_rate: f64) -> Result<f64, TimingError> {
    let limits = Limits {
        max_rate: max_rate as f32,
        ..Limits::ROBOT
    };
    let retimed = AnyGait::from_file(&timing.retime_file(file))?;
    let Ok(table) = crate::table(&retimed, MAX_KNOTS) else {
        return Ok(timing.period);
    };
    let of = |interval| f64::from(table.interval_period(interval, &limits)) * (1.0 + SPARE);
    Ok((0..table.knots()).map(of).fold(timing.period, f64::max))
}

#[cfg(test)]
mod tests;
