//! Output of `swimmer plan`.

use std::path::PathBuf;

use crate::document::{Document, object};
use crate::quantity;

/// The answer. The plan's swimmer with χ 5 % lower, and higher, comes this far \[m, rad\] from where the plan leads, if it has a χ; the gaits are
/// named by their files, where the plan was written.
pub(super) fn answer(
    name: &str,
    plan: &forecast::Plan,
    off_if_chi_is: Option<[[f64; 2]; 2]>,
    gaits: Option<Vec<String>>,
    playlist: Option<PathBuf>,
) -> Document {
    let gaits = gaits.unwrap_or_default();
    let mut answer = Document::new(format!(
        "{name}: the quickest plan found takes {:.1} s",
        plan.duration
    ));
    let mut steps = Vec::new();
    for (at, step) in plan.steps.iter().enumerate() {
        let named = || plan.word(step).to_owned();
        let gait = gaits.get(at).cloned().unwrap_or_else(named);
        let (cycles, period, scale) = (step.cycles, step.period, step.member.scale);
        answer.row(
            gait.clone(),
            format!(
                "{cycles} cycles of {period:.3} s, at {:.2} % of its size",
                scale * 100.0
            ),
        );
        // The scale is the share of the way from the common shape.
        steps.push(object! {"gait": gait, "cycles": cycles, "period_s": period, "scale": scale});
    }
    let reached = &plan.reached;
    let off = |[distance, angle]: [f64; 2]| {
        format!(
            "{} and {} off",
            quantity::length(distance),
            quantity::angle(angle)
        )
    };
    let off_keys =
        |[distance, angle]: [f64; 2]| object! {"distance_m": distance, "angle_rad": angle};
    // Chains of legs that meet the target, and those that the walls leave.
    let [chains, within_walls] = plan.met;
    answer
        .key("steps", steps)
        .key("duration_s", plan.duration)
        .key(
            "reached",
            object! {"x_m": reached.x, "y_m": reached.y, "heading_rad": reached.theta},
        )
        // From the target, in the model.
        .key("off_m", plan.off[0])
        .key("off_rad", plan.off[1])
        .key_if(
            "off_if_chi_is_5_percent_lower",
            off_if_chi_is.map(|[lower, _]| off_keys(lower)),
        )
        .key_if(
            "off_if_chi_is_5_percent_higher",
            off_if_chi_is.map(|[_, higher]| off_keys(higher)),
        )
        .key("chains", chains)
        .key("chains_within_walls", within_walls)
        .row(
            "reaches",
            format!(
                "({}, {}), heading {}: {:.1e} m off",
                quantity::length(reached.x),
                quantity::length(reached.y),
                quantity::angle(reached.theta),
                plan.off[0]
            ),
        );
    if let Some([lower, higher]) = off_if_chi_is {
        answer
            .row("χ 5 % lower", off(lower))
            .row("χ 5 % higher", off(higher));
    }
    answer.row(
        "found",
        format!("{chains} chains meet the target, {within_walls} of them within the walls"),
    );
    if let Some(path) = playlist {
        answer.row("written to", path.display().to_string());
        answer.key("playlist", path);
    }
    answer
}
