//! The fastest and the farthest gait, each as fast as the servos allow.

use std::time::Duration;

use calibrate::{TrackOptions, predict};
use forecast::shortest_of_table;
use gait_optimizer::SpeedProblem;
use operations::calibrate::{MiddleLink, StatedGait, single};
use serde::Serialize;
use swimmer_files::{AnyGait, Bounds, GaitFile, GaitSpec, SwimmerFile};

use super::{CYCLES, Round};
use crate::arguments::model;
use crate::failure::{Failure, Outcome};
use crate::threads;
use operations::bounds::playable;

/// Both, on the way from the fitted model to the tank.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Race {
    pub(super) fastest: Raced,
    pub(super) farthest: Raced,
    /// Tracked speed of the fastest gait over that of the farthest.
    pub(super) times_as_fast: f64,
}

/// A gait at the servos' full rate.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Raced {
    pub(super) gait: String,
    pub(super) period_s: f64,
    /// |d| over the period: of the gait itself, as the fitted model and the servos make it, and as tracked.
    pub(super) speed_designed_m_per_s: f64,
    pub(super) speed_predicted_m_per_s: f64,
    pub(super) speed_tracked_m_per_s: f64,
}

impl Round<'_> {
    /// Finds the fastest gait with the fitted model, and has it and the farthest swum.
    pub(super) fn race(&mut self, fitted: &SwimmerFile, farthest: &GaitFile) -> Outcome<Race> {
        let rate = self.servo.max_rate;
        let problem = SpeedProblem {
            bounds: playable(Bounds::default(), fitted),
            threads: threads::available(),
            ..SpeedProblem::new(fitted.swimmer, [rate, rate])
        };
        let found = problem.watched(&|_| ())?;
        let fastest = found.gait.gait_file(&fitted.name);
        let fastest = self.raced(fitted, "fastest", &fastest)?;
        let farthest = self.raced(fitted, "farthest-at-full-rate", farthest)?;
        Ok(Race {
            times_as_fast: fastest.speed_tracked_m_per_s / farthest.speed_tracked_m_per_s,
            fastest,
            farthest,
        })
    }

    /// Times a gait for the servos' full rate, uploads it, and has it swum.
    fn raced(&mut self, fitted: &SwimmerFile, name: &str, file: &GaitFile) -> Outcome<Raced> {
        let model = model(fitted)?;
        let (timing, file) = shortest_of_table(&model, file, self.servo.max_rate)?;
        let (place, track) = (
            self.draft.join(format!("{name}.gait")),
            self.draft.join(format!("{name}.csv")),
        );
        file.save(&place)?;
        let gait = AnyGait::from_file(&file).map_err(|error| Failure::tried(&error))?;
        let table = super::table_of(&gait).map_err(|error| Failure::tried(&error))?;
        let info = self.laboratory.upload(&table)?;
        let shortest_s = f64::from(info.min_period_us) / 1e6;
        let period_s = (timing.period.max(shortest_s) * 1e3).ceil() / 1e3;
        self.laboratory
            .swim(CYCLES, Duration::from_secs_f64(period_s), &track)?;
        let designed = swimmer_model::swim(&model, &gait, &swimmer_model::Tolerance::default());
        let predicted = predict(fitted, &gait, period_s).map_err(|error| Failure::tried(&error))?;
        let spec = GaitSpec::File {
            path: place,
            reversed: false,
        };
        let swum = single(
            &track,
            &StatedGait::load(&spec)?,
            period_s,
            fitted,
            &TrackOptions::default(),
            &MiddleLink::default(),
        )?;
        let speed = |x: f64, y: f64| x.hypot(y) / period_s;
        Ok(Raced {
            gait: format!("{name}.gait"),
            period_s,
            speed_designed_m_per_s: designed.displacement.norm() / timing.period,
            speed_predicted_m_per_s: speed(predicted.x_m, predicted.y_m),
            speed_tracked_m_per_s: speed(swum.output.x_m, swum.output.y_m),
        })
    }
}
