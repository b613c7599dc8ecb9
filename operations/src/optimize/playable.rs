//! Searches within the robot's angle and clearance until the gait keeps them as it is played.
//!
//! A robot plays a table of 512 knots by servos with a dead band, so its joints cut the corners of a gait that runs along a bound.
//! The clearance is measured along that path. If it is below the robot's margin, the search is repeated with more.

use forecast::{Forecast, forecast};
use gait_optimizer::OptimalGait;
use swimmer_files::{AnyGait, Bounds, SwimmerFile};
use swimmer_model::Model;

use crate::robot_limits::{PERIOD_S, played};
use crate::{Error, model};

/// Largest number of searches.
const MOST_SEARCHES: usize = 5;
/// Addition to the clearance, over the missing clearance.
const BEYOND: f64 = 1.1;

/// Searches within bounds. If the gait must be playable, searches again with more clearance as long as the result comes too close
/// as it is played.
///
/// # Errors
/// Those of the search; a failure if the robot refuses every gait.
pub fn searched<T>(
    file: &SwimmerFile,
    is_playable: bool,
    mut bounds: Bounds,
    gait_of: impl Fn(&T) -> &OptimalGait,
    mut search: impl FnMut(Bounds) -> Result<T, Error>,
) -> Result<T, Error> {
    if !is_playable {
        return search(bounds);
    }
    let model = model(file)?;
    let mut reason = String::new();
    for _ in 0..MOST_SEARCHES {
        let found = search(bounds)?;
        let gait = gait_of(&found).gait_file(&file.name);
        let curve = AnyGait::from_file(&gait).map_err(|error| Error::failed(&error))?;
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
    Err(Error::unsuccessful(format!(
        "no gait found within these bounds is playable: {reason}; give a smaller --max-angle or a larger --clearance"
    )))
}

/// A gait as the robot plays it: in [`PERIOD_S`], or in the shortest period that its servos allow if that is longer.
fn as_played(file: &SwimmerFile, model: &Model<f64>, gait: &AnyGait) -> Result<Forecast, Error> {
    let at = |period| forecast(model, gait, &played(file.servo.unwrap_or_default(), period));
    let first = at(PERIOD_S)?;
    let shortest = first.verdict.min_period;
    if shortest > PERIOD_S {
        Ok(at((shortest * 1e3).ceil() / 1e3)?)
    } else {
        Ok(first)
    }
}
