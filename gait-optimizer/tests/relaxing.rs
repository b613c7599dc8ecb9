//! Relaxing a bound never lowers the answer: what fits within a bound fits within a wider one. Twelve swimmers, both directions,
//! bounds in small steps. An answer that is outdone by a gait without an optimum says so; it is counted, and may be lower than
//! that of a tighter bound, but what it says must not be.

#[expect(dead_code, reason = "bounds and simple gaits are for others")]
mod swimmers;

use std::collections::BTreeMap;

use gait_optimizer::{
    DisplacementError, DisplacementProblem, Heading, SidewaysProblem, TurningProblem, displacement,
    sideways, turning,
};
use swimmer_files::Bounds;
use swimmer_model::Swimmer;

/// |X| over L.
#[derive(Debug, Clone, Copy, Default)]
struct Answer {
    /// Of the optimum; 0 for none.
    optimum: f64,
    /// Of the farthest gait that the answer tells of, optimum or not.
    known: f64,
}

fn answer(swimmer: Swimmer<f64>, bounds: Bounds, heading: Heading) -> Answer {
    let problem = DisplacementProblem {
        bounds,
        heading: Some(heading),
        ..DisplacementProblem::new(swimmer)
    };
    let (optimum, outdone) = match displacement(&problem) {
        Ok(gait) => (
            gait.displacement_over_length.abs(),
            gait.outdone_over_length,
        ),
        Err(DisplacementError::NoOptimum { outdone, .. }) => (0.0, outdone),
        Err(_) => (0.0, None),
    };
    Answer {
        optimum,
        known: optimum.max(outdone.unwrap_or(0.0).abs()),
    }
}

/// A way to relax a bound.
#[derive(Debug, Default)]
struct Row {
    asked: usize,
    /// The wider bound's optimum is lower than the tighter one's, or there is none.
    lower: Vec<String>,
    /// And the answer does not tell of a gait as good.
    unsaid: Vec<String>,
}

#[derive(Debug, Default)]
struct Table {
    rows: BTreeMap<String, Row>,
}

impl Table {
    fn compare(&mut self, row: &str, tight: Answer, wide: Answer, what: &str) {
        const ALIKE: f64 = 1.0 - 1e-6;
        if tight.optimum <= 0.0 {
            return;
        }
        let row = self.rows.entry(row.to_owned()).or_default();
        row.asked += 1;
        if wide.optimum < tight.optimum * ALIKE {
            let told = format!("{what}: {:.6} -> {:.6}", tight.optimum, wide.optimum);
            if wide.known < tight.optimum * ALIKE {
                row.unsaid.push(told.clone());
            }
            row.lower.push(told);
        }
    }

    fn print(&self) {
        for (name, row) in &self.rows {
            let (lower, unsaid) = (row.lower.len(), row.unsaid.len());
            println!(
                "{name:24} {:5} asked, {lower:4} lower, {unsaid:4} of them unsaid",
                row.asked
            );
            row.lower.iter().for_each(|what| println!("    {what}"));
        }
    }

    /// All bounds of one swimmer that heads one way.
    fn fill(&mut self, name: &str, swimmer: Swimmer<f64>, heading: Heading, upper: &[f64]) {
        let mut known: BTreeMap<String, Answer> = BTreeMap::new();
        let mut ask = |bounds: Bounds| {
            let key = format!("{bounds:?}");
            *known
                .entry(key)
                .or_insert_with(|| answer(swimmer, bounds, heading))
        };
        for (kind, sector, no_overlap) in [
            ("", false, false),
            (" in the sector", true, false),
            (" without overlap", false, true),
        ] {
            let of = |max_angle: f64, min_angle: Option<f64>| Bounds {
                max_angle: Some(max_angle),
                min_angle,
                sector,
                no_overlap,
                ..Bounds::default()
            };
            let free = |bounds: Bounds| Bounds {
                sector: false,
                ..bounds
            };
            let told = |bounds: Bounds| format!("{name}, {heading}, {bounds}");
            for pair in upper.windows(2) {
                let [less, more] = [pair[0], pair[1]].map(|max| of(max, None));
                let row = format!("max-angle up{kind}");
                self.compare(&row, ask(less), ask(more), &told(more));
                self.compare("drop sector", ask(more), ask(free(more)), &told(more));
            }
            for max in [2.0, 2.4, 2.8] {
                for step in (2..18).rev() {
                    let min = 0.1 * f64::from(step);
                    let [more, less] = [min + 0.1, min].map(|min| of(max, Some(min)));
                    let row = format!("min-angle down{kind}");
                    self.compare(&row, ask(more), ask(less), &told(less));
                    let none = of(max, None);
                    self.compare("drop min-angle", ask(less), ask(none), &told(less));
                    self.compare("drop sector", ask(less), ask(free(less)), &told(less));
                }
            }
        }
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
    swimmers
}

/// 1.2 to 3.0 rad.
fn upper() -> Vec<f64> {
    (12..=30).map(|tenth| 0.1 * f64::from(tenth)).collect()
}

#[test]
#[ignore = "soak: half an hour"]
fn relaxing_a_bound_never_lowers_displacement() {
    let mut table = Table::default();
    for (name, swimmer) in twelve() {
        for heading in [Heading::Forwards, Heading::Backwards] {
            table.fill(&name, swimmer, heading, &upper());
        }
        table.print();
    }
    let unsaid: Vec<_> = table.rows.values().flat_map(|row| &row.unsaid).collect();
    assert!(unsaid.is_empty(), "{unsaid:#?}");
}

/// Answers of an objective as the largest angle grows, with crossing links and without.
fn widened(ask: impl Fn(&Swimmer<f64>, Bounds) -> Answer) -> Table {
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
            let answers: Vec<_> = upper()
                .into_iter()
                .map(|max| (within(max), ask(&swimmer, within(max))))
                .collect();
            for pair in answers.windows(2) {
                let [(_, tight), (bounds, wide)] = [pair[0], pair[1]];
                table.compare(row, tight, wide, &format!("{name}, {bounds}"));
            }
        }
    }
    table.print();
    table
}

/// Rotation instead of displacement. A region of the curvature that grows across its border may have no simple border left to
/// walk: no answer, which is an error and not a lower one.
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
        Answer {
            optimum: rotation,
            known: rotation,
        }
    });
    let lower: Vec<_> = table.rows.values().flat_map(|row| &row.lower).collect();
    assert!(lower.is_empty(), "{lower:#?}");
}

/// Loops with their best first sample; what is outdone by a gait that touches itself says so.
#[test]
#[ignore = "soak: a quarter of an hour"]
fn relaxing_a_bound_never_lowers_sideways() {
    let table = widened(|swimmer, bounds| {
        let found = sideways(&SidewaysProblem {
            bounds,
            starts: 16,
            ..SidewaysProblem::new(*swimmer)
        });
        let Ok(found) = found else {
            return Answer::default();
        };
        let optimum = found.lateral_over_length;
        Answer {
            optimum,
            known: optimum.max(found.outdone_over_length.unwrap_or(0.0)),
        }
    });
    let unsaid: Vec<_> = table.rows.values().flat_map(|row| &row.unsaid).collect();
    assert!(unsaid.is_empty(), "{unsaid:#?}");
}

/// The robot's own gaits, where touching its images once decided from bound to bound: no answer is lower.
#[test]
fn the_robots_answers_grow() {
    let mut before = 0.0;
    for step in (2..18).rev() {
        let bounds = Bounds {
            max_angle: Some(2.8),
            min_angle: Some(0.1 * f64::from(step)),
            ..Bounds::default()
        };
        let here = answer(Swimmer::robot(), bounds, Heading::Backwards).optimum;
        assert!(here > before, "{bounds}: {here} after {before}");
        before = here;
    }
    assert!((before - 0.161_9).abs() < 5e-4, "{before}");
}
