//! `swimmer calibrate`: tracks → poses → cycles → fitted sphere radius and χ.

pub(crate) mod assessment;
pub(crate) mod beyond_fit;
mod folder;
pub(crate) mod joints;
mod text;

use std::path::{Path, PathBuf};

use operations::SwimmerSource;
use operations::calibrate::campaign::{self, Step};
use operations::calibrate::{Fitted, LEVEL, MiddleLink, RunsOutput, StatedGait, single};
use swimmer_files::{GaitSpec, PointName};

use self::beyond_fit::BeyondFit;
pub(crate) use self::beyond_fit::ResultTable;
pub(crate) use self::folder::write as write_folder;
use self::text::{FitText, RunsText};
use crate::arguments::{gait, seconds};
use crate::context::perform;
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
    #[arg(long, value_name = "SHARE", default_value_t = LEVEL, value_parser = level)]
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
    /// Calibrates and prints the output.
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

/// Reads a campaign with all that it names, fits it, and prints the warnings about its swimmer file.
///
/// # Errors
/// As reading and fitting.
pub(crate) fn fit_campaign(path: &Path, level: f64) -> Outcome<Fitted> {
    perform(|context| Fitted::load(path, level, context))
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
        let request = campaign::Request {
            file: self.file,
            level: self.level,
            fit_also: self.beyond.fit_also,
            advise: self.beyond.advise,
        };
        let begin = |step| match step {
            Step::Fit => stages.next("reading the tracks, fitting r_s and χ", FITTING),
            Step::FitFurther => stages.next("fitting more parameters", beyond_fit::FITTING),
            Step::Advise => stages.next("weighing what to measure next", beyond_fit::ADVISING),
            Step::WeighEvidence => stages.next("weighing the evidence", WEIGHING),
            Step::Assess => stages.next("assessing the fit", ASSESSING),
        };
        let calibrated = perform(|context| campaign::run(&request, context, begin))?;
        if let Some(folder) = folder {
            stages.next("writing report and tables", WRITING);
            write_folder(&calibrated, &request.file, &folder)?;
            folder.publish()?;
        }
        drop(stages);
        let fitted = &calibrated.fitted;
        output.rendered(&fitted.output, &FitText(&fitted.output));
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
        let swimmer = perform(|context| SwimmerSource::from(swimmer.as_str()).load(context))?;
        let link = MiddleLink {
            front: self.front,
            back: self.back,
            body: self.body,
        };
        let options = self.recording.options();
        let gait = StatedGait::load(gait)?;
        let run = single(&self.file, &gait, period_s, &swimmer, &options, &link)?;
        let runs = RunsOutput {
            runs: vec![run.output],
            warnings: run.warnings,
        };
        output.rendered(&runs, &RunsText(&runs));
        Ok(())
    }
}

fn level(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(level) if level > 0.0 && level < 1.0 => Ok(level),
        _ => Err("write a share between 0 and 1, as 0.95".to_owned()),
    }
}
