//! Text of an atlas.

use operations::atlas::{AtlasOutput, FollowedOutput, OptimumOutput, speed};
use swimmer_files::Objective;

use super::continuation;
use crate::quantity;

/// Title of an atlas of displacement or efficiency.
pub(super) fn title(output: &AtlasOutput) -> String {
    format!("{}, atlas of {}", output.name, output.objective)
}

/// Title of an atlas of speed.
pub(super) fn speed_title(output: &speed::Output) -> String {
    format!("{}, atlas of speed", output.name)
}

/// Value of an optimum that the legend of the picture shows.
pub(super) fn value(objective: Objective, optimum: &OptimumOutput) -> String {
    match objective {
        Objective::Efficiency => format!("ξ = {:.4e}", optimum.efficiency),
        _ => format!("|d|/L = {:.5}", optimum.distance_over_length),
    }
}

/// Text of an atlas of displacement or efficiency.
pub(super) fn atlas(output: &AtlasOutput) -> String {
    let known = match output.known_starts {
        0 => String::new(),
        count => format!(" and {count} from known gaits"),
    };
    let mut lines = vec![format!(
        "{}: {} random starts{known}",
        title(output),
        output.starts
    )];
    let speed = if output.optima.iter().any(|optimum| optimum.pace.is_some()) {
        "|d|/(L T) 1/s  "
    } else {
        ""
    };
    lines.push(format!(
        "  no   |d|/L          efficiency ξ     {speed}simple symmetric found  links cross"
    ));
    let optima = output.optima.iter().enumerate();
    lines.extend(optima.map(|(number, optimum)| line(number + 1, optimum)));
    let best = output.best_uncertified.map_or_else(String::new, |best| {
        let of = match output.objective {
            Objective::Efficiency => "ξ",
            _ => "|d|/L",
        };
        format!(" (the best of these {of} = {best:.7}, uncertified)")
    });
    lines.push(format!(
        "  not listed: {} starts settled nowhere, {} left the shapes searched, {} ended where no gait could be certified{best}",
        output.unsettled, output.left, output.uncertified
    ));
    lines.extend(output.continuation.as_ref().map(continuation::text));
    if let Some(picture) = &output.picture {
        lines.push(format!("  drawn in {}", picture.display()));
    }
    lines.join("\n")
}

/// Line of one optimum.
fn line(number: usize, optimum: &OptimumOutput) -> String {
    let pace = optimum.pace.map_or_else(String::new, |pace| {
        format!("{:.10}   ", pace.speed_over_length_per_s)
    });
    let yes = |value: bool| if value { "yes" } else { "no" };
    format!(
        "  {number:<3}  {:.10}   {:.10}     {pace}{:<6} {:<9} {:<6} {}",
        optimum.distance_over_length,
        optimum.efficiency,
        yes(optimum.simple),
        yes(optimum.symmetric),
        optimum.found,
        quantity::crossing(optimum.links_cross),
    )
}

/// Text of gaits that are followed without an atlas.
pub(super) fn followed(output: &FollowedOutput) -> String {
    format!(
        "{}, {}: {}",
        output.name,
        output.objective,
        continuation::text(&output.continuation)
    )
}

/// Text of an atlas of speed.
pub(super) fn of_speed(output: &speed::Output) -> String {
    let mut lines = vec![
        format!("{}: {} starts", speed_title(output), output.starts),
        "  no   |d|/(L T) 1/s    |d|/L          period s     leads       found  links cross"
            .to_owned(),
    ];
    let optima = output.optima.iter().enumerate();
    lines.extend(optima.map(|(number, fastest)| {
        format!(
            "  {:<3}  {:.10}   {:.10}   {:<10.6}   {:<9}   {:<6} {}",
            number + 1,
            fastest.speed_over_length_per_s,
            fastest.displacement_over_length,
            fastest.period_s,
            quantity::angle(fastest.heading_rad),
            fastest.found,
            quantity::crossing(fastest.links_cross),
        )
    }));
    let best = output.best_uncertified.map_or_else(String::new, |best| {
        format!(" (the fastest |d|/(L T) = {best:.7} 1/s)")
    });
    lines.push(format!(
        "  not listed: chains of arcs that could not be certified: {}{best}; with too many corners: {}",
        output.uncertified, output.longer
    ));
    if let Some(picture) = &output.picture {
        lines.push(format!("  drawn in {}", picture.display()));
    }
    lines.join("\n")
}
