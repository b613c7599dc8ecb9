//! Adaptive campaign: after each trial the next gait is the one that narrows the intervals of χ and r_s most per second of tank time.
//!
//! Sequential optimal design. Each gait has a [`Response`]: predicted X, ΔY, Δθ as functions of ln χ and r_s with exact derivatives.
//! [`advise`] fits both parameters to the trials so far by weighted least squares (Gauss–Newton). The noise of each quantity is pooled
//! over all trials, and the intervals are Student's with the degrees of freedom by Welch and Satterthwaite. The Fisher information of one
//! more trial of each gait then gives the expected half widths, and the criterion is A-optimality in units of the goal.
//!
//! The expected half widths hold for noise that stays as it was. Gaits are weighed by their information on χ and r_s alone: the first
//! trials play different gaits, so that a model that does not fit the robot shows in the residuals.

mod estimate;
mod response;

use serde::Serialize;

pub use estimate::{DragEstimate, MeasuredTrial, estimate};
pub use response::{QUANTITIES, Response};

use estimate::{Information, half_widths};

/// Fewest trials of a campaign: with fewer the noise is hardly known.
const FEWEST_TRIALS: usize = 6;
/// First trials, which play different gaits.
const DIFFERENT_TRIALS: usize = 3;
/// Power of the half widths over their goals in the criterion: the wider one counts more.
const POWER: i32 = 4;
/// Most trials that are looked ahead.
const MOST_TRIALS: usize = 1000;

/// Expected standard deviation of a length in a trial if the spec states none \[m\]: that of trials under cameras with .75 mm of noise
/// per frame, a wobble of .9 mm and currents of 45 µm/s. Better laboratories have less.
pub const USUAL_ACCURACY_M: f64 = 5e-4;

/// Intervals to reach, and the tank time for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CampaignGoal {
    /// Half width of the interval of χ, as a share of χ.
    pub chi_share: f64,
    /// Half width of the interval of r_s \[m\].
    pub sphere_radius_m: f64,
    /// Level of the intervals.
    pub level: f64,
    /// Longest tank time \[s\].
    pub budget_s: f64,
    /// Expected standard deviation of a length in a trial \[m\]. It decides only the first trials and the forecast before them.
    pub accuracy_m: f64,
}

/// Drag parameters of a swimmer file, from which the fit starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartParameters {
    /// χ.
    pub chi: f64,
    /// r_s \[m\].
    pub sphere_radius_m: f64,
}

impl StartParameters {
    /// ln χ and r_s \[m\], in which the fit computes.
    fn coordinates(self) -> [f64; 2] {
        [self.chi.ln(), self.sphere_radius_m]
    }
}

/// Gait that the campaign may play.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Its name.
    pub name: String,
    /// Tank time of a trial \[s\].
    pub seconds: f64,
    /// Predicted quantities.
    pub response: Response,
}

/// Result of [`advise`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CampaignAdvice {
    /// Trials so far.
    pub trials: usize,
    /// Tank time of them \[s\].
    pub tank_time_s: f64,
    /// Fit of the trials so far; `None` if they do not determine χ and r_s.
    pub estimate: Option<DragEstimate>,
    /// Next step.
    pub decision: Decision,
}

/// Next step of a campaign.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Decision {
    /// Play a trial.
    Play(NextTrial),
    /// Both intervals are as narrow as requested.
    Reached,
    /// The next trial would exceed the tank time.
    OutOfTime,
}

/// Next trial, and the expectation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NextTrial {
    /// Index of the gait.
    #[serde(skip)]
    pub candidate: usize,
    /// Its name.
    pub gait: String,
    /// Expected half width of χ after this trial, as a share of χ.
    pub chi_share: f64,
    /// Expected half width of r_s after this trial \[m\].
    pub sphere_radius_m: f64,
    /// Expected trials to the goal, with this one; no more than the budget has time for.
    pub trials_left: usize,
    /// Expected tank time of these trials \[s\].
    pub seconds_left: f64,
    /// Fewest trials to the goal, whatever the noise.
    pub fewest_trials_left: usize,
    /// `true` if the trials so far have shown the noise. Before, the expectation is by the goal's accuracy: an upper bound for cameras
    /// that are no worse.
    pub is_noise_measured: bool,
    /// `true` if the goal is expected within the budget.
    pub is_goal_within_budget: bool,
}

/// Decides the next trial from those so far. Returns `None` without candidates.
pub fn advise(
    candidates: &[Candidate],
    trials: &[MeasuredTrial],
    start: StartParameters,
    goal: &CampaignGoal,
) -> Option<CampaignAdvice> {
    let tank_time_s = trials
        .iter()
        .filter_map(|trial| candidates.get(trial.candidate))
        .map(|candidate| candidate.seconds)
        .sum();
    let fitted = estimate(candidates, trials, start, goal);
    let advice = |decision| CampaignAdvice {
        trials: trials.len(),
        tank_time_s,
        estimate: fitted.clone(),
        decision,
    };
    let reached = fitted.as_ref().is_some_and(|fit| {
        fit.chi_half_width <= goal.chi_share * fit.chi
            && fit.sphere_radius_half_width_m <= goal.sphere_radius_m
    });
    let usable = trials.iter().filter(|trial| trial.is_usable()).count();
    if reached && usable >= FEWEST_TRIALS {
        return Some(advice(Decision::Reached));
    }
    let next = next_trial(candidates, trials, fitted.as_ref(), start, goal)?;
    let seconds = candidates.get(next.candidate)?.seconds;
    if tank_time_s + seconds > goal.budget_s {
        return Some(advice(Decision::OutOfTime));
    }
    Some(advice(Decision::Play(next)))
}

/// Largest criterion first: the fall of the goal's measure per second.
fn next_trial(
    candidates: &[Candidate],
    trials: &[MeasuredTrial],
    fitted: Option<&DragEstimate>,
    start: StartParameters,
    goal: &CampaignGoal,
) -> Option<NextTrial> {
    let at = fitted.map_or(start.coordinates(), |fit| {
        [fit.chi.ln(), fit.sphere_radius_m]
    });
    let middle = candidates.first()?.response.middle_m();
    let noise = fitted.map_or_else(
        || estimate::expected_noise(goal.accuracy_m, middle),
        |fit| fit.noise,
    );
    let mut information = Information::weak(at);
    for trial in trials.iter().filter(|trial| trial.is_usable()) {
        information.add(&candidates.get(trial.candidate)?.response, at, &noise);
    }
    let freedom = fitted.map_or(f64::from(u16::MAX), |fit| fit.freedom);
    let is_new = |index: usize| trials.iter().all(|trial| trial.candidate != index);
    let needs_new = trials.len() < DIFFERENT_TRIALS && (0..candidates.len()).any(is_new);
    let best = |information: &Information, freedom: f64, needs_new: bool| {
        let measure = |information: &Information, freedom: f64| {
            let [chi, radius] = half_widths(information, freedom, goal.level)?;
            Some((chi / goal.chi_share).powi(POWER) + (radius / goal.sphere_radius_m).powi(POWER))
        };
        let before = measure(information, freedom)?;
        let options = candidates.iter().enumerate();
        options
            .filter(|(index, _)| !needs_new || is_new(*index))
            .filter_map(|(index, candidate)| {
                let after = information.with(&candidate.response, at, &noise);
                // The degrees of freedom are the same for all: that of one trial more is no merit of its gait.
                let gain = (before - measure(&after, freedom)?) / candidate.seconds;
                Some((index, gain, after))
            })
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(index, _, after)| (index, after))
    };
    let (index, mut information) = best(&information, freedom, needs_new)?;
    let chosen = candidates.get(index)?;
    let mut freedom = freedom + 1.0;
    let [chi_share, sphere_radius_m] = half_widths(&information, freedom, goal.level)?;
    let is_reached =
        |[chi, radius]: [f64; 2]| chi <= goal.chi_share && radius <= goal.sphere_radius_m;
    let played = trials.iter().filter_map(|of| candidates.get(of.candidate));
    let seconds_played: f64 = played.map(|candidate| candidate.seconds).sum();
    let usable = trials.iter().filter(|trial| trial.is_usable()).count();
    let (mut trials_left, mut seconds_left) = (1, chosen.seconds);
    let is_goal_within_budget = loop {
        let enough = usable + trials_left >= FEWEST_TRIALS;
        if enough && is_reached(half_widths(&information, freedom, goal.level)?) {
            break true;
        }
        let (index, after) = best(&information, freedom, false)?;
        let seconds = candidates.get(index)?.seconds;
        if trials_left >= MOST_TRIALS || seconds_played + seconds_left + seconds > goal.budget_s {
            break false;
        }
        information = after;
        freedom += 1.0;
        trials_left += 1;
        seconds_left += seconds;
    };
    Some(NextTrial {
        candidate: index,
        gait: chosen.name.clone(),
        chi_share,
        sphere_radius_m,
        trials_left,
        seconds_left,
        fewest_trials_left: FEWEST_TRIALS.saturating_sub(usable).clamp(1, trials_left),
        is_noise_measured: fitted.is_some(),
        is_goal_within_budget,
    })
}
