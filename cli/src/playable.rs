//! `--playable`: searches within the robot's angle and clearance until the gait keeps them as it is played.
//!
//! A robot plays a table of 512 knots by servos with a dead band, so its joints cut the corners of a gait that runs along a bound.
//! The clearance is measured along that path. If it is below the robot's margin, the search is repeated with more.

use forecast::{Forecast, Played, Servos, forecast};
use gait_optimizer::OptimalGait;
use link_protocol::MAX_KNOTS;
use swimmer_files::{AnyGait, Bounds, SwimmerFile};
use swimmer_model::Model;

use crate::arguments::model;
use crate::failure::{Failure, Outcome};
use crate::own_robot::PERIOD_S;

/// Most searches.
const MOST_SEARCHES: usize = 5;
/// Addition to the clearance, over the missing clearance.
const BEYOND: f64 = 1.1;

/// Searches within bounds. If the gait shall be playable, searches again with more clearance as long as what was found comes too
/// close as it is played.
///
/// # Errors
/// Those of the search, and [`Failure::Tried`] if the robot refuses every gait.
pub(crate) fn searched<T>(
    (file, is_playable): (&SwimmerFile, bool),
    mut bounds: Bounds,
    gait_of: impl Fn(&T) -> &OptimalGait,
    mut search: impl FnMut(Bounds) -> Outcome<T>,
) -> Outcome<T> {
    if !is_playable {
        return search(bounds);
    }
    let model = model(file)?;
    let mut reason = String::new();
    for _ in 0..MOST_SEARCHES {
        let found = search(bounds)?;
        let gait = gait_of(&found).gait_file(&file.name);
        let curve = AnyGait::from_file(&gait).map_err(|error| Failure::tried(&error))?;
        let forecast = as_played(file, &model, &curve)?;
        let Some(refusal) = forecast.refusal() else {
            return Ok(found);
        };
        let missing = forecast.margin - forecast.gap.distance;
        reason = refusal;
        if missing <= 0.0 {
            break;
        }
        bounds.clearance += BEYOND * missing;
    }
    Err(Failure::Tried(format!(
        "no gait found within these bounds is playable: {reason}; give a smaller --max-angle or a larger --clearance"
    )))
}

/// A gait as the robot plays it: in [`PERIOD_S`], or in the shortest period that its servos allow if that is longer.
fn as_played(file: &SwimmerFile, model: &Model<f64>, gait: &AnyGait) -> Outcome<Forecast> {
    let at = |period| {
        let played = Played {
            servos: Servos::on_the_robot(file.servo.unwrap_or_default()),
            period,
            knots: MAX_KNOTS,
        };
        forecast(model, gait, &played).map_err(Failure::from)
    };
    let first = at(PERIOD_S)?;
    let shortest = first.verdict.min_period;
    if shortest > PERIOD_S {
        at((shortest * 1e3).ceil() / 1e3)
    } else {
        Ok(first)
    }
}
