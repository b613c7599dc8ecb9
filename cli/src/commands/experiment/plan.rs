//! `swimmer experiment plan`: gaits computed, order of the trials fixed.

use std::fmt;
use std::path::Path;

use experiment::unattended::{Plan, Spec};
use serde::Serialize;
use swimmer_files::{ServoFile, SwimmerFile};

use super::ExperimentPaths;
use super::folder::{PLAN, SPEC, SWIMMER, read, write_plan};
use super::gaits::{Maker, drive};
use crate::failure::{Failure, Outcome};
use crate::new_folder::NewFolder;
use crate::output::{Output, aside};
use crate::quantity;

/// Compute the gaits of an experiment and fix the order of its trials
///
/// The folder holds the plan, every gait as a gait file, and the swimmer, so that what is played cannot change any more. The order
/// depends on the spec's seed alone.
#[derive(Debug, clap::Args)]
pub(crate) struct PlanSpec {
    #[command(flatten)]
    paths: ExperimentPaths,
}

/// Planned experiment.
#[derive(Debug, Serialize)]
pub(crate) struct PlanOutput {
    folder: String,
    runs: usize,
    tank_time_s: f64,
    plan_sha256: String,
    #[serde(flatten)]
    plan: Plan,
}

impl PlanSpec {
    pub(super) fn run(self, output: Output) -> Outcome {
        output.print(&plan(&self.paths)?);
        Ok(())
    }
}

/// Computes the gaits of an experiment, fixes the order of its trials, and writes its folder.
///
/// # Errors
/// An invalid spec, a gait that cannot be found or played, and a disk that refuses.
pub(crate) fn plan(paths: &ExperimentPaths) -> Outcome<PlanOutput> {
    let text = read(&paths.spec)?;
    let spec = Spec::parse(&text, &paths.spec)?;
    let home = paths.spec.parent().unwrap_or_else(|| Path::new(""));
    let mut swimmer = SwimmerFile::find_from(&spec.swimmer, home)?;
    if swimmer.servo.is_none() {
        // Plan, report, campaign and fit then start from the same servos: a fit without them takes the servos as ideal.
        let servo = swimmer.servo.insert(ServoFile::default());
        aside(&format!(
            "note: {} names no [servo]; the servos of the twin are assumed, with a dead band of {}. `swimmer robot setup` measures yours.",
            spec.swimmer,
            quantity::angle(servo.dead_band)
        ));
    }
    let folder = NewFolder::start(&paths.folder())?;
    let draft = folder.draft().to_path_buf();
    for inner in ["gaits", "tracks", "logs"] {
        std::fs::create_dir_all(draft.join(inner)).map_err(|error| {
            Failure::Tried(format!(
                "cannot make a folder in {}: {error}",
                draft.display()
            ))
        })?;
    }
    swimmer.save(&draft.join(SWIMMER))?;
    swimmer_files::write_atomically(&draft.join(SPEC), text.as_bytes())?;
    let maker = Maker::new(&spec, home, &draft, &swimmer)?;
    drive(&maker, &swimmer)?;
    let (gaits, left_out) = maker.all()?;
    let plan = spec.plan(&text, gaits, left_out);
    write_plan(&draft.join(PLAN), &plan)?;
    let place = folder.place().display().to_string();
    folder.publish()?;
    Ok(PlanOutput {
        folder: place,
        runs: plan.trials.len(),
        tank_time_s: tank_time_s(&plan),
        plan_sha256: plan.sha256(),
        plan,
    })
}

/// Time of all plays and rests, without the ways to the start pose \[s\].
fn tank_time_s(plan: &Plan) -> f64 {
    let seconds = plan.trials.iter().filter_map(|trial| {
        let gait = plan.gait(trial)?;
        Some(plan.settle_s + f64::from(plan.run_in + gait.cycles) * gait.period_s)
    });
    seconds.sum()
}

impl fmt::Display for PlanOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(adaptive) = &self.plan.adaptive {
            writeln!(
                f,
                "An adaptive campaign of {} gaits to χ ± {} % and r_s ± {} in at most {} h of rests and plays, planned in {}",
                self.plan.gaits.len(),
                100.0 * adaptive.chi_share,
                quantity::length(adaptive.sphere_radius_m),
                adaptive.budget_s / 3600.0,
                self.folder
            )?;
        } else {
            writeln!(
                f,
                "{} trials of {} gaits in {} blocks, {:.1} h of plays and rests, planned in {}",
                self.runs,
                self.plan.gaits.len(),
                self.plan.repeats,
                self.tank_time_s / 3600.0,
                self.folder
            )?;
        }
        for gait in &self.plan.gaits {
            writeln!(
                f,
                "  {:14} {} per cycle of {} s, {} cycles",
                gait.name,
                quantity::length(gait.predicted_m()),
                gait.period_s,
                gait.cycles
            )?;
        }
        for left_out in &self.plan.left_out {
            writeln!(f, "  {:14} left out: {}", left_out.gait, left_out.reason)?;
        }
        f.write_str("`swimmer experiment run` plays them.")
    }
}
