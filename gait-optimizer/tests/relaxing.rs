//! Relaxing a bound never lowers the answer: what fits within a bound fits within a wider one. Twelve swimmers, both directions,
//! bounds in small steps. Where no optimum exists the answer is a supremum, of gaits that are at hand; each is counted.

#[expect(dead_code, reason = "bounds and simple gaits are for others")]
mod swimmers;

use std::collections::BTreeMap;

use gait_optimizer::{
    AtlasProblem, Branch, DisplacementError, DisplacementProblem, EfficiencyProblem, Heading,
    Objective, SidewaysProblem, Suprema, TurningProblem, atlas, displacement, efficiency, sideways,
    turning,
};
use swimmer_files::Bounds;
use swimmer_model::Swimmer;

/// |X| over L.
#[derive(Debug, Clone, Copy, Default)]
struct Answer {
    /// Of a gait: the optimum, or the best member where none exists; 0 for no answer.
    reached: f64,
    /// Of the farthest gait that the answer tells of, or of the supremum.
    known: f64,
    exists: bool,
}

impl Answer {
    fn optimum(reached: f64, known: f64) -> Self {
        Self {
            reached,
            known: reached.max(known),
            exists: true,
        }
    }
}

fn answer(
    suprema: &mut Suprema,
    swimmer: Swimmer<f64>,
    bounds: Bounds,
    heading: Heading,
) -> Answer {
    let problem = DisplacementProblem {
        bounds,
        heading: Some(heading),
        ..DisplacementProblem::new(swimmer)
    };
    let found = displacement(&problem);
    if let Err(error) = &found
        && !matches!(
            error,
            DisplacementError::NoOptimum { .. }
                | DisplacementError::NotCertified { .. }
                | DisplacementError::Saddle { .. }
        )
    {
        return Answer::default();
    }
    // A saddle among all closed curves is a gait all the same, and the best of its symmetry.
    let local = match &found {
        Ok(gait) => Some(gait),
        Err(DisplacementError::Saddle { gait }) => Some(&**gait),
        Err(_) => None,
    };
    if let Some(supremum) = suprema.of(&problem, local) {
        let best = supremum
            .members
            .last()
            .map(|best| best.displacement_over_length.abs());
        return Answer {
            reached: best.unwrap_or(0.0),
            known: supremum.over_length.abs(),
            exists: false,
        };
    }
    local.map_or(Answer::default(), |gait| {
        Answer::optimum(
            gait.displacement_over_length.abs(),
            gait.outdone_over_length.unwrap_or(0.0).abs(),
        )
    })
}

/// A way to relax a bound.
#[derive(Debug, Default)]
struct Row {
    asked: usize,
    /// No optimum exists within the wider bound.
    limits: usize,
    /// The wider bound's answer is lower than the tighter one's gait.
    lower: Vec<String>,
    /// Within the wider bound there is no answer, though there is a gait within the tighter one.
    none: Vec<String>,
}

#[derive(Debug, Default)]
struct Table {
    rows: BTreeMap<String, Row>,
}

impl Table {
    fn compare(&mut self, row: &str, tight: Answer, wide: Answer, what: &str) {
        const ALIKE: f64 = 1.0 - 1e-6;
        if tight.reached <= 0.0 {
            return;
        }
        let row = self.rows.entry(row.to_owned()).or_default();
        row.asked += 1;
        row.limits += usize::from(!wide.exists && wide.known > 0.0);
        if wide.known < tight.reached * ALIKE {
            let told = format!("{what}: {:.6} -> {:.6}", tight.reached, wide.known);
            if wide.known > 0.0 {
                row.lower.push(told);
            } else {
                row.none.push(told);
            }
        }
    }

    fn print(&self) {
        for (name, row) in &self.rows {
            let (lower, none) = (row.lower.len(), row.none.len());
            println!(
                "{name:28} {:5} asked, {lower:4} lower, {none:4} without an answer, {:4} suprema",
                row.asked, row.limits
            );
            let faults = row.lower.iter().chain(&row.none);
            faults.for_each(|what| println!("    {what}"));
        }
    }

    /// Every answer that is lower, or is none.
    fn faults(&self) -> Vec<&String> {
        let rows = self.rows.values();
        rows.flat_map(|row| row.lower.iter().chain(&row.none))
            .collect()
    }

    /// All bounds of one swimmer that heads one way.
    fn fill(&mut self, name: &str, swimmer: Swimmer<f64>, heading: Heading, upper: &[f64]) {
        let mut known: BTreeMap<String, Answer> = BTreeMap::new();
        let mut suprema = Suprema::new(1);
        let mut ask = |bounds: Bounds| {
            let key = format!("{bounds:?}");
            *known
                .entry(key)
                .or_insert_with(|| answer(&mut suprema, swimmer, bounds, heading))
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
    // `RELAX=robot,random 3` asks these alone.
    if let Ok(told) = std::env::var("RELAX") {
        swimmers.retain(|(name, _)| told.split(',').any(|one| one == name));
    }
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
    let faults = table.faults();
    assert!(faults.is_empty(), "{faults:#?}");
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
        Answer::optimum(rotation, rotation)
    });
    let lower: Vec<_> = table.rows.values().flat_map(|row| &row.lower).collect();
    assert!(lower.is_empty(), "{lower:#?}");
}

/// Loops with their best first sample; what is outdone by a gait that touches itself says so.
#[test]
#[ignore = "soak: a quarter of an hour"]
fn relaxing_a_bound_never_lowers_sideways() {
    let table = widened(|swimmer, bounds| {
        let problem = SidewaysProblem {
            bounds,
            starts: 16,
            ..SidewaysProblem::new(*swimmer)
        };
        let Ok(found) = sideways(&problem, &|_| ()) else {
            return Answer::default();
        };
        let optimum = found.lateral_over_length;
        Answer::optimum(optimum, found.outdone_over_length.unwrap_or(0.0))
    });
    let faults = table.faults();
    assert!(faults.is_empty(), "{faults:#?}");
}

/// The paper's gaits of most efficiency, by branch: with its symmetries, so certified or none.
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
            Answer::optimum(reached, reached)
        });
        let faults = table.faults();
        assert!(faults.is_empty(), "{faults:#?}");
    }
}

/// The best of closed curves of any symmetry; what is best but uncertified is told.
fn widened_atlas(objective: Objective) {
    let table = widened(|swimmer, bounds| {
        let found = atlas(&AtlasProblem {
            bounds,
            starts: 64,
            ..AtlasProblem::new(*swimmer, objective)
        })
        .unwrap();
        let best = found.optima.first().map(|best| match objective {
            Objective::Efficiency => best.gait.efficiency,
            _ => best.distance_over_length,
        });
        Answer::optimum(best.unwrap_or(0.0), found.best_uncertified.unwrap_or(0.0))
    });
    let faults = table.faults();
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
#[ignore = "soak: an hour"]
fn relaxing_a_bound_never_lowers_an_atlas_of_displacement() {
    widened_atlas(Objective::Displacement);
}

#[test]
#[ignore = "soak: an hour"]
fn relaxing_a_bound_never_lowers_an_atlas_of_efficiency() {
    widened_atlas(Objective::Efficiency);
}

/// The robot's own gaits, where touching its images once decided from bound to bound: no answer is lower.
#[test]
fn the_robots_answers_grow() {
    let mut suprema = Suprema::new(2);
    let mut before = 0.0;
    for step in (2..18).rev() {
        let bounds = Bounds {
            max_angle: Some(2.8),
            min_angle: Some(0.1 * f64::from(step)),
            ..Bounds::default()
        };
        let here = answer(&mut suprema, Swimmer::robot(), bounds, Heading::Backwards).reached;
        assert!(here > before, "{bounds}: {here} after {before}");
        before = here;
    }
    assert!((before - 0.161_9).abs() < 5e-4, "{before}");
}

/// Gaits of a slit that narrow bounds alone lead to: from rung to rung, without crossing links, they carry ever farther.
#[test]
fn purcells_suprema_grow_as_the_least_angle_falls() {
    let mut suprema = Suprema::new(2);
    let mut before = 0.0;
    for tenth in [11, 10, 9] {
        let bounds = Bounds {
            max_angle: Some(2.8),
            min_angle: Some(0.1 * f64::from(tenth)),
            no_overlap: true,
            ..Bounds::default()
        };
        let here = answer(&mut suprema, Swimmer::purcell(), bounds, Heading::Backwards);
        assert!(
            !here.exists && here.reached > before,
            "{bounds}: {here:?} after {before}"
        );
        before = here.reached;
    }
    assert!(before > 0.256, "{before}");
}

/// A wider bound has no optimum near the tighter one's, which is told; bounds that leave nothing tighter are bounds all the same.
#[test]
fn an_atlas_knows_what_tighter_bounds_bring() {
    let of = |swimmer: Swimmer<f64>, max_angle: f64, starts: usize| {
        let problem = AtlasProblem {
            bounds: Bounds::within(max_angle),
            starts,
            ..AtlasProblem::new(swimmer, Objective::Displacement)
        };
        atlas(&problem).unwrap()
    };
    let unlike = swimmers::random(20_261_123, 1)[0].swimmer;
    let tight = of(unlike, 2.3, 64).optima[0].distance_over_length;
    let wide = of(unlike, 2.4, 64);
    assert!(wide.optima[0].distance_over_length < 0.8 * tight);
    assert!(
        wide.best_uncertified.unwrap() >= tight * (1.0 - 1e-6),
        "{tight}"
    );
    assert!(!of(Swimmer::robot(), 0.05, 4).optima.is_empty());
}
