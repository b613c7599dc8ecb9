//! Relaxing a bound never lowers the optimum of turning or efficiency: a gait within a bound is one within a wider bound too. Twelve
//! swimmers, the largest angle in small steps. Displacement per cycle and displacement sideways have local optima among simple
//! curves only, which may end as a bound is widened: they are not tested here.

use crate::swimmers;

use std::collections::BTreeMap;

use gait_optimizer::{
    AtlasProblem, Branch, EfficiencyProblem, Objective, TurningProblem, atlas, efficiency, turning,
};
use swimmer_files::Bounds;
use swimmer_model::Swimmer;

/// Result of a search within some bounds.
#[derive(Debug, Clone, Copy, Default)]
struct Solution {
    /// Value of the gait; 0 without a gait.
    reached: f64,
    /// Largest value that is reported, certified or not.
    known: f64,
}

impl Solution {
    fn new(reached: f64, uncertified: f64) -> Self {
        let known = reached.max(uncertified);
        Self { reached, known }
    }
}

/// Comparisons of one kind of bound.
#[derive(Debug, Default)]
struct Row {
    compared: usize,
    /// Wider bounds with a lower value.
    lower: Vec<String>,
    /// Wider bounds without a gait.
    missing: Vec<String>,
}

#[derive(Debug, Default)]
struct Table {
    rows: BTreeMap<String, Row>,
}

impl Table {
    fn compare(&mut self, row: &str, tight: Solution, wide: Solution, what: &str) {
        const ALIKE: f64 = 1.0 - 1e-6;
        if tight.reached <= 0.0 {
            return;
        }
        let row = self.rows.entry(row.to_owned()).or_default();
        row.compared += 1;
        if wide.known < tight.reached * ALIKE {
            let fault = format!("{what}: {:.6} -> {:.6}", tight.reached, wide.known);
            if wide.known > 0.0 {
                row.lower.push(fault);
            } else {
                row.missing.push(fault);
            }
        }
    }

    fn print(&self) {
        for (name, row) in &self.rows {
            let (lower, missing) = (row.lower.len(), row.missing.len());
            println!(
                "{name:28} {:5} compared, {lower:4} lower, {missing:4} without a gait",
                row.compared
            );
            let faults = row.lower.iter().chain(&row.missing);
            faults.for_each(|what| println!("    {what}"));
        }
    }

    /// Every wider bound whose value is lower or missing.
    fn faults(&self) -> Vec<&String> {
        let rows = self.rows.values();
        rows.flat_map(|row| row.lower.iter().chain(&row.missing))
            .collect()
    }
}

/// Purcell's swimmer, the robot and ten at random.
fn twelve() -> Vec<(String, Swimmer<f64>)> {
    let mut swimmers = vec![
        ("purcell".to_owned(), Swimmer::purcell()),
        ("robot".to_owned(), Swimmer::robot()),
    ];
    let random = swimmers::random(20_261_123, 10).into_iter().enumerate();
    swimmers.extend(random.map(|(i, case)| (format!("random {i}"), case.swimmer)));
    // `RELAX=robot,random 3` selects these alone.
    if let Ok(names) = std::env::var("RELAX") {
        swimmers.retain(|(name, _)| names.split(',').any(|one| one == name));
    }
    swimmers
}

/// 1.2 to 3.0 rad.
fn upper() -> Vec<f64> {
    (12..=30).map(|tenth| 0.1 * f64::from(tenth)).collect()
}

/// Solutions as the largest angle grows, with crossing links and without.
fn widened(solve: impl Fn(&Swimmer<f64>, Bounds) -> Solution) -> Table {
    let mut table = Table::default();
    for (name, swimmer) in twelve() {
        for (row, no_overlap) in [
            ("max-angle up", false),
            ("max-angle up without overlap", true),
        ] {
            let within = |max_angle: f64| Bounds {
                max_angle: Some(max_angle),
                no_overlap,
                ..Bounds::default()
            };
            let solutions: Vec<_> = upper()
                .into_iter()
                .map(|max| (within(max), solve(&swimmer, within(max))))
                .collect();
            for [(_, tight), (bounds, wide)] in solutions.array_windows() {
                table.compare(row, *tight, *wide, &format!("{name}, {bounds}"));
            }
        }
    }
    table.print();
    table
}

/// A region of the curvature that grows across its border may have no simple border left to walk: that is an error, not a lower
/// value.
#[test]
#[ignore = "soak: a minute"]
fn relaxing_a_bound_never_lowers_turning() {
    let table = widened(|swimmer, bounds| {
        let found = turning(&TurningProblem {
            swimmer: *swimmer,
            bounds,
        });
        let rotation = match found {
            Ok(found) => found.gait.rotation.abs(),
            Err(error) => {
                println!("    {bounds}: {error}");
                0.0
            }
        };
        Solution::new(rotation, rotation)
    });
    let lower: Vec<_> = table.rows.values().flat_map(|row| &row.lower).collect();
    assert!(lower.is_empty(), "{lower:#?}");
}

/// The paper's gaits of most efficiency, by branch.
#[test]
#[ignore = "soak: minutes"]
fn relaxing_a_bound_never_lowers_efficiency() {
    for branch in [Branch::Small, Branch::Large] {
        println!("{branch:?}");
        let table = widened(|swimmer, bounds| {
            let found = efficiency(&EfficiencyProblem {
                bounds,
                ..EfficiencyProblem::new(*swimmer, branch)
            });
            let reached = found.map_or(0.0, |gait| gait.efficiency);
            Solution::new(reached, reached)
        });
        let faults = table.faults();
        assert!(faults.is_empty(), "{faults:#?}");
    }
}

/// The most efficient closed curves of any symmetry, uncertified ones included.
#[test]
#[ignore = "soak: an hour"]
fn relaxing_a_bound_never_lowers_an_atlas_of_efficiency() {
    let table = widened(|swimmer, bounds| {
        let found = atlas(&AtlasProblem {
            bounds,
            starts: 64,
            ..AtlasProblem::new(*swimmer, Objective::Efficiency)
        })
        .unwrap();
        let best = found.optima.first().map(|best| best.gait.efficiency);
        Solution::new(best.unwrap_or(0.0), found.best_uncertified.unwrap_or(0.0))
    });
    let faults = table.faults();
    assert!(faults.is_empty(), "{faults:#?}");
}
