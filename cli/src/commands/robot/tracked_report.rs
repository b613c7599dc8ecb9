//! Report of a tracked play: a line per cycle, departures in words, and the motion over all cycles.

use std::fmt;

use experiment::{CycleReport, Departure, MeasuredMotion, TrackedPlay};
use serde::Serialize;

use crate::quantity;

/// Line of the monitor about a play.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct MonitorLine {
    /// Sentence for people.
    pub(crate) text: String,
    /// It names a departure from the prediction, or the reason of a stop.
    pub(crate) warns: bool,
}

/// Lines about the cycles from number `shown` on: one per cycle, and one for each departure that begins with them.
pub(super) fn cycle_lines(reports: &[CycleReport], shown: usize) -> Vec<MonitorLine> {
    let mut lines = Vec::new();
    for (index, report) in reports.iter().enumerate().skip(shown) {
        lines.push(MonitorLine {
            text: cycle_line(report),
            warns: false,
        });
        let Some(departure) = &report.departure else {
            continue;
        };
        let before = index
            .checked_sub(1)
            .and_then(|index| reports.get(index)?.departure.as_ref());
        if before.is_none_or(|before| before.since != departure.since) {
            lines.push(MonitorLine {
                text: in_words(departure),
                warns: true,
            });
        }
    }
    lines
}

fn in_words(departure: &Departure) -> String {
    format!(
        "the robot departs from the prediction since cycle {}: {}",
        departure.since + 1,
        departure.likeness
    )
}

fn cycle_line(report: &CycleReport) -> String {
    let predicted = quantity::length(report.predicted.position().norm());
    let number = report.cycle + 1;
    match &report.measured {
        Some(measured) => format!(
            "cycle {number}: {} ± {}, predicted {predicted}",
            quantity::length(measured.x_m.hypot(measured.y_m)),
            quantity::length(measured.interval_m),
        ),
        None => format!("cycle {number}: an end was not seen, predicted {predicted}"),
    }
}

/// Motion over the cycles that have ended, in the frame of the middle link at the start of the first.
#[derive(Debug, Default, Serialize)]
pub(super) struct TrackedMotion {
    cycles: usize,
    predicted: Option<Predicted>,
    /// `null` if the start of the first cycle or the end of the last was not seen.
    measured: Option<Measured>,
    /// Delay of the cameras beyond the one that they state, as the play shows it; `null` if it does not.
    camera_delay_s: Option<f64>,
    /// Departures from the prediction, in words.
    pub(super) departures: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Predicted {
    x_m: f64,
    y_m: f64,
    rotation_rad: f64,
}

/// Measured motion, with half widths of 95 % intervals.
#[derive(Debug, Serialize)]
struct Measured {
    x_m: f64,
    y_m: f64,
    rotation_rad: f64,
    interval_m: f64,
    interval_rad: f64,
}

impl From<MeasuredMotion> for Measured {
    fn from(motion: MeasuredMotion) -> Self {
        Self {
            x_m: motion.x_m,
            y_m: motion.y_m,
            rotation_rad: motion.turn_rad,
            interval_m: motion.interval_m,
            interval_rad: motion.interval_rad,
        }
    }
}

impl TrackedMotion {
    /// Motion of a play over the cycles that are evaluated.
    pub(super) fn of(play: &TrackedPlay, camera_delay_s: Option<f64>) -> Self {
        let reports = play.reports();
        let mut departures: Vec<&Departure> = Vec::new();
        for departure in reports
            .iter()
            .filter_map(|report| report.departure.as_ref())
        {
            // The last one of a row: its cause is known best.
            match departures.last_mut() {
                Some(last) if last.since == departure.since => *last = departure,
                _ => departures.push(departure),
            }
        }
        let predicted = play.predicted();
        Self {
            cycles: reports.len(),
            predicted: Some(Predicted {
                x_m: predicted.x,
                y_m: predicted.y,
                rotation_rad: predicted.theta,
            }),
            measured: play.measured().map(Measured::from),
            camera_delay_s,
            departures: departures.into_iter().map(in_words).collect(),
        }
    }
}

impl fmt::Display for TrackedMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(predicted) = &self.predicted {
            writeln!(
                f,
                "Predicted over {} cycles: {} (x {}, y {}), turned by {}.",
                self.cycles,
                quantity::length(predicted.x_m.hypot(predicted.y_m)),
                quantity::length(predicted.x_m),
                quantity::length(predicted.y_m),
                quantity::angle(predicted.rotation_rad),
            )?;
        }
        match &self.measured {
            Some(measured) => write!(
                f,
                "Tracked: {} ± {} (x {}, y {}), turned by {} ± {}.",
                quantity::length(measured.x_m.hypot(measured.y_m)),
                quantity::length(measured.interval_m),
                quantity::length(measured.x_m),
                quantity::length(measured.y_m),
                quantity::angle(measured.rotation_rad),
                quantity::angle(measured.interval_rad),
            ),
            None => f.write_str("Tracked: the start or the end was not seen."),
        }
    }
}
