//! `--robust FIT.json` and `--gain LOW HIGH`: the gait for an uncertain robot.

use std::path::PathBuf;

use clap::ValueEnum;
use operations::fit_file::FitSource;
use operations::optimize::robust::{Output, Request, RobustnessOutput, Statistic};

use super::text::{add_gait, add_quarter, titled};
use crate::arguments::gain;
use crate::failure::{Failure, Outcome};
use crate::quantity::Rows;

/// Uncertainty, and the statistic to maximise.
#[derive(Debug, clap::Args)]
pub(super) struct Robustly {
    /// Design for all that this fit (of swimmer calibrate: fit.json, or its --json) leaves open of the sphere's radius and χ, and
    /// of the servos' gain where it was fitted along
    #[arg(long, value_name = "FIT.json")]
    robust: Option<PathBuf>,
    /// Design for servos with a gain (actual over commanded angle) in this interval, as 0.98 1.02; bounds and rates apply to the
    /// command
    #[arg(long, value_names = ["LOW", "HIGH"], value_parser = gain, num_args = 2)]
    gain: Vec<f64>,
    /// Of --robust or --gain: maximise the worst case over the intervals (of radius and χ their ellipse, if the fit has the
    /// correlation), which is the default, or the mean
    #[arg(long, value_name = "WHAT")]
    over: Option<Which>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Which {
    Worst,
    Mean,
}

impl Robustly {
    /// The uncertainty to design for. Returns `None` without `--robust` and `--gain`.
    ///
    /// # Errors
    /// `--over` is given alone.
    pub(super) fn request(&self) -> Outcome<Option<Request>> {
        let gain: Option<[f64; 2]> = self.gain.as_slice().try_into().ok();
        if self.robust.is_none() && gain.is_none() {
            return match self.over {
                Some(_) => Err(Failure::BadInput(
                    "--over says what a robust design maximises: give --robust FIT.json or --gain LOW HIGH"
                        .to_owned(),
                )),
                None => Ok(None),
            };
        }
        Ok(Some(Request {
            fit: self.robust.clone().map(FitSource::File),
            gain,
            over: match self.over {
                None | Some(Which::Worst) => Statistic::Worst,
                Some(Which::Mean) => Statistic::Mean,
            },
        }))
    }
}

/// A robust gait with the paper's symmetries as text.
pub(super) fn text(output: &Output) -> String {
    let mut rows = Rows::default();
    add_quarter(&mut rows, &output.quarter);
    add_robustness(&mut rows, &output.robust);
    add_gait(&mut rows, &output.gait);
    let title = format!("{}, most {}, robust", output.name, output.objective);
    titled(&title, &rows)
}

/// Adds cost and benefit of robustness, the members of the worst case, and the differences from the nominal optimum.
pub(super) fn add_robustness(rows: &mut Rows, output: &RobustnessOutput) {
    let (robust, nominal) = (&output.robust, &output.nominal_optimum);
    let (crossing, nominal_crossing) = (
        output.largest_links_cross,
        output.nominal_optimum_links_cross,
    );
    for (name, ours, theirs) in [
        ("as estimated", robust.nominal, nominal.nominal),
        ("worst case", robust.worst, nominal.worst),
        ("mean", robust.mean, nominal.mean),
    ] {
        rows.row(
            name,
            format!(
                "{} = {ours:.8}, the nominal optimum {theirs:.8} ({:+.3} %)",
                output.quantity,
                (ours / theirs - 1.0) * 100.0 + 0.0
            ),
        );
    }
    for holder in &output.held_by {
        let gain = if (holder.gain - 1.0).abs() < 1e-12 {
            String::new()
        } else {
            format!(", gain {:.4}", holder.gain)
        };
        rows.row(
            "held by",
            format!(
                "r_s = {:.3} mm, χ = {:.4}{gain} (multiplier {:.3})",
                holder.sphere_radius_m * 1e3,
                holder.chi,
                holder.multiplier
            ),
        );
    }
    if output.off_branch {
        rows.row(
            "note",
            "this gait lies on another branch than the nominal optimum, which is not the best gait near it",
        );
    }
    if crossing > nominal_crossing + 1e-6 {
        rows.row(
            "note",
            format!(
                "its links cross on {:.1} % of the cycle at most, those of the nominal optimum on {:.1} %",
                crossing * 100.0,
                nominal_crossing * 100.0
            ),
        );
    }
}
