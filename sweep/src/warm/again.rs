//! Comparison of neighbours with different arcs: each is solved from the other's gait and keeps the better result.
//!
//! A search can miss a gait, and a continued gait can cease to be the best. Both appear as differences between neighbours: in
//! their arcs, in the existence of a gait, as a jump, or as a better value under a tighter bound. An improved gait may also
//! improve the next neighbour, so the comparison repeats until nothing changes. It covers the tasks of one block in key order.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::Visit;
use crate::map::among;

/// Relative difference below which two gaits count as equal.
const BETTER: f64 = 1e-7;

impl Visit<'_> {
    /// Compares all neighbours among these tasks.
    pub(super) fn compare_neighbours(&mut self, keys: &Range<u64>) {
        // Version of each task's result, and the versions that were tried for each neighbour.
        let mut version: BTreeMap<u64, u64> = BTreeMap::new();
        let mut tried: BTreeSet<(u64, u64, u64)> = BTreeSet::new();
        loop {
            let mut changed = false;
            for (one, other) in self.unlike(keys) {
                for (from, to) in [(one, other), (other, one)] {
                    let here = version.get(&from).copied().unwrap_or(0);
                    if tried.insert((from, to, here)) && self.improved(from, to) {
                        *version.entry(to).or_default() += 1;
                        changed = true;
                    }
                }
            }
            if !changed {
                return;
            }
        }
    }

    /// Neighbours whose gaits have different arcs, of which one has no gait, or whose values are doubtful.
    fn unlike(&self, keys: &Range<u64>) -> BTreeSet<(u64, u64)> {
        let objective = |key: u64| self.answers.get(&key)?.as_ref().ok()?.row.objective;
        let doubts = among(self.plan, keys.clone(), &objective);
        let mut pairs: BTreeSet<(u64, u64)> = doubts
            .iter()
            .map(|doubt| {
                (
                    doubt.key.min(doubt.neighbour),
                    doubt.key.max(doubt.neighbour),
                )
            })
            .collect();
        let arcs = |key: u64| {
            let row = &self.answers.get(&key)?.as_ref().ok()?.row;
            row.arcs.as_deref()
        };
        let mut stride = 1;
        for axis in self.plan.axes().iter().rev() {
            let next = keys.clone().filter(|key| {
                axis.name.compares() && key / stride % axis.count() + 1 < axis.count()
            });
            let next = next.map(|key| (key, key + stride));
            pairs.extend(
                next.filter(|&(one, other)| keys.contains(&other) && arcs(one) != arcs(other)),
            );
            stride *= axis.count();
        }
        pairs
    }

    /// Solves a task from a neighbour's gait. Returns `true` if that improved its result.
    fn improved(&mut self, from: u64, to: u64) -> bool {
        let Some(Ok(near)) = self.answers.get(&from) else {
            return false;
        };
        let near = near.clone();
        let Some(found) = self.warm(to, &near) else {
            return false;
        };
        let least = match self.answers.get(&to) {
            Some(Ok(have)) => have.row.objective,
            Some(Err(missing)) => missing.outdone,
            None => None,
        };
        let better = match (found.row.objective, least) {
            (Some(found), Some(least)) => found > least * (1.0 + BETTER),
            (found, None) => found.is_some(),
            (None, _) => false,
        };
        if better {
            self.keep(to, Ok(found));
        }
        better
    }
}
