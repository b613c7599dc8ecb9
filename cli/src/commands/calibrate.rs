//! `swimmer calibrate`: tracks → poses → cycles → fitted sphere radius and χ.

mod assessment;
mod beyond_fit;
mod folder;
mod joints;
mod output;
mod wrong_gait;

use std::path::{Path, PathBuf};

use calibrate::{
    CalibrateError, CampaignData, CampaignFit, EvidenceOptions, FitError, FitOptions, RunResult,
    TrackOptions, UsedPoints, assess, c_t_form, calibrate_campaign, calibrate_run, load_run,
    usual_reflectors, weigh_evidence,
};
use swimmer_files::{Campaign, GaitSpec, PointName, Reflector, Reflectors, RigidBody, SwimmerFile};

pub(crate) use self::assessment::AssessmentOutput;
pub(crate) use self::beyond_fit::ResultTable;
use self::beyond_fit::{BeyondFit, BeyondFitOutput};
pub(crate) use self::joints::JointsOutput;
use self::output::RunsOutput;
pub(crate) use self::output::{FitOutput, RunOutput};
use crate::arguments::{gait, load_robots_swimmer, say_if_stale, seconds};
use crate::failure::{Failure, Outcome};
use crate::new_folder::NewFolder;
use crate::output::Output;
use crate::progress::Stages;
use crate::recording::Recording;

/// Turn tracks into poses, cycles and fitted drag parameters
///
/// FILE is a campaign (TOML), whose runs together give r_s and χ; or one tracking file, of which only the cycles are
/// reported (then --gait, --period and --swimmer name the gait).
#[derive(Debug, clap::Args)]
#[allow(clippy::doc_markdown)] // the help is for people: r_s, not `r_s`
pub(crate) struct Calibrate {
    /// A campaign (.toml) or a tracking file
    #[arg(value_name = "CAMPAIGN.toml | RUN.csv")]
    file: PathBuf,
    /// Gait of a single run: circle:AMPLITUDE, square:AMPLITUDE or a gait file
    #[arg(long, value_name = "GAIT", value_parser = gait)]
    gait: Option<GaitSpec>,
    /// Seconds a cycle took in a single run
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    period: Option<f64>,
    /// The swimmer of a single run
    #[arg(long, value_name = "SWIMMER")]
    swimmer: Option<String>,
    /// The front reflector of a single run: a point's name, two columns, or X,Y in metres for the one nearer to that place in
    /// the first frame
    #[arg(long, value_name = "NAME|X,Y", allow_hyphen_values = true)]
    front: Option<PointName>,
    /// The back reflector of a single run, likewise
    #[arg(long, value_name = "NAME|X,Y", allow_hyphen_values = true)]
    back: Option<PointName>,
    /// The rigid body that is the middle link of a single run, instead of two reflectors: its name in the file
    #[arg(long, value_name = "NAME", conflicts_with_all = ["front", "back"])]
    body: Option<String>,
    /// Level of the intervals
    #[arg(long, value_name = "SHARE", default_value_t = 0.95, value_parser = level)]
    level: f64,
    #[command(flatten)]
    beyond: BeyondFit,
    /// Write report, fitted swimmer file, fit and every intermediate into this folder
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    recording: Recording,
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

/// Usual durations of the stages, seconds, as measured on nine runs of eight cycles.
const FITTING: f64 = 4.4;
const WEIGHING: f64 = 2.7;
const ASSESSING: f64 = 6.3;
const WRITING: f64 = 0.5;

/// A campaign's fit with what is printed of it.
pub(crate) struct FittedCampaign {
    pub(crate) answer: FitOutput,
    pub(crate) found: CampaignFit,
    pub(crate) campaign: Campaign,
}

/// One run's cycles with what is printed of them.
pub(crate) struct RunCycles {
    pub(crate) answer: RunOutput,
    pub(crate) found: RunResult,
}

/// Reads a campaign with all that it names, and fits.
///
/// # Errors
/// As reading and fitting.
pub(crate) fn fit_campaign(path: &Path, level: f64) -> Outcome<FittedCampaign> {
    let campaign = Campaign::load(path)?;
    if let Some(swimmer) = &campaign.swimmer_path {
        say_if_stale(swimmer)?;
    }
    let data = CampaignData::load(&campaign)?;
    let found = calibrate_campaign(&campaign, &data, FitOptions { level })?;
    let folder = path.parent().unwrap_or_else(|| Path::new(""));
    let runs = found
        .runs
        .iter()
        .map(|run| RunOutput::new(run, &campaign.runs[run.index].gait, folder))
        .collect();
    let fit = &found.fit;
    let of_runs = found.runs.iter().flat_map(|run| run_warnings(run, folder));
    let answer = FitOutput {
        runs,
        sphere_radius_m: fit.sphere_radius,
        chi: fit.chi,
        rmse: fit.rmse,
        intervals: fit.intervals,
        correlation: fit.correlation,
        c_t_form: c_t_form(&fit.c_t_form),
        likelihood: None,
        joints: JointsOutput::of(&found),
        assessment: None,
        warnings: of_runs
            .chain(wrong_gait::of_campaign(
                &campaign,
                &data,
                &found.runs,
                &found.swimmer,
            ))
            .chain(fit.warnings.iter().map(ToString::to_string))
            .collect(),
        beyond: BeyondFitOutput::default(),
    };
    Ok(FittedCampaign {
        answer,
        found,
        campaign,
    })
}

/// Names of the middle link's points or body in the file of a single run.
#[derive(Debug, Default)]
pub(crate) struct MiddleLink {
    pub(crate) front: Option<PointName>,
    pub(crate) back: Option<PointName>,
    pub(crate) body: Option<String>,
}

impl MiddleLink {
    /// Reflectors at the ends of a link of this length \[m\], or its rigid body; `None` if nothing is named.
    fn reflectors(&self, length: f64) -> Option<Reflectors> {
        if self.front.is_none() && self.back.is_none() && self.body.is_none() {
            return None;
        }
        // Whoever names one end does not mean the other one by its usual name.
        let end = |name: &Option<PointName>, along: f64| Reflector {
            point: name.clone().unwrap_or(PointName::Auto),
            at: [along, 0.0],
        };
        Some(Reflectors {
            front: end(&self.front, length / 2.0),
            back: end(&self.back, -length / 2.0),
            body: self.body.clone().map(RigidBody::named),
            sides: None,
        })
    }
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
    link: &MiddleLink,
) -> Outcome<RunCycles> {
    let mut options = options.clone();
    for end in [&link.front, &link.back].into_iter().flatten() {
        if let PointName::Columns(x, y) = end {
            options.pairs.push([x.clone(), y.clone()]);
        }
    }
    let length = swimmer.swimmer.links.middle;
    options.used = Some(link.reflectors(length).map_or_else(
        || UsedPoints::usual(length),
        |reflectors| UsedPoints::of(&reflectors),
    ));
    let data = load_run(track, gait, period_s, &options)?;
    let reflectors = link
        .reflectors(length)
        .unwrap_or_else(|| usual_reflectors(&data.track, &swimmer.swimmer));
    let found = calibrate_run(&data, &reflectors, swimmer)?;
    Ok(RunCycles {
        answer: RunOutput::new(&found, gait, Path::new("")),
        found,
    })
}

/// Warnings of reader, poses and cycles of a run, with its file's name.
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
            ("--front", self.front.is_some()),
            ("--back", self.back.is_some()),
            ("--body", self.body.is_some()),
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
        let mut stages = Stages::new(&[
            FITTING,
            self.beyond.weight(),
            WEIGHING,
            ASSESSING,
            if folder.is_some() { WRITING } else { 0.0 },
        ]);
        stages.next("reading the tracks, fitting r_s and χ", FITTING);
        let mut fitted = fit_campaign(&self.file, self.level)?;
        fitted.answer.beyond = self
            .beyond
            .compute(&fitted.campaign, &fitted.found, &mut stages)?;
        let options = EvidenceOptions::default();
        stages.next("weighing the evidence", WEIGHING);
        let evidence = weigh_evidence(&fitted.found, options);
        match &evidence {
            Ok(evidence) => fitted.answer.likelihood = Some(evidence.likelihood.clone()),
            Err(cause) => fitted
                .answer
                .warnings
                .push(format!("no estimate by likelihood: {cause}")),
        }
        stages.next("assessing the fit", ASSESSING);
        let assessed = assess(&fitted.found, evidence.as_ref().ok())?;
        let of_folder = self.file.parent().unwrap_or_else(|| Path::new(""));
        let document = assessed.document(&fitted.found, |file| {
            let path = file.strip_prefix(of_folder).unwrap_or(file);
            path.display().to_string()
        });
        fitted.answer.assessment = Some(AssessmentOutput(document));
        if let Some(folder) = folder {
            stages.next("writing report and tables", WRITING);
            let weighed = (&evidence?, options);
            folder::write(
                &fitted,
                assessed.systematics.as_ref(),
                weighed,
                &self.file,
                &folder,
            )?;
            folder.publish()?;
        }
        drop(stages);
        output.print(&fitted.answer);
        Ok(())
    }

    fn single(self, output: Output) -> Outcome {
        let (Some(gait), Some(period_s), Some(swimmer)) = (&self.gait, self.period, &self.swimmer)
        else {
            return Err(Failure::BadInput(format!(
                "{} is no campaign (.toml), so name the gait: --gait, --period and --swimmer",
                self.file.display()
            )));
        };
        if self.output.is_some() {
            return Err(Failure::BadInput(
                "-o goes with a campaign: a single run is not fitted".to_owned(),
            ));
        }
        if let Some(flag) = self.beyond.given() {
            return Err(Failure::BadInput(format!(
                "{flag} goes with a campaign: a single run is not fitted"
            )));
        }
        let swimmer = load_robots_swimmer(swimmer)?;
        let run = single_run(
            &self.file,
            gait,
            period_s,
            &swimmer,
            &self.recording.options(),
            &MiddleLink {
                front: self.front.clone(),
                back: self.back.clone(),
                body: self.body.clone(),
            },
        )?;
        let mut warnings = run_warnings(&run.found, Path::new(""));
        let file = self.file.display();
        let doubts = wrong_gait::of_single(&run.found, gait, period_s, &swimmer);
        warnings.extend(doubts.into_iter().map(|doubt| format!("{file}: {doubt}")));
        output.print(&RunsOutput {
            runs: vec![run.answer],
            warnings,
        });
        Ok(())
    }
}

impl From<FitError> for Failure {
    fn from(error: FitError) -> Self {
        CalibrateError::from(error).into()
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
