//! A gait of a wider class that is known to be better, and the command that gives it.

use std::cmp::Ordering;
use std::fmt::Write as _;

use gait_optimizer::{
    AtlasProblem, Branch, DisplacementProblem, EfficiencyProblem, Fastest, Heading, Objective,
    OptimalGait, SpeedProblem, StartCurves, atlas, displacement, efficiency, fastest,
};
use swimmer_files::Bounds;

use super::Task;
use crate::document::{Document, object};
use crate::quantity;
use crate::threads;

/// What is less better is the same gait.
const BETTER: f64 = 1e-6;
/// Starts of the look beyond the paper's symmetries, a thread each.
const OFF_CENTRE: usize = 4;

/// A better gait with its command.
#[derive(Debug)]
pub(super) struct Better<G = OptimalGait> {
    pub(super) command: String,
    pub(super) gait: G,
}

impl Better {
    /// Adds it to the answer of a gait for efficiency, or for displacement.
    pub(super) fn tell(&self, answer: &mut Document, by_efficiency: bool) {
        let Self { command, gait } = self;
        let value = if by_efficiency {
            format!("ξ = {:.6}", gait.efficiency)
        } else {
            format!("X = {}", quantity::length(gait.displacement))
        };
        let crossing = quantity::crossing(gait.links_cross);
        answer
            .key(
                "better",
                object! {
                    "command": command.clone(),
                    "displacement_over_length": gait.displacement_over_length,
                    "displacement_m": gait.displacement,
                    "efficiency": gait.efficiency,
                    "links_cross": gait.links_cross,
                },
            )
            .row(
                "known to be better",
                format!("`{command}`: {value}, links cross {crossing}"),
            );
    }
}

impl Better<Fastest> {
    /// The fastest gait for servos of this rate \[rad/s\] within the same bounds on whole cycles: those on quarters make no sense
    /// for it. None where none is found.
    pub(super) fn fastest(task: &Task, bounds: &Bounds, rate: f64) -> Option<Self> {
        let bounds = Bounds {
            min_angle: None,
            sector: false,
            ..*bounds
        };
        let gait = fastest(&SpeedProblem {
            bounds,
            threads: threads::available(),
            ..SpeedProblem::new(task.file.swimmer, [rate; 2])
        })
        .ok()?;
        let rate = rate.to_string();
        let more = Some(("--max-rate", rate.as_str()));
        let command = command("optimize speed", task.swimmer, &bounds, more);
        Some(Self { command, gait })
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
        Better { command, gait }
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
    (gait.efficiency > found.efficiency * (1.0 + BETTER)).then(|| Better {
        command: command(named, name, &problem.bounds, more),
        gait,
    })
}

/// The command that finds a gait within these bounds.
fn command(named: &str, name: &str, bounds: &Bounds, more: Option<(&str, &str)>) -> String {
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
