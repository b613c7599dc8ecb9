//! `swimmer calibrate`: tracks → poses → cycles → fitted sphere radius and χ.

use std::fmt;
use std::path::{Path, PathBuf};

use calibrate::{
    CalibrateError, CampaignData, CampaignFit, FitOptions, RunResult, TrackOptions, c_t_form,
    calibrate_campaign, calibrate_run, load_run, usual_reflectors,
};
use serde::Serialize;
use swimmer_files::{Campaign, GaitSpec, SwimmerFile, write_atomically};

use crate::arguments::{gait, load_swimmer, seconds};
use crate::failure::{Failure, Outcome};
use crate::new_folder::NewFolder;
use crate::output::{Output, document};
use crate::quantity::{self, Rows, Table};
use crate::recording::Recording;

/// Turn tracks into poses, cycles and fitted drag parameters
///
/// FILE is a campaign (TOML), whose runs together give r_s and χ; or one tracking file, of which only the cycles are
/// reported (then --gait, --period and --swimmer say what was swum).
#[derive(Debug, clap::Args)]
#[allow(clippy::doc_markdown)] // the help is for people: r_s, not `r_s`
pub(crate) struct Calibrate {
    /// A campaign (.toml) or a tracking file
    #[arg(value_name = "CAMPAIGN.toml | RUN.csv")]
    file: PathBuf,
    /// What was played in a single run: circle:AMPLITUDE, square:AMPLITUDE or a gait file
    #[arg(long, value_name = "GAIT", value_parser = gait)]
    gait: Option<GaitSpec>,
    /// Seconds a cycle took in a single run
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    period: Option<f64>,
    /// The swimmer of a single run
    #[arg(long, value_name = "SWIMMER")]
    swimmer: Option<String>,
    /// Level of the intervals
    #[arg(long, value_name = "SHARE", default_value_t = 0.95, value_parser = level)]
    level: f64,
    /// Write the fitted swimmer file and the fit into this folder
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    recording: Recording,
}

/// The cycles of one run, and what they brought.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct RunAnswer {
    pub(crate) file: String,
    pub(crate) gait: String,
    pub(crate) cycles: usize,
    pub(crate) x_m: f64,
    pub(crate) x_sd_m: f64,
    pub(crate) y_m: f64,
    pub(crate) delta_y_m: f64,
    pub(crate) delta_y_sd_m: f64,
    pub(crate) delta_theta_rad: f64,
    pub(crate) delta_theta_sd_rad: f64,
    pub(crate) turn_rad: f64,
    pub(crate) period_s: f64,
}

/// The cycles of all runs, and the parameters that explain them.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct FitAnswer {
    pub(crate) runs: Vec<RunAnswer>,
    pub(crate) sphere_radius_m: f64,
    pub(crate) chi: f64,
    pub(crate) rmse: f64,
    pub(crate) intervals: Intervals,
    /// Between both.
    pub(crate) correlation: f64,
    pub(crate) c_t_form: String,
    /// What to know about the runs and the fit.
    pub(crate) warnings: Vec<String>,
}

#[derive(Debug, Clone, Serialize)]
pub(crate) struct Intervals {
    pub(crate) sphere_radius_m: [f64; 2],
    pub(crate) chi: [f64; 2],
    pub(crate) level: f64,
}

/// Only the cycles: what a single run can tell.
#[derive(Debug, Serialize)]
struct RunsAnswer {
    runs: Vec<RunAnswer>,
    warnings: Vec<String>,
}

impl fmt::Display for RunsAnswer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", table(&self.runs))?;
        notes(f, &self.warnings)
    }
}

fn notes(f: &mut fmt::Formatter<'_>, warnings: &[String]) -> fmt::Result {
    warnings
        .iter()
        .try_for_each(|warning| write!(f, "\n  note: {warning}"))
}

impl fmt::Display for FitAnswer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Intervals {
            sphere_radius_m: [r_low, r_high],
            chi: [chi_low, chi_high],
            level,
        } = self.intervals;
        let percent = level * 100.0;
        let mut rows = Rows::default();
        rows.row(
            "sphere radius r_s",
            format!(
                "{:.3} mm   ({percent:.0} %: {:.3} … {:.3} mm)",
                self.sphere_radius_m * 1e3,
                r_low * 1e3,
                r_high * 1e3
            ),
        )
        .row(
            "drag ratio χ",
            format!(
                "{:.4}      ({percent:.0} %: {chi_low:.4} … {chi_high:.4})",
                self.chi
            ),
        )
        .row(
            "RMSE",
            format!("{} (the paper's weights)", quantity::small(self.rmse)),
        )
        .row("form of c_t", &self.c_t_form);
        write!(f, "{}\n\n{rows}", table(&self.runs))?;
        notes(f, &self.warnings)
    }
}

fn table(runs: &[RunAnswer]) -> Table {
    let mut table = Table::new([
        "run",
        "gait",
        "cycles",
        "X [mm]",
        "Y [mm]",
        "ΔY [mm]",
        "Δθ",
        "period [s]",
    ]);
    for run in runs {
        table.line([
            run.file.clone(),
            run.gait.clone(),
            run.cycles.to_string(),
            format!("{:.3} ± {:.3}", run.x_m * 1e3, run.x_sd_m * 1e3),
            format!("{:.3}", run.y_m * 1e3),
            format!("{:.3} ± {:.3}", run.delta_y_m * 1e3, run.delta_y_sd_m * 1e3),
            format!(
                "{} ± {}",
                quantity::angle(run.delta_theta_rad),
                quantity::angle(run.delta_theta_sd_rad)
            ),
            format!("{:.3}", run.period_s),
        ]);
    }
    table
}

impl Calibrate {
    /// Calibrates and answers.
    pub(crate) fn run(self, output: Output) -> Outcome {
        let is_campaign = self
            .file
            .extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
        if is_campaign {
            self.campaign(output)
        } else {
            self.single(output)
        }
    }
}

/// A campaign's fit with what is printed of it.
pub(crate) struct FittedCampaign {
    pub(crate) answer: FitAnswer,
    pub(crate) found: CampaignFit,
    pub(crate) campaign: Campaign,
}

/// One run's cycles with what is printed of them.
pub(crate) struct RunCycles {
    pub(crate) answer: RunAnswer,
    pub(crate) found: RunResult,
}

/// Reads a campaign with all that it names, and fits.
///
/// # Errors
/// As reading and fitting.
pub(crate) fn fit_campaign(path: &Path, level: f64) -> Outcome<FittedCampaign> {
    let campaign = Campaign::load(path)?;
    let data = CampaignData::load(&campaign)?;
    let found = calibrate_campaign(&campaign, &data, FitOptions { level })?;
    let folder = path.parent().unwrap_or_else(|| Path::new(""));
    let runs = found
        .runs
        .iter()
        .zip(&campaign.runs)
        .map(|(run, named)| RunAnswer::new(run, &named.gait, folder))
        .collect();
    let fit = &found.fit;
    let of_runs = found.runs.iter().flat_map(|run| run_warnings(run, folder));
    let answer = FitAnswer {
        runs,
        sphere_radius_m: fit.sphere_radius,
        chi: fit.chi,
        rmse: fit.rmse,
        intervals: Intervals {
            sphere_radius_m: fit.intervals.sphere_radius,
            chi: fit.intervals.chi,
            level: fit.intervals.level,
        },
        correlation: fit.correlation,
        c_t_form: c_t_form(&fit.c_t_form),
        warnings: of_runs
            .chain(fit.warnings.iter().map(ToString::to_string))
            .collect(),
    };
    Ok(FittedCampaign {
        answer,
        found,
        campaign,
    })
}

/// Reads one track and finds its cycles.
///
/// # Errors
/// As reading and finding them.
pub(crate) fn single_run(
    track: &Path,
    gait: &GaitSpec,
    period_s: f64,
    swimmer: &SwimmerFile,
    options: &TrackOptions,
) -> Outcome<RunCycles> {
    let data = load_run(track, gait, period_s, options)?;
    let reflectors = usual_reflectors(&data.track, &swimmer.swimmer);
    let found = calibrate_run(&data, &reflectors, swimmer)?;
    Ok(RunCycles {
        answer: RunAnswer::new(&found, gait, Path::new("")),
        found,
    })
}

impl RunAnswer {
    /// Paths are told relative to the campaign's folder, as the campaign tells them.
    fn new(run: &RunResult, gait: &GaitSpec, folder: &Path) -> Self {
        let cycles = &run.cycles;
        let relative = |path: &Path| path.strip_prefix(folder).unwrap_or(path).to_owned();
        let gait = match gait {
            GaitSpec::File { path, reversed } => GaitSpec::File {
                path: relative(path),
                reversed: *reversed,
            },
            closed_form => closed_form.clone(),
        };
        Self {
            file: relative(&run.file).display().to_string(),
            gait: quantity::gait(&gait),
            cycles: cycles.cycles.len(),
            x_m: cycles.x.mean,
            x_sd_m: cycles.x.sd,
            y_m: cycles.y.mean,
            delta_y_m: cycles.delta_y.mean,
            delta_y_sd_m: cycles.delta_y.sd,
            delta_theta_rad: cycles.delta_theta.mean,
            delta_theta_sd_rad: cycles.delta_theta.sd,
            turn_rad: cycles.rotation.mean,
            period_s: cycles.period_s,
        }
    }
}

/// What reader, poses and cycles of a run had to say, with its file's name.
fn run_warnings(run: &RunResult, folder: &Path) -> Vec<String> {
    let file = run.file.strip_prefix(folder).unwrap_or(&run.file).display();
    run.warnings
        .iter()
        .map(|warning| format!("{file}: {warning}"))
        .collect()
}

impl Calibrate {
    fn campaign(self, output: Output) -> Outcome {
        let single_only = [
            ("--gait", self.gait.is_some()),
            ("--period", self.period.is_some()),
            ("--swimmer", self.swimmer.is_some()),
        ];
        let flag = single_only
            .iter()
            .find_map(|(flag, given)| given.then_some(*flag));
        if let Some(flag) = flag.or(self.recording.given()) {
            return Err(Failure::BadInput(format!(
                "{flag} goes with a single tracking file; a campaign names all that itself"
            )));
        }
        let folder = self.output.as_deref().map(NewFolder::start).transpose()?;
        let fitted = fit_campaign(&self.file, self.level)?;
        if let Some(folder) = folder {
            fitted
                .found
                .swimmer
                .save(&folder.draft().join("fitted.toml"))?;
            write_atomically(
                &folder.draft().join("fit.json"),
                document(&fitted.answer).as_bytes(),
            )?;
            folder.publish()?;
        }
        output.answer(&fitted.answer);
        Ok(())
    }

    fn single(self, output: Output) -> Outcome {
        let (Some(gait), Some(period_s), Some(swimmer)) = (&self.gait, self.period, &self.swimmer)
        else {
            return Err(Failure::BadInput(format!(
                "{} is no campaign (.toml), so say what was swum: --gait, --period and --swimmer",
                self.file.display()
            )));
        };
        if self.output.is_some() {
            return Err(Failure::BadInput(
                "-o goes with a campaign: a single run is not fitted".to_owned(),
            ));
        }
        let run = single_run(
            &self.file,
            gait,
            period_s,
            &load_swimmer(swimmer)?,
            &self.recording.options(),
        )?;
        let warnings = run_warnings(&run.found, Path::new(""));
        output.answer(&RunsAnswer {
            runs: vec![run.answer],
            warnings,
        });
        Ok(())
    }
}

impl From<CalibrateError> for Failure {
    fn from(error: CalibrateError) -> Self {
        if error.is_bad_input() {
            Self::bad_input(&error)
        } else {
            Self::tried(&error)
        }
    }
}

fn level(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(level) if level > 0.0 && level < 1.0 => Ok(level),
        _ => Err("write a share between 0 and 1, as 0.95".to_owned()),
    }
}
