//! Neighbours of unlike gaits: each is tried from the other's gait, and keeps what is better.
//!
//! Searches miss gaits, and a gait that was followed too far is not the best. Both show where neighbours differ: in their arcs, in
//! whether there is a gait, in a jump, or where a tighter bound does better. A gait found so may be better than its next neighbour's,
//! too, so this goes on until nothing changes. It sees the tasks of one block, in the order of their keys.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::Visit;
use crate::map::among;

/// A gait that is better by less is the same.
const BETTER: f64 = 1e-7;

impl Visit<'_> {
    /// Compares all neighbours among these tasks.
    pub(super) fn look_again(&mut self, keys: &Range<u64>) {
        // Which answer of a task this is, and which answers were tried where.
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

    /// Neighbours whose gaits are of different arcs, of which one has none, or whose values do not go together.
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

    /// Tries a task from a neighbour's gait; whether that is better than what it has.
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
