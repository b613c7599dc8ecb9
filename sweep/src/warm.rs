//! Solution of a block by warm starts (continuation over neighbouring designs), with checks against searches.
//!
//! The keys of a block are visited along the rows of the grid's last axis, every second row backwards, so that consecutive tasks
//! are neighbours. Every `anchor`-th task, and the last task of each run of neighbours, is solved by a search. Between two such
//! *anchors* each task starts from the gait before it. The continued gaits are accepted only if the last one agrees with the
//! second anchor's gait: equal to 10⁻⁷, with the same arcs. Otherwise the middle task is solved by a search and both halves are
//! treated likewise, down to single tasks. So a change of the best branch is detected unless the other branch is best only
//! between two anchors. Every gait has its own certificate. At the end, neighbours with different arcs try each other's gaits
//! ([`again`]).

mod again;

use std::collections::BTreeMap;

use crate::objective::{DesignOutcome, Solve, Solved, Solver};
use crate::row::Row;
use crate::{Aim, Axis, Design, Field, Plan};

/// Largest block whose gaits are kept and compared at the end.
const MOST_COMPARED: u64 = 4_096;

/// Counts and computation times of a block.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Cost {
    /// Number of searches and, in the next field, of warm starts; discarded results count too.
    pub(crate) cold: u64,
    pub(crate) warm: u64,
    /// \[s\]
    pub(crate) cold_s: f64,
    pub(crate) warm_s: f64,
}

/// Solves a block and returns its rows by key.
pub(crate) fn block(plan: &Plan, block: u64, seconds: &dyn Fn() -> f64) -> (Vec<Row>, Cost) {
    let content = plan.content();
    let solver = Solver {
        starts: content.starts,
    };
    solved(plan, block, &solver, seconds)
}

fn solved(
    plan: &Plan,
    block: u64,
    solver: &dyn Solve,
    seconds: &dyn Fn() -> f64,
) -> (Vec<Row>, Cost) {
    let content = plan.content();
    let keys = plan.keys(block);
    let follows = plan.objectives().into_iter().any(Aim::follows);
    let mut visit = Visit {
        plan,
        solver,
        seconds,
        compares: follows
            && plan.design() == Design::Grid
            && keys.end - keys.start <= MOST_COMPARED,
        answers: BTreeMap::new(),
        cost: Cost::default(),
    };
    let stride = usize::try_from(content.anchor).unwrap_or(1).max(1);
    for run in runs(plan, block) {
        if stride == 1 || !follows {
            for key in run {
                let answer = visit.cold(key);
                visit.keep(key, answer);
            }
        } else {
            visit.run(&run, stride);
        }
    }
    if visit.compares {
        visit.compare_neighbours(&keys);
    }
    let answers = visit.answers.into_iter();
    let rows = answers.map(|(key, answer)| match answer {
        Ok(solved) => solved.row,
        Err(missing) => Row::without(key, missing.reason),
    });
    (rows.collect(), visit.cost)
}

/// Splits the keys of a block into runs of consecutive neighbours.
fn runs(plan: &Plan, block: u64) -> Vec<Vec<u64>> {
    let keys = plan.keys(block);
    let row = match plan.design() {
        Design::Grid => plan.axes().last().map_or(1, crate::Axis::count),
        _ => return vec![keys.collect()],
    };
    let mut runs: Vec<Vec<u64>> = Vec::new();
    let mut from = keys.start;
    let mut backwards = false;
    while from < keys.end {
        let to = (from - from % row).saturating_add(row).min(keys.end);
        let mut along: Vec<u64> = (from..to).collect();
        if backwards {
            along.reverse();
        }
        match (runs.last_mut(), along.first()) {
            (Some(run), Some(&first))
                if run.last().is_some_and(|&last| beside(plan, last, first)) =>
            {
                run.extend(along);
            }
            _ => runs.push(along),
        }
        backwards = !backwards;
        from = to;
    }
    runs
}

/// Returns `true` if two tasks of a grid differ by one step of one axis.
fn beside(plan: &Plan, a: u64, b: u64) -> bool {
    let (a, b) = (plan.indices(a), plan.indices(b));
    a.iter().zip(&b).map(|(a, b)| a.abs_diff(*b)).sum::<u64>() == 1
}

struct Visit<'a> {
    plan: &'a Plan,
    solver: &'a dyn Solve,
    seconds: &'a dyn Fn() -> f64,
    /// `true` if neighbours are compared at the end, for which their gaits are kept.
    compares: bool,
    answers: BTreeMap<u64, DesignOutcome>,
    cost: Cost,
}

impl Visit<'_> {
    fn run(&mut self, keys: &[u64], stride: usize) {
        let Some((&first, _)) = keys.split_first() else {
            return;
        };
        let mut here = self.cold(first);
        let mut at = 0;
        while at + 1 < keys.len() {
            let next = (at + stride).min(keys.len() - 1);
            let there = self.cold(keys[next]);
            self.keep(keys[at], here.clone());
            self.between(&keys[at..=next], &here, &there);
            (at, here) = (next, there);
        }
        if let Some(&last) = keys.last() {
            self.keep(last, here);
        }
    }

    /// Solves all tasks between the first and the last of these keys, whose results are known.
    fn between(&mut self, keys: &[u64], first: &DesignOutcome, last: &DesignOutcome) {
        let Some(middle) = (keys.len() > 2).then_some(keys.len() / 2) else {
            return;
        };
        if let (Ok(near), Ok(goal)) = (first, last)
            && let Some(followed) = self.followed(keys, near, goal)
        {
            for solved in followed {
                self.keep(solved.row.key, Ok(solved));
            }
            return;
        }
        let found = self.cold(keys[middle]);
        self.between(&keys[..=middle], first, &found);
        self.keep(keys[middle], found.clone());
        self.between(&keys[middle..], &found, last);
    }

    /// Continues the gaits from one key to the next. Returns `None` if they do not arrive at the last key's gait.
    fn followed(&mut self, keys: &[u64], near: &Solved, goal: &Solved) -> Option<Vec<Solved>> {
        let mut found: Vec<Solved> = Vec::with_capacity(keys.len());
        for &key in &keys[1..] {
            let solved = match self.twin(key, &found) {
                Some(answer) => answer.ok()?,
                None => self.warm(key, found.last().unwrap_or(near))?,
            };
            found.push(solved);
        }
        found.pop()?.same(goal).then_some(found)
    }

    /// Result of a task that differs only in the servo rates, if it is known already.
    fn twin(&self, key: u64, just_found: &[Solved]) -> Option<DesignOutcome> {
        if !self.compares {
            return None;
        }
        let axes = self.plan.axes();
        let rates = axes.iter().position(|axis| axis.name == Field::MaxRate)?;
        let stride: u64 = axes.iter().skip(rates + 1).map(Axis::count).product();
        let count = axes.get(rates)?.count();
        let first = key - key / stride % count * stride;
        let design = self.plan.design_of(key);
        (0..count).find_map(|index| {
            let twin = first + index * stride;
            let just = just_found.iter().find(|found| found.row.key == twin);
            match (just, self.answers.get(&twin)) {
                (Some(found), _) => self.solver.timed_anew(&design, key, &Ok(found.clone())),
                (None, Some(answer)) => self.solver.timed_anew(&design, key, answer),
                (None, None) => None,
            }
        })
    }

    fn cold(&mut self, key: u64) -> DesignOutcome {
        if let Some(answer) = self.twin(key, &[]) {
            return answer;
        }
        let began = (self.seconds)();
        let answer = self.solver.cold(&self.plan.design_of(key), key);
        self.cost.cold += 1;
        self.cost.cold_s += (self.seconds)() - began;
        answer
    }

    fn warm(&mut self, key: u64, near: &Solved) -> Option<Solved> {
        let began = (self.seconds)();
        let found = self.solver.warm(&self.plan.design_of(key), key, near);
        self.cost.warm += 1;
        self.cost.warm_s += (self.seconds)() - began;
        found
    }

    fn keep(&mut self, key: u64, answer: DesignOutcome) {
        let answer = match answer {
            Ok(solved) if !self.compares => Ok(Solved::of_row(solved.row)),
            answer => answer,
        };
        self.answers.insert(key, answer);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(text: &str) -> Plan {
        Plan::of_spec(text, "spec.toml".as_ref()).unwrap()
    }

    #[test]
    fn rows_are_walked_to_and_fro_and_every_key_once() {
        let plan = plan(
            "swimmer = \"purcell\"\nobjective = \"stub\"\nblock = 10\n\
             [[axis]]\nname = \"drag.chi\"\nfrom = 1\nto = 2\ncount = 3\n\
             [[axis]]\nname = \"sphere.radius\"\nfrom = 0\nto = 1\ncount = 4\n",
        );
        assert_eq!(plan.blocks(), 2);
        assert_eq!(runs(&plan, 0), [vec![0, 1, 2, 3, 7, 6, 5, 4, 8, 9]]);
        assert_eq!(runs(&plan, 1), [vec![10, 11]]);
    }

    /// Model of two branches, of which the second is better in some columns of the grid only.
    struct Two {
        columns: std::ops::Range<u64>,
    }

    impl Two {
        fn of(&self, key: u64, kind: &str) -> Option<Solved> {
            let better = self.columns.contains(&(key % 17));
            let value = 2.0 + 1e-4 * (key % 17) as f64;
            let objective = match kind {
                "one" => value,
                _ if better => value + 1e-3,
                _ => return None,
            };
            Some(Solved::of_row(Row {
                key,
                objective: Some(objective),
                arcs: Some(kind.to_owned()),
                certified: Some(true),
                ..Row::default()
            }))
        }
    }

    impl Solve for Two {
        fn cold(&self, _: &crate::field::Design, key: u64) -> DesignOutcome {
            let best = self.of(key, "two").or_else(|| self.of(key, "one"));
            best.ok_or_else(|| "none".to_owned().into())
        }

        fn warm(&self, _: &crate::field::Design, key: u64, near: &Solved) -> Option<Solved> {
            let mut solved = self.of(key, near.row.arcs.as_deref()?)?;
            solved.row.warm = true;
            Some(solved)
        }

        fn timed_anew(
            &self,
            _: &crate::field::Design,
            _: u64,
            _: &DesignOutcome,
        ) -> Option<DesignOutcome> {
            None
        }
    }

    /// The best gait does not depend on the servo rates, so one search serves all of them.
    #[test]
    fn rates_cost_nothing() {
        let text = "swimmer = \"purcell\"\nobjective = \"displacement\"\n[bounds]\nmax_angle = 2.4\n\
             [[axis]]\nname = \"sphere.radius\"\nfrom = 0.0\nto = 0.2\ncount = 5\n";
        let rates = "[[axis]]\nname = \"max_rate\"\nvalues = [1.0, 2.0, 4.0]\n";
        let plain = plan(text);
        let (rows, cost) = block(&plain, 0, &|| 0.0);
        for text in [
            format!("{text}{rates}"),
            text.replacen("[[axis]]", &format!("{rates}[[axis]]"), 1),
        ] {
            let plan = plan(&text);
            let (timed, of_all) = block(&plan, 0, &|| 0.0);
            assert_eq!(timed.len(), 15);
            // Fewer gaits are solved than there are designs.
            assert!(of_all.cold + of_all.warm < 15, "{of_all:?} {cost:?}");
            let mut turns = BTreeMap::new();
            for row in timed {
                let [radius, rate] = [Field::Sphere, Field::MaxRate].map(|field| {
                    let axes = plan.axes().iter().zip(plan.point(row.key));
                    axes.filter(|(axis, _)| axis.name == field)
                        .map(|(_, value)| value)
                        .sum::<f64>()
                });
                let alone = rows
                    .iter()
                    .find(|row| (plain.point(row.key)[0] - radius).abs() < 1e-12)
                    .unwrap();
                assert_eq!(row.arcs, alone.arcs);
                let share = row.objective.unwrap() / alone.objective.unwrap();
                assert!((share - 1.0).abs() < 1e-7, "{share}");
                let speed = row.speed_over_length_per_s.unwrap() * row.period_s.unwrap();
                assert!((speed / row.objective.unwrap() - 1.0).abs() < 1e-9);
                let turned = row.period_s.unwrap() * rate;
                let before = *turns.entry(radius.to_bits()).or_insert(turned);
                assert!((turned / before - 1.0).abs() < 1e-12, "{turned} {before}");
            }
        }
    }

    /// Keys of a grid with 17 columns whose result is not the better branch, although it exists.
    fn missed(rows: u64, anchor: u64, columns: std::ops::Range<u64>) -> Vec<u64> {
        let plan = plan(&format!(
            "swimmer = \"purcell\"\nobjective = \"displacement\"\nanchor = {anchor}\nblock = 1000\n\
             [[axis]]\nname = \"drag.chi\"\nfrom = 1.5\nto = 2\ncount = {rows}\n\
             [[axis]]\nname = \"sphere.radius\"\nfrom = 0\nto = 1\ncount = 17\n"
        ));
        let two = Two {
            columns: columns.clone(),
        };
        let (found, _) = solved(&plan, 0, &two, &|| 0.0);
        assert_eq!(found.len() as u64, 17 * rows);
        let right =
            |row: &Row| (row.arcs.as_deref() == Some("two")) == columns.contains(&(row.key % 17));
        found
            .iter()
            .filter(|row| !right(row))
            .map(|row| row.key)
            .collect()
    }

    /// The documented limit: a better branch that begins and ends between two searches is missed, unless another row finds it.
    #[test]
    fn a_better_kind_between_two_searches() {
        assert_eq!(missed(1, 16, 5..9), [5, 6, 7, 8]);
        assert!(missed(1, 1, 5..9).is_empty());
        assert!(missed(1, 4, 5..9).is_empty());
        // The anchors differ from row to row, and a branch that one finds is passed on to its neighbours.
        assert!(missed(8, 16, 5..9).is_empty());
        assert!(missed(3, 8, 4..7).is_empty());
    }

    /// For a growing sphere the branch changes on the way, and each result equals that of a search.
    #[test]
    fn what_is_followed_is_what_is_found_from_nothing() {
        let text = "swimmer = \"purcell\"\nobjective = \"displacement\"\n\
             [bounds]\nmax_angle = 2.8\n\
             [[axis]]\nname = \"sphere.radius\"\nfrom = 0.0\nto = 1.0\ncount = 33\n";
        let warm = plan(text);
        let cold = plan(&text.replace("[bounds]", "anchor = 1\n[bounds]"));
        let clock = || 0.0;
        let (rows, cost) = block(&warm, 0, &clock);
        let (all, _) = block(&cold, 0, &clock);
        assert!(cost.warm > cost.cold, "{cost:?}");
        assert!(rows.iter().any(|row| row.warm));
        for (followed, found) in rows.iter().zip(&all) {
            assert_eq!(followed.key, found.key);
            assert_eq!(followed.arcs, found.arcs);
            match (followed.objective, found.objective) {
                (Some(a), Some(b)) => assert!((a / b - 1.0).abs() < 1e-7, "{a} {b}"),
                (a, b) => assert_eq!(a, b),
            }
        }
    }
}
