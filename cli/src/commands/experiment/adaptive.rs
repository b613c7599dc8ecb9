//! Adaptive campaign: tracks are measured as `swimmer calibrate` does, and the next trial is chosen by its information.

use std::fmt::Write as _;

use calibrate::{CalibrateError, RunData, Statistics, Timing, calibrate_run, load_tracks};
use experiment::adaptive::{
    CampaignAdvice, CampaignGoal, Candidate, Decision, NextTrial, Response, StartParameters, advise,
};
use experiment::unattended::{Entry, Journal, TrialQuantities};
use swimmer_files::Reflectors;

use super::folder::{Folder, JournalFile};
use crate::commands::robot::Tracked;
use crate::failure::{Failure, Outcome};
use crate::quantity;

/// Adaptive campaign of a folder.
pub(super) struct Campaign {
    candidates: Vec<Candidate>,
    start: StartParameters,
    goal: CampaignGoal,
}

impl Campaign {
    /// Campaign of a folder; `None` if its plan is not adaptive.
    ///
    /// # Errors
    /// A gait that cannot be read or predicted.
    pub(super) fn of(folder: &Folder) -> Outcome<Option<Self>> {
        let plan = &folder.plan;
        let Some(adaptive) = &plan.adaptive else {
            return Ok(None);
        };
        let candidates = plan.gaits.iter().map(|gait| {
            let curve = folder.curve(gait)?;
            let response = Response::of(&folder.swimmer, &curve, gait.period_s);
            Ok(Candidate {
                name: gait.name.clone(),
                seconds: plan.settle_s + f64::from(plan.run_in + gait.cycles) * gait.period_s,
                response: response.map_err(|error| Failure::tried(&error))?,
            })
        });
        let swimmer = &folder.swimmer.swimmer;
        Ok(Some(Self {
            candidates: candidates.collect::<Outcome<_>>()?,
            start: StartParameters {
                chi: swimmer.chi,
                sphere_radius_m: swimmer.sphere_radius,
            },
            goal: adaptive.goal(plan.level),
        }))
    }

    /// Fit of the trials so far, and the next one.
    ///
    /// # Errors
    /// A plan without gaits.
    pub(super) fn advice(&self, folder: &Folder, journal: &Journal) -> Outcome<CampaignAdvice> {
        let trials = journal.measured_trials(&folder.plan);
        let advice = advise(&self.candidates, &trials, self.start, &self.goal);
        advice.ok_or_else(|| {
            Failure::Tried(
                "no gait of the plan determines χ and r_s: add larger circles or squares"
                    .to_owned(),
            )
        })
    }
}

/// Writes the quantities of the finished trials that are not measured yet into the journal.
///
/// # Errors
/// As the journal.
pub(super) fn measure(
    folder: &Folder,
    file: &mut JournalFile,
    journal: &Journal,
    tracked: &Tracked,
) -> Outcome {
    let measured = journal.quantities();
    for trial in journal.finished() {
        if measured.contains_key(&trial) {
            continue;
        }
        let (quantities, problem) = match quantities(folder, journal, trial, tracked) {
            Ok(quantities) => (Some(quantities), None),
            Err(problem) => (None, Some(problem)),
        };
        if let Some(problem) = &problem {
            crate::output::aside(&format!(
                "note: the track of trial {trial} cannot be used: {problem}"
            ));
        }
        file.append(&Entry::Measured {
            trial,
            quantities,
            problem,
        })?;
    }
    Ok(())
}

/// Quantities of a finished trial, by its track.
fn quantities(
    folder: &Folder,
    journal: &Journal,
    number: u32,
    tracked: &Tracked,
) -> Result<TrialQuantities, String> {
    let words = |error: CalibrateError| error.to_string();
    let plan = folder.plan.with_chosen(journal);
    let trial = plan.trial(number).ok_or("the plan has no such trial")?;
    let gait = plan.gait(trial).ok_or("the plan has no such gait")?;
    let path = folder
        .path
        .join(journal.track(number).ok_or("it has no track")?);
    let track = load_tracks(&path, &calibrate::TrackOptions::default()).map_err(words)?;
    let swimmer = &folder.swimmer;
    let reflectors: Reflectors = tracked
        .reflectors(&swimmer.swimmer.links)
        .unwrap_or_else(|| calibrate::usual_reflectors(&track, &swimmer.swimmer));
    let run = RunData {
        file: path,
        track,
        gait: folder.curve(gait).map_err(|failure| failure.to_string())?,
        gait_name: gait.name.clone(),
        period_s: gait.period_s,
        front: None,
        timing: Timing::default(),
    };
    let cycles = calibrate_run(&run, &reflectors, swimmer)
        .map_err(words)?
        .cycles;
    let error = |of: &Statistics| Some(of.se).filter(|error| error.is_finite());
    let (x, delta_y, delta_theta) = (&cycles.x, &cycles.delta_y, &cycles.delta_theta);
    let quantities = TrialQuantities {
        x_m: x.mean,
        x_se_m: error(x),
        delta_y_m: delta_y.mean,
        delta_y_se_m: error(delta_y),
        delta_theta_rad: delta_theta.mean,
        delta_theta_se_rad: error(delta_theta),
    };
    let is_whole = [x, delta_y, delta_theta]
        .iter()
        .all(|of| of.mean.is_finite());
    if is_whole {
        Ok(quantities)
    } else {
        Err("it has no two whole cycles in a row; plan more `cycles`".to_owned())
    }
}

/// Fit and decision, in words.
pub(super) fn in_words(advice: &CampaignAdvice) -> String {
    let mut text = String::new();
    if let Some(fit) = &advice.estimate {
        // Writing to a String cannot fail.
        let _ = write!(
            text,
            "χ = {:.4} ± {:.4} ({:.2} %), r_s = {:.2} ± {:.2} mm after {} trials and {:.2} h of rests and plays.",
            fit.chi,
            fit.chi_half_width,
            100.0 * fit.chi_half_width / fit.chi,
            1e3 * fit.sphere_radius_m,
            1e3 * fit.sphere_radius_half_width_m,
            advice.trials,
            advice.tank_time_s / 3600.0
        );
        if fit.is_at_border {
            text.push_str(
                "\nThe fit is far from the swimmer file: plan the campaign again with a file that is nearer to the robot.",
            );
        }
        text.push('\n');
    }
    match &advice.decision {
        Decision::Play(next) => {
            let _ = write!(
                text,
                "Next: {}; expected then: χ ± {:.2} %, r_s ± {}. {}",
                next.gait,
                100.0 * next.chi_share,
                quantity::length(next.sphere_radius_m),
                left(next)
            );
        }
        Decision::Reached => text.push_str("Both intervals are as narrow as requested."),
        Decision::OutOfTime => text.push_str(
            "The next trial would exceed the campaign's `hours`; plan another campaign with more.",
        ),
    }
    text
}

/// Trials that are left to the goal, in words.
fn left(next: &NextTrial) -> String {
    let hours = next.seconds_left / 3600.0;
    let most = match next.trials_left {
        1 => "1 trial".to_owned(),
        count => format!("{count} trials"),
    };
    match (next.is_noise_measured, next.is_goal_within_budget) {
        (true, true) => format!("About {most} and {hours:.2} h are left to the goal."),
        (true, false) => format!(
            "The goal is not expected within the campaign's `hours`, which leave time for {most}."
        ),
        (false, true) => format!(
            "Left to the goal: at least {}, at most {most} and {hours:.2} h, the latter if lengths scatter by the spec's `accuracy` from \
             trial to trial. Three trials show the scatter.",
            next.fewest_trials_left
        ),
        (false, false) => format!(
            "Left to the goal: at least {}; the campaign's `hours` end after {most}, too few if lengths scatter by the spec's `accuracy` \
             from trial to trial. Three trials show the scatter.",
            next.fewest_trials_left
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn left_after(trials_left: usize, measured: bool, within: bool) -> String {
        left(&NextTrial {
            candidate: 0,
            gait: "circle-80deg".to_owned(),
            chi_share: 0.01,
            sphere_radius_m: 1e-3,
            trials_left,
            seconds_left: 360.0 * trials_left as f64,
            fewest_trials_left: 1,
            is_noise_measured: measured,
            is_goal_within_budget: within,
        })
    }

    #[test]
    fn one_trial_is_singular() {
        assert_eq!(
            left_after(1, true, true),
            "About 1 trial and 0.10 h are left to the goal."
        );
        assert_eq!(
            left_after(2, true, true),
            "About 2 trials and 0.20 h are left to the goal."
        );
        assert!(left_after(1, true, false).ends_with("time for 1 trial."));
    }

    #[test]
    fn without_measured_noise_a_range_is_stated() {
        let text = left_after(30, false, true);
        assert!(
            text.contains("at least 1, at most 30 trials and 3.00 h"),
            "{text}"
        );
    }
}
