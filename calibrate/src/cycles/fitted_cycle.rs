//! Cycles as their curves: which are unlike the others, how they drift, and what the steps between them are.

use swimmer_model::Pose;

use super::warning::SAME_PHASE;
use super::{Curve, Cycle, Harmonics, LeftOut};
use crate::median::median;

/// A cycle is unlike the others when its residual is this many times their median.
const UNLIKE: f64 = 3.0;
/// Fewest steps of which one can stand out.
const FEWEST_STEPS: usize = 3;
/// A step stands out when it is this many of the steps' deviations from their middle,
const FAR: f64 = 10.0;
/// and further than this, as a share of the reflectors' distance, and in rad.
const NEAR: f64 = 0.015;

/// A cycle's curve.
#[derive(Debug, Clone)]
pub(super) struct FittedCycle {
    /// Start \[s\].
    pub(super) start_s: f64,
    /// Share of missing samples.
    pub(super) missing: f64,
    pub(super) curve: Curve,
    /// Root mean square distance of the positions from the curve \[m\].
    pub(super) residual_m: f64,
    /// Between cycles of different segments the frame of the tank moved, or the robot was pushed.
    pub(super) segment: usize,
}

impl FittedCycle {
    fn is_near(&self, next: &Self, period: f64) -> bool {
        self.segment == next.segment && next.start_s - self.start_s < 1.5 * period
    }

    fn step_to(&self, next: &Self, period: f64) -> Option<Pose<f64>> {
        let late = next.start_s - self.start_s - period;
        let follows = self.segment == next.segment && late.abs() < SAME_PHASE * period;
        follows.then(|| self.curve.step_to(&next.curve, 0.0))
    }

    /// The cycle, with the step to the next one.
    pub(super) fn cycle(&self, next: Option<&Self>, period: f64) -> Cycle {
        let (delta_y, delta_theta) = self.curve.amplitudes(0.0);
        Cycle {
            start_s: self.start_s,
            step: next.and_then(|next| self.step_to(next, period)),
            delta_y,
            delta_theta,
            missing: self.missing,
            residual_m: self.residual_m,
            curve: self.curve.clone(),
        }
    }
}

pub(super) fn drop_unlike(drawn: &mut Vec<FittedCycle>, left_out: &mut Vec<(f64, LeftOut)>) {
    let mut residuals: Vec<f64> = drawn.iter().map(|cycle| cycle.residual_m).collect();
    residuals.sort_by(f64::total_cmp);
    // Of two, the lower one is the measure: the last cycle is the one that goes wrong.
    let Some(median) = residuals
        .get((residuals.len().saturating_sub(1)) / 2)
        .copied()
    else {
        return;
    };
    // Below a micrometre all residuals are rounding.
    let limit = UNLIKE * median.max(1e-6);
    drawn.retain(|cycle| {
        let keep = cycle.residual_m <= limit;
        if !keep {
            left_out.push((cycle.start_s, LeftOut::Unlike(cycle.residual_m)));
        }
        keep
    });
}

/// Every curve with the drift from the cycle before it to the one after it, as far as they are there.
fn settle_drifts(drawn: &[FittedCycle], period: f64) -> Vec<FittedCycle> {
    let settled = |(i, here): (usize, &FittedCycle)| {
        let before = i
            .checked_sub(1)
            .and_then(|i| drawn.get(i))
            .filter(|before| before.is_near(here, period));
        let after = drawn.get(i + 1).filter(|after| here.is_near(after, period));
        let curve = match (before, after) {
            (Some(before), Some(after)) => here.curve.drifting(&before.curve, &after.curve, 2.0),
            (None, Some(after)) => here.curve.drifting(&here.curve, &after.curve, 1.0),
            (Some(before), None) => here.curve.drifting(&before.curve, &here.curve, 1.0),
            (None, None) => here.curve.clone(),
        };
        FittedCycle {
            curve,
            ..here.clone()
        }
    };
    drawn.iter().enumerate().map(settled).collect()
}

/// Drifts settled, without those over steps that stand far out: there a new segment begins. `distance_m` is the reflectors'.
pub(super) fn settle(
    mut drawn: Vec<FittedCycle>,
    period: f64,
    distance_m: f64,
    left_out: &mut Vec<(f64, LeftOut)>,
) -> Vec<FittedCycle> {
    let settled = settle_drifts(&drawn, period);
    let far = far_steps(&settled, period, distance_m);
    if far.is_empty() {
        return settled;
    }
    for (from, why) in far {
        left_out.extend(drawn.get(from).map(|cycle| (cycle.start_s, why)));
        for after in drawn.iter_mut().skip(from + 1) {
            after.segment += 1;
        }
    }
    settle_drifts(&drawn, period)
}

/// The cycles whose steps to the next ones stand far out of the others, and by how much.
fn far_steps(drawn: &[FittedCycle], period: f64, distance_m: f64) -> Vec<(usize, LeftOut)> {
    let pairs = drawn.iter().zip(drawn.iter().skip(1)).enumerate();
    let steps: Vec<(usize, Pose<f64>)> = pairs
        .filter_map(|(i, (here, next))| Some((i, here.step_to(next, period)?)))
        .collect();
    if steps.len() < FEWEST_STEPS {
        return Vec::new();
    }
    // Deviation of each step from the median, and whether it exceeds the limit.
    let off = |value: fn(&Pose<f64>) -> f64, near: f64| {
        let values = || steps.iter().map(|(_, step)| value(step));
        let middle = median(values()).unwrap_or(0.0);
        let spread = median(values().map(|v| (v - middle).abs())).unwrap_or(0.0);
        // A normal variable's deviation over the median of its size.
        let limit = FAR * 1.4826 * spread + near;
        let off: Vec<(f64, bool)> = values()
            .map(|v| (v - middle, (v - middle).abs() > limit))
            .collect();
        off
    };
    let x = off(|step| step.x, NEAR * distance_m);
    let y = off(|step| step.y, NEAR * distance_m);
    let turn = off(|step| step.theta, NEAR);
    let each = steps.iter().zip(x).zip(y).zip(turn);
    each.filter(|(((_, x), y), turn)| x.1 || y.1 || turn.1)
        .map(|((((from, _), x), y), turn)| {
            let (by_m, by_rad) = (x.0.hypot(y.0), turn.0);
            (*from, LeftOut::Step { by_m, by_rad })
        })
        .collect()
}

pub(super) fn mean_heading(drawn: &[FittedCycle]) -> Harmonics {
    let mut mean = Harmonics::default();
    for cycle in drawn {
        for (mean, here) in mean
            .iter_mut()
            .flatten()
            .zip(cycle.curve.heading_harmonics().iter().flatten())
        {
            *mean += here / drawn.len() as f64;
        }
    }
    mean
}
