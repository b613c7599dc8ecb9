//! What is told where gaits carry ever farther and none farthest: how far they come, one of them, and the gait that a user wants
//! instead, the fastest one.

use std::path::Path;

use gait_optimizer::{Fastest, Member, OptimalGait, Supremum};
use swimmer_files::Bounds;

use super::answer::tell_quarter;
use super::better::Better;
use super::{Found, Task};
use crate::document::{Document, object};
use crate::quantity;

/// How fast servos are taken to turn where the swimmer file does not say, rad/s.
const RATE: f64 = 1.0;

/// The answer: of these members the last carries farthest, and is what is written; a local optimum may have been found, which
/// they outdo.
pub(super) fn no_optimum(
    task: &Task,
    bounds: &Bounds,
    (supremum, farthest): (&Supremum, &Member),
    local: Option<&OptimalGait>,
) -> Found {
    let length = task.file.swimmer.total_length();
    let rate = task.file.servo.map_or(RATE, |servo| servo.max_rate);
    let priced = Better::fastest(task, bounds, rate);
    let instead = priced.as_ref().map_or_else(String::new, |priced| {
        format!("; the fastest gait exists: `{}`", priced.command)
    });
    let error = format!(
        "no gait within these bounds carries farthest: those that reach shapes off the bounds along ever narrower slits come up \
         to X/L = {:.6}, and none gets there{instead}",
        supremum.over_length
    );
    let displacement_m = farthest.displacement_over_length * length;
    let quarter = farthest.quarter.iter().map(|phi| [phi.x, phi.y]);
    let mut best_member = Document::default();
    best_member
        .key(
            "displacement_over_length",
            farthest.displacement_over_length,
        )
        .key("displacement_m", displacement_m)
        .key("gap_rad", farthest.gap)
        .key("links_cross", farthest.links_cross)
        // Joint angles along it, a polygon.
        .key("quarter", quarter.collect::<Vec<_>>())
        .key_if("gait", task.output.map(Path::to_owned));
    let member = |member: &Member| object! {"gap_rad": member.gap, "displacement_over_length": member.displacement_over_length};
    let members: Vec<_> = supremum.members.iter().map(member).collect();
    let mut answer = Document::new(format!("{}, no optimum of displacement", task.file.name));
    answer
        .key("error", error.clone())
        .key("exists", false)
        // What X/L of the members tends to, and how far off that may be.
        .key("supremum_over_length", supremum.over_length)
        .key("supremum_uncertainty_over_length", supremum.uncertainty)
        .key("best_member", best_member)
        .key("members", members)
        .row(
            "supremum",
            format!(
                "X/L = {:.6} (± {:.0e}), which no gait reaches",
                supremum.over_length, supremum.uncertainty
            ),
        );
    for member in &supremum.members {
        answer.row(
            "a gait",
            format!(
                "X/L = {:.6}, with slits {:.4} rad wide",
                member.displacement_over_length, member.gap
            ),
        );
    }
    answer.row(
        "the last of these",
        format!(
            "{} per cycle, links cross {}",
            quantity::length(displacement_m),
            quantity::crossing(farthest.links_cross)
        ),
    );
    let local_optimum = local.map(|gait| tell_outdone(&mut answer, gait));
    let priced = priced.map(|priced| tell_priced(&mut answer, rate, priced));
    answer
        .key("local_optimum", local_optimum)
        .key("priced", priced)
        .key("seconds", task.seconds.get());
    if let Some(path) = task.output {
        answer.row("the last written to", path.display().to_string());
    }
    Found {
        answer,
        gaits: vec![(String::new(), farthest.gait_file(&task.file.name))],
        failed: Some(error),
    }
}

/// Adds a line for a local optimum that is outdone; its keys.
fn tell_outdone(answer: &mut Document, gait: &OptimalGait) -> Document {
    answer.row(
        "outdone",
        format!(
            "a local optimum with X/L = {:.6}",
            gait.displacement_over_length
        ),
    );
    let mut keys = Document::default();
    tell_quarter(&mut keys, gait);
    keys.key("links_cross", gait.links_cross)
        .key("certificate", gait.certificate.clone());
    keys
}

/// Adds a line for the gait that a user wants instead, for servos of this rate; its keys.
fn tell_priced(answer: &mut Document, rate: f64, priced: Better<Fastest>) -> Document {
    let Better { command, gait } = priced;
    let displacement_m = gait.distance_over_length * gait.gait.swimmer.total_length();
    answer.row(
        "the fastest instead",
        format!(
            "`{command}`: {} per cycle in {:.2} s, {} off the mean heading",
            quantity::length(displacement_m),
            gait.period,
            quantity::angle(gait.heading)
        ),
    );
    object! {
        "command": command,
        "max_rate_rad_per_s": rate,
        "speed_over_length_per_s": gait.speed_over_length,
        "displacement_over_length": gait.distance_over_length,
        "displacement_m": displacement_m,
        "period_s": gait.period,
        "heading_rad": gait.heading,
    }
}
