//! A gait of a wider class that is known to be better, and the command that gives it.

use std::cmp::Ordering;
use std::fmt::Write as _;

use gait_optimizer::{
    AtlasProblem, Branch, DisplacementProblem, EfficiencyProblem, Heading, Objective, OptimalGait,
    StartCurves, atlas, displacement, efficiency,
};
use serde::Serialize;
use swimmer_files::Bounds;

use crate::quantity::{self, Rows};

/// What is less better is the same gait.
const BETTER: f64 = 1e-6;
/// Starts of the look beyond the paper's symmetries, a thread each.
const OFF_CENTRE: usize = 4;

/// The better gait.
#[derive(Debug, Serialize)]
pub(super) struct Better {
    command: String,
    displacement_over_length: f64,
    displacement_m: f64,
    efficiency: f64,
    links_cross: f64,
    #[serde(skip)]
    by_efficiency: bool,
}

impl Better {
    fn new(command: String, gait: &OptimalGait, by_efficiency: bool) -> Self {
        Self {
            command,
            displacement_over_length: gait.displacement_over_length,
            displacement_m: gait.displacement,
            efficiency: gait.efficiency,
            links_cross: gait.links_cross,
            by_efficiency,
        }
    }

    /// A line for people.
    pub(super) fn row(&self, rows: &mut Rows) {
        let value = if self.by_efficiency {
            format!("ξ = {:.6}", self.efficiency)
        } else {
            format!("X = {}", quantity::length(self.displacement_m))
        };
        rows.row(
            "known to be better",
            format!(
                "`{}`: {value}, links cross {}",
                self.command,
                quantity::crossing(self.links_cross)
            ),
        );
    }
}

/// The gait that carries farthest, either way, within the same bounds on shapes, without those on the quarter: a wider bound never
/// lowers the answer.
pub(super) fn than_displacement(
    problem: &DisplacementProblem,
    name: &str,
    found: &OptimalGait,
) -> Option<Better> {
    let wide = |heading| DisplacementProblem {
        bounds: Bounds {
            sector: false,
            min_angle: None,
            ..problem.bounds
        },
        heading: Some(heading),
        simple: false,
        ..*problem
    };
    let best = [Heading::Forwards, Heading::Backwards]
        .map(wide)
        .into_iter()
        .filter(|other| {
            // Unless that is the problem just solved.
            let found_there =
                (other.heading == Some(Heading::Forwards)) == (found.displacement > 0.0);
            !(found_there && other.bounds == problem.bounds && !problem.simple)
        })
        .filter_map(|other| Some((displacement(&other).ok()?, other)))
        .max_by(|(a, _), (b, _)| a.displacement.abs().total_cmp(&b.displacement.abs()))?;
    let (gait, other) = best;
    (gait.displacement.abs() > found.displacement.abs() * (1.0 + BETTER)).then(|| {
        let heading = other.heading.map(|heading| match heading {
            Heading::Forwards => "+",
            Heading::Backwards => "-",
        });
        let command = command(
            "optimize displacement",
            name,
            &other.bounds,
            heading.map(|sign| ("--sign", sign)),
        );
        Better::new(command, &gait, false)
    })
}

/// The more efficient gait within the same bounds: of the other name, or a loop off the straight swimmer, without the paper's
/// symmetries.
pub(super) fn than_efficiency(
    problem: &EfficiencyProblem,
    name: &str,
    found: &OptimalGait,
) -> Option<Better> {
    let (branch, word) = match problem.branch {
        Branch::Small => (Branch::Large, "large"),
        Branch::Large => (Branch::Small, "small"),
    };
    let other = efficiency(&EfficiencyProblem { branch, ..*problem }).ok();
    let off_centre = atlas(&AtlasProblem {
        bounds: problem.bounds,
        starts: OFF_CENTRE,
        from: StartCurves::OffCentre,
        threads: OFF_CENTRE,
        ..AtlasProblem::new(problem.swimmer, Objective::Efficiency)
    });
    let off_centre = off_centre
        .ok()
        .and_then(|atlas| Some(atlas.optima.first()?.gait.clone()));
    let by_name = other.map(|gait| (gait, "optimize efficiency", Some(("--gait", word))));
    let by_atlas = off_centre.map(|gait| (gait, "atlas --objective efficiency", None));
    let (gait, named, more) = by_atlas
        .into_iter()
        .chain(by_name)
        // The atlas holds the gaits of both names, too: of two that are alike the last, quicker command is told.
        .max_by(|(a, ..), (b, ..)| {
            let alike = (a.efficiency / b.efficiency - 1.0).abs() < BETTER;
            if alike {
                Ordering::Less
            } else {
                a.efficiency.total_cmp(&b.efficiency)
            }
        })?;
    (gait.efficiency > found.efficiency * (1.0 + BETTER))
        .then(|| Better::new(command(named, name, &problem.bounds, more), &gait, true))
}

/// The command that finds a gait within these bounds.
pub(super) fn command(
    named: &str,
    name: &str,
    bounds: &Bounds,
    more: Option<(&str, &str)>,
) -> String {
    let mut words = format!("swimmer {named} --swimmer {name}");
    // Writing to a String cannot fail.
    for (flag, value) in [
        ("--max-angle", bounds.max_angle),
        ("--min-angle", bounds.min_angle),
    ] {
        if let Some(value) = value {
            let _ = write!(words, " {flag} {value}");
        }
    }
    if bounds.sector {
        words.push_str(" --sector");
    }
    if bounds.clearance > 0.0 {
        let _ = write!(words, " --clearance {}", bounds.clearance);
    } else if bounds.no_overlap {
        words.push_str(" --no-overlap");
    }
    if let Some((flag, value)) = more {
        let _ = write!(words, " {flag} {value}");
    }
    words
}
