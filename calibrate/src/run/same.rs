//! Recordings that are there twice: noise makes two recordings differ, so equal poses or equal cycles are the same ones.

use super::RunResult;
use crate::Statistics;
use crate::cycles::{Cycle, Cycles};
use crate::poses::{PoseSample, PoseTrack};

/// Samples that are compared, and the share of them that must be equal.
const COMPARED: usize = 32;
const EQUAL: f64 = 0.9;
/// Poses of the same time that differ by less are equal \[m, rad\]: other units round them.
const OF_POSE: f64 = 2e-6;
/// Values of cycles that differ by less are equal: in deviations between cycles, and as a share.
const OF_SCATTER: f64 = 1e-3;
const OF_SIZE: f64 = 1e-9;

/// Pairs of runs that hold the same poses, or the same cycles.
pub(crate) fn same_recordings(runs: &[RunResult]) -> Vec<[usize; 2]> {
    let same = |a: &RunResult, b: &RunResult| {
        share_poses(&a.poses, &b.poses) || share_cycles(&a.cycles, &b.cycles)
    };
    let pair = |(second, run): (usize, &RunResult)| {
        let first = runs[..second].iter().position(|other| same(other, run))?;
        Some([first, second])
    };
    runs.iter().enumerate().filter_map(pair).collect()
}

/// Returns `true` if samples of the same times have the same poses.
fn share_poses(a: &PoseTrack, b: &PoseTrack) -> bool {
    let step = (a.samples.len() / COMPARED).max(1);
    let compared: Vec<&PoseSample> = a.seen().step_by(step).collect();
    let equal = |here: &&&PoseSample| {
        let half = 0.5 / b.rate_hz;
        let next = b.samples.partition_point(|s| s.time_s < here.time_s - half);
        let there = b.samples.get(next);
        there.is_some_and(|there| {
            let (here, there) = (here.pose, there.pose);
            let apart = (here.position() - there.position()).norm();
            apart.max((here.theta - there.theta).sin().abs()) < OF_POSE
        })
    };
    let count = compared.iter().filter(equal).count();
    !compared.is_empty() && count as f64 >= EQUAL * compared.len() as f64
}

/// Returns `true` if at least half of the cycles of the shorter run are cycles of the other one.
fn share_cycles(a: &Cycles, b: &Cycles) -> bool {
    let tolerance = |value: fn(&Cycles) -> Statistics| {
        let [a, b] = [value(a), value(b)];
        let scatter = a.sd.min(b.sd);
        OF_SIZE * a.mean.abs()
            + if scatter.is_nan() {
                0.0
            } else {
                OF_SCATTER * scatter
            }
    };
    let near = [
        tolerance(|cycles| cycles.delta_y),
        tolerance(|cycles| cycles.delta_theta),
    ];
    let same = |a: &Cycle, b: &Cycle| {
        let apart = [a.delta_y - b.delta_y, a.delta_theta - b.delta_theta];
        let mut each = apart.iter().zip(near);
        each.all(|(apart, near)| apart.abs() <= near)
    };
    let of_both = |here: &&Cycle| b.cycles.iter().any(|there| same(here, there));
    let count = a.cycles.iter().filter(of_both).count();
    count > 0 && 2 * count >= a.cycles.len().min(b.cycles.len())
}
