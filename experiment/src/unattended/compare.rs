//! Comparison of measured gaits: intervals by Student's t, and optima against their neighbours.
//!
//! One value per trial: the mean displacement of its counted cycles along the predicted direction. A gait's interval comes from the
//! scatter of its repeats. An optimum is compared with a neighbour within blocks (paired t-test, one-sided), which cancels
//! what changes from block to block. The p-values of all comparisons are corrected together by Holm's method, which holds
//! for any dependence between them.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{Journal, Plan, PlannedGait};
use calibrate::student;

/// Quantity in which an optimum is compared with its neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// Displacement per cycle.
    Displacement,
    /// Displacement per unit of time.
    Speed,
}

/// Measured gait.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GaitSummary {
    /// Its name.
    pub gait: String,
    /// Predicted displacement of a cycle \[m\].
    pub predicted_m: f64,
    /// Mean measured displacement of a cycle \[m\]; `None` without a finished trial.
    pub measured_m: Option<f64>,
    /// Half width of its interval \[m\]; `None` with fewer than two trials.
    pub interval_m: Option<f64>,
    /// Duration of a cycle \[s\].
    pub period_s: f64,
    /// Measured speed \[m/s\].
    pub speed_m_per_s: Option<f64>,
    /// Mean measured net turn of a cycle \[rad\].
    pub turn_rad: Option<f64>,
    /// Finished trials.
    pub runs: usize,
    /// Values of the trials with their blocks.
    pub trials: Vec<TrialValue>,
}

/// Value of a trial.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TrialValue {
    /// Number of the trial.
    pub trial: u32,
    /// Block.
    pub block: u32,
    /// Mean displacement of a cycle \[m\].
    pub displacement_m: f64,
}

/// Comparison of an optimum with a neighbour.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Better {
    /// The optimum.
    pub better: String,
    /// The neighbour.
    pub than: String,
    /// Compared quantity.
    pub measure: Measure,
    /// Mean difference of the displacement \[m\], if that is compared.
    pub difference_m: Option<f64>,
    /// Mean difference of the speed \[m/s\], if that is compared.
    pub difference_m_per_s: Option<f64>,
    /// Blocks with both.
    pub blocks: usize,
    /// One-sided p-value of this comparison alone; `None` with fewer than two blocks.
    pub p_alone: Option<f64>,
    /// p-value corrected for all comparisons of the experiment (Holm).
    pub p: Option<f64>,
    /// The optimum beats this neighbour: p is below one less the level.
    pub shown: bool,
}

/// Result of an experiment.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Planned trials.
    pub runs: usize,
    /// Finished trials.
    pub done: usize,
    /// Trials that were given up.
    pub given_up: usize,
    /// Level of the intervals.
    pub level: f64,
    /// Gaits in the order of the plan.
    pub gaits: Vec<GaitSummary>,
    /// Optima against their neighbours.
    pub comparisons: Vec<Better>,
}

/// Compares the finished trials of a plan.
pub fn compare(plan: &Plan, journal: &Journal) -> Comparison {
    let measured = journal.measured();
    let mut values: BTreeMap<&str, Vec<TrialValue>> = BTreeMap::new();
    let mut turns: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for trial in &plan.trials {
        let (Some(cycles), Some(gait)) = (measured.get(&trial.number), plan.gait(trial)) else {
            continue;
        };
        if cycles.is_empty() {
            continue;
        }
        let [x, y] = direction(gait);
        let along = cycles.iter().map(|cycle| cycle.x_m * x + cycle.y_m * y);
        values.entry(&trial.gait).or_default().push(TrialValue {
            trial: trial.number,
            block: trial.block,
            displacement_m: along.sum::<f64>() / cycles.len() as f64,
        });
        let turn = cycles.iter().map(|cycle| cycle.turn_rad).sum::<f64>();
        turns
            .entry(&trial.gait)
            .or_default()
            .push(turn / cycles.len() as f64);
    }
    let of = |name: &str| values.get(name).cloned().unwrap_or_default();
    let summaries = plan.gaits.iter().map(|gait| {
        let trials = of(&gait.name);
        let numbers: Vec<f64> = trials.iter().map(|value| value.displacement_m).collect();
        let mean = mean(&numbers);
        GaitSummary {
            gait: gait.name.clone(),
            predicted_m: gait.predicted_m(),
            measured_m: mean,
            interval_m: half_width(&numbers, plan.level),
            period_s: gait.period_s,
            speed_m_per_s: mean.map(|mean| mean / gait.period_s),
            turn_rad: turns
                .get(gait.name.as_str())
                .and_then(|turns| self::mean(turns)),
            runs: trials.len(),
            trials,
        }
    });
    let neighbours = plan.gaits.iter().filter_map(|gait| {
        let optimum = gait.neighbour_of.as_ref()?;
        let optimum = plan.gaits.iter().find(|other| other.name == *optimum)?;
        Some(better(
            optimum,
            gait,
            &differences(optimum, &of(&optimum.name), gait, &of(&gait.name)),
        ))
    });
    let mut comparisons: Vec<Better> = neighbours.collect();
    correct(&mut comparisons);
    for comparison in &mut comparisons {
        comparison.shown = comparison.p.is_some_and(|p| p < 1.0 - plan.level);
    }
    Comparison {
        runs: plan.trials.len(),
        done: measured.len(),
        given_up: journal.given_up().len(),
        level: plan.level,
        gaits: summaries.collect(),
        comparisons,
    }
}

/// Unit vector of the predicted displacement.
fn direction(gait: &PlannedGait) -> [f64; 2] {
    let length = gait.predicted_m();
    if length > 0.0 {
        gait.predicted_xy_m.map(|part| part / length)
    } else {
        [1.0, 0.0]
    }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Standard error of the mean. `None` with fewer than two values.
fn standard_error(values: &[f64]) -> Option<f64> {
    let mean = mean(values)?;
    let count = values.len() as f64;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (values.len() >= 2).then(|| (squares / (count - 1.0) / count).sqrt())
}

/// Half width of the interval of the mean.
fn half_width(values: &[f64], level: f64) -> Option<f64> {
    let freedom = values.len() as f64 - 1.0;
    Some(standard_error(values)? * student::quantile(freedom, level)?)
}

/// Optimum minus neighbour in the blocks that have both, in the optimum's measure.
fn differences(
    optimum: &PlannedGait,
    of_optimum: &[TrialValue],
    neighbour: &PlannedGait,
    of_neighbour: &[TrialValue],
) -> Vec<f64> {
    let value = |gait: &PlannedGait, value: &TrialValue| match optimum.measure {
        Measure::Displacement => value.displacement_m,
        Measure::Speed => value.displacement_m / gait.period_s,
    };
    let in_block = |one: &TrialValue| {
        let other = of_neighbour.iter().find(|other| other.block == one.block)?;
        Some(value(optimum, one) - value(neighbour, other))
    };
    of_optimum.iter().filter_map(in_block).collect()
}

fn better(optimum: &PlannedGait, neighbour: &PlannedGait, differences: &[f64]) -> Better {
    let measure = optimum.measure;
    let difference = mean(differences);
    let is_speed = measure == Measure::Speed;
    Better {
        better: optimum.name.clone(),
        than: neighbour.name.clone(),
        measure,
        difference_m: difference.filter(|_| !is_speed),
        difference_m_per_s: difference.filter(|_| is_speed),
        blocks: differences.len(),
        p_alone: one_sided(differences),
        p: None,
        shown: false,
    }
}

/// p-value of a mean above zero.
fn one_sided(differences: &[f64]) -> Option<f64> {
    let mean = mean(differences)?;
    let error = standard_error(differences)?;
    if error <= 0.0 {
        // No scatter at all: only the sign is known.
        return Some(if mean > 0.0 { 0.0 } else { 1.0 });
    }
    let freedom = differences.len() as f64 - 1.0;
    let half = 0.5 * student::two_sided(freedom, mean / error);
    Some(if mean > 0.0 { half } else { 1.0 - half })
}

/// Holm's step-down correction.
fn correct(comparisons: &mut [Better]) {
    let mut tested: Vec<&mut Better> = comparisons
        .iter_mut()
        .filter(|comparison| comparison.p_alone.is_some())
        .collect();
    tested.sort_by(|a, b| {
        let [a, b] = [a, b].map(|tested| tested.p_alone.unwrap_or(1.0));
        a.total_cmp(&b)
    });
    let count = tested.len();
    let mut before: f64 = 0.0;
    for (rank, comparison) in tested.into_iter().enumerate() {
        let alone = comparison.p_alone.unwrap_or(1.0);
        before = before.max((alone * (count - rank) as f64).min(1.0));
        comparison.p = Some(before);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With four degrees of freedom, P(T > t) = 1/2 − 3/8 s (1 − s²/12), s = t / √(1 + t²/4).
    #[test]
    fn a_paired_test_and_an_interval_are_those_of_the_tables() {
        // Differences 0.4, 0.1, 0.5, 0.2, 0.3: mean 0.3, sd 0.158114, t = 4.242641 with 4 degrees of freedom.
        let p = one_sided(&[0.4, 0.1, 0.5, 0.2, 0.3]).unwrap();
        assert!((p - 0.006_618).abs() < 2e-6, "{p}");
        // t(0.975, 4) = 2.776445.
        let half = half_width(&[0.4, 0.1, 0.5, 0.2, 0.3], 0.95).unwrap();
        assert!(
            (half - 2.776_445 * 0.158_114 / 5_f64.sqrt()).abs() < 1e-6,
            "{half}"
        );
        assert!((one_sided(&[-0.4, -0.1, -0.5, -0.2, -0.3]).unwrap() - (1.0 - p)).abs() < 1e-12);
    }

    /// Holm (1979): 0.01, 0.04, 0.03, 0.005 give 0.03, 0.06, 0.06, 0.02.
    #[test]
    fn the_correction_is_holms() {
        let one = |p: f64| Better {
            better: "a".to_owned(),
            than: "b".to_owned(),
            measure: Measure::Displacement,
            difference_m: None,
            difference_m_per_s: None,
            blocks: 5,
            p_alone: Some(p),
            p: None,
            shown: false,
        };
        let mut all = [0.01, 0.04, 0.03, 0.005].map(one);
        correct(&mut all);
        let found = all.map(|tested| tested.p.unwrap());
        for (found, expected) in found.into_iter().zip([0.03, 0.06, 0.06, 0.02]) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}
