//! `swimmer demo`: once round the whole loop on a virtual robot, and a report of it.

mod laboratory;
mod output;
mod picture;
mod race;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use calibrate::{PredictedCycle, TrackOptions, predict};
use gait_optimizer::{Bounds, DisplacementProblem, OptimalGait, displacement};
use host_link::LinkError;
use link_protocol::Refusal;
use operations::ErrorKind;
use operations::calibrate::{Fitted, MiddleLink, Run, StatedGait, single};
use operations::optimize::searched;
use swimmer_files::{
    AnyGait, Campaign, GaitSpec, Provenance, ServoFile, SwimmerFile, write_atomically,
};
use swimmer_model::Swimmer;

use self::laboratory::Laboratory;
use self::output::DemoOutput;
use self::race::Race;
use super::calibrate::fit_campaign;
use super::lab;
use super::robot::table_of;
use crate::arguments::load_robots_swimmer;
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::new_folder::NewFolder;
use crate::output::Output;
use crate::progress::Progress;
use crate::report;
use crate::virtual_robot::{Carrier, EmulatedBoard, VirtualLine};
use operations::bounds::playable;

/// Run the whole loop on a virtual robot and leave a report
///
/// Circles of 30° to 110° are uploaded over the link, swum and tracked. The drag is fitted from the tracks alone, starting
/// from χ = 2 and no sphere; a gait is optimised with the fitted model, uploaded, swum and compared with the prediction.
/// Only the tank knows the truth.
#[derive(Debug, clap::Args)]
pub(crate) struct Demo {
    /// Folder of the results; left out: demo-out, or the first free of demo-out-2, demo-out-3, …
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Seed of tank and cameras
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// The truth in the tank: a preset that `swimmer swimmers` lists, or a swimmer file
    #[arg(long, value_name = "SWIMMER", default_value = "robot")]
    swimmer: String,
    /// Robot of the demo
    #[arg(long, value_enum, value_name = "ROBOT", default_value = "twin")]
    robot: Carrier,
    #[command(flatten)]
    board: EmulatedBoard,
}

/// Amplitudes of the circles, degrees.
const CIRCLES: std::ops::RangeInclusive<u32> = 30..=110;
const CIRCLE_STEP: usize = 10;
/// Cycles of each play; the first is start-up and does not count.
const CYCLES: u32 = 5;
/// Duration of a cycle, s, unless the gait needs longer: half of a laboratory's, so that the folder stays small.
const PERIOD_S: f64 = 15.0;
/// The bound on the joints is tightened by this until the robot accepts the gait, rad …
const BOUND_STEP: f64 = 0.02;
/// … at most down to this, rad.
const LEAST_BOUND: f64 = 1.0;

/// Names in the folder.
const START: &str = "start.toml";
const CAMPAIGN: &str = "campaign.toml";
const FITTED: &str = "fitted.toml";
const BEST: &str = "best.gait";
const BEST_TRACK: &str = "best.csv";
const LINK_LOG: &str = "link.mcap";
const REPORT: &str = "report.html";
const LAB: &str = "lab.html";

impl Demo {
    /// Goes round the loop and answers.
    pub(crate) fn run(self, output: Output) -> Outcome {
        let truth = load_robots_swimmer(&self.swimmer)?;
        if let Some(passive) = truth.passive {
            return Err(Failure::BadInput(format!(
                "the {} joint of `{}` is passive; the demo drives both joints",
                passive.joint, truth.name
            )));
        }
        let folder = match &self.output {
            Some(place) => NewFolder::start(place)?,
            None => NewFolder::start_free("demo-out")?,
        };
        let interrupt = Interrupt::install()?;
        let line = self.robot.line(&truth, self.seed, &self.board)?;
        // Wherever it was: in the middle of an upload as of a play.
        let broken_off = |failure| {
            if interrupt.requested() {
                Failure::Tried("Ctrl-C: the robot was stopped, nothing was kept".to_owned())
            } else {
                failure
            }
        };
        let round = Round::new(truth, line, self.seed, folder.draft(), interrupt.clone())
            .and_then(Round::go)
            .map_err(broken_off)?;
        let lab = lab_page(&round, folder.draft())?;
        let page = report::page(&picture::report(&round, lab)?)?;
        write_atomically(&folder.draft().join(REPORT), page.as_bytes())?;
        let place = folder.place().to_owned();
        folder.publish()?;
        output.print(&DemoOutput::new(&round, &place));
        Ok(())
    }
}

/// Puts the lab page next to the report, if this checkout or release has it. Returns the address that shows the results in it.
fn lab_page(round: &Finished, draft: &Path) -> Outcome<Option<String>> {
    let Some(page) = lab::own()? else {
        return Ok(None);
    };
    write_atomically(&draft.join(LAB), &page)?;
    let (bound, _) = round.bounds;
    Ok(Some(lab::beside(LAB, &round.fitted, bound, round.period_s)))
}

/// Inputs of the round.
struct Round<'a> {
    truth: SwimmerFile,
    servo: ServoFile,
    start: SwimmerFile,
    seed: u64,
    draft: &'a Path,
    laboratory: Laboratory,
    progress: Progress,
}

/// Results of the round.
struct Finished {
    truth: SwimmerFile,
    start: SwimmerFile,
    fitted: SwimmerFile,
    seed: u64,
    fit: Fitted,
    best: OptimalGait,
    best_gait: AnyGait,
    /// The bound under which the robot accepted the gait, and the one that its servos would allow, rad.
    bounds: (f64, f64),
    period_s: f64,
    predicted: PredictedCycle,
    swum: Run,
    race: Race,
}

impl<'a> Round<'a> {
    fn new(
        truth: SwimmerFile,
        line: VirtualLine,
        seed: u64,
        draft: &'a Path,
        interrupt: Interrupt,
    ) -> Outcome<Self> {
        let servo = truth.servo.unwrap_or_default();
        let start = SwimmerFile {
            name: format!("{}, drag not known yet", truth.name),
            swimmer: Swimmer {
                chi: 2.0,
                sphere_radius: 0.0,
                ..truth.swimmer
            },
            servo: Some(servo),
            ..truth.clone()
        };
        start.save(&draft.join(START))?;
        let circles = circles(servo.max_angle).count() as u64;
        let progress = Progress::of_steps(circles + 5);
        let laboratory = Laboratory::open(line, seed, &draft.join(LINK_LOG), interrupt)?;
        Ok(Self {
            truth,
            servo,
            start,
            seed,
            draft,
            laboratory,
            progress,
        })
    }

    fn go(mut self) -> Outcome<Finished> {
        self.laboratory.configure(&self.start, &self.servo)?;
        self.swim_circles()?;
        self.doing("fitting r_s and χ");
        let fit = fit_campaign(&self.draft.join(CAMPAIGN), 0.95)?;
        let fitted = SwimmerFile {
            name: format!("{}, fitted", self.truth.name),
            ..fit.result.swimmer.clone()
        };
        let inputs = Campaign::files(&self.draft.join(CAMPAIGN))?;
        let made_by = concat!("swimmer demo ", env!("CARGO_PKG_VERSION"));
        let provenance = Provenance::of_files(made_by, &inputs, self.draft)?;
        provenance.save_with(&fitted, &self.draft.join(FITTED))?;
        self.laboratory.configure(&fitted, &self.servo)?;
        self.doing("optimising a gait with the fitted model");
        let (best, best_gait, bound, period_s) = self.upload_best(&fitted)?;
        best.gait_file(&fitted.name).save(&self.draft.join(BEST))?;
        self.doing("swimming the optimised gait");
        let track = self.draft.join(BEST_TRACK);
        self.laboratory
            .swim(CYCLES, Duration::from_secs_f64(period_s), &track)?;
        self.doing("comparing");
        let predicted =
            predict(&fitted, &best_gait, period_s).map_err(|error| Failure::tried(&error))?;
        let swum = single(
            &track,
            &StatedGait::load(&GaitSpec::File {
                path: self.draft.join(BEST),
                reversed: false,
            })?,
            period_s,
            &fitted,
            &TrackOptions::default(),
            &MiddleLink::default(),
        )?;
        self.doing("racing the fastest gait against it");
        let race = self.race(&fitted, &best.gait_file(&fitted.name))?;
        self.laboratory.close()?;
        Ok(Finished {
            truth: self.truth,
            start: self.start,
            fitted,
            seed: self.seed,
            fit,
            best,
            best_gait,
            bounds: (bound, self.servo.max_angle),
            period_s,
            predicted,
            swum,
            race,
        })
    }

    fn doing(&self, what: &str) {
        self.progress.doing(what);
        self.progress.step();
    }

    /// Uploads, swims and tracks the circles, and writes the campaign that names them.
    fn swim_circles(&mut self) -> Outcome {
        let reach = self.truth.swimmer.links.middle / 2.0;
        let mut campaign = format!(
            "swimmer = \"{START}\"  # its r_s and chi are only starting values\n\n[reflectors]\n\
             front = {{ point = \"Front\", at = [{reach:?}, 0.0] }}\nback = {{ point = \"Back\", at = [{:?}, 0.0] }}\n",
            -reach
        );
        for degrees in circles(self.servo.max_angle) {
            self.doing(&format!("swimming circle:{degrees}deg"));
            let gait = AnyGait::circle(f64::from(degrees).to_radians());
            let period_s = self.upload(&gait)?;
            let track = format!("circle-{degrees:03}.csv");
            self.laboratory.swim(
                CYCLES,
                Duration::from_secs_f64(period_s),
                &self.draft.join(&track),
            )?;
            let _ = write!(
                campaign,
                "\n[[run]]\ntrack = \"{track}\"\ngait = \"circle:{degrees}deg\"\nperiod_s = {period_s:?}\n"
            );
        }
        Ok(write_atomically(
            &self.draft.join(CAMPAIGN),
            campaign.as_bytes(),
        )?)
    }

    /// Uploads a gait and says at which period it will be played, s.
    fn upload(&mut self, gait: &AnyGait) -> Result<f64, Refused> {
        let table = table_of(gait).map_err(|error| Refused::Everywhere(Failure::tried(&error)))?;
        let info = self
            .laboratory
            .upload(&table)
            .map_err(|error| match error {
                LinkError::Refused {
                    refusal: Refusal::LinksCross { .. } | Refusal::AngleLimit { .. },
                    ..
                } => Refused::Here(error.into()),
                error => Refused::Everywhere(error.into()),
            })?;
        let shortest_s = f64::from(info.min_period_us) / 1e6;
        Ok(PERIOD_S.max((1.1 * shortest_s).ceil()))
    }

    /// Uploads the farthest playable gait. If no optimum exists within the servos' range, the bound on the joints is tightened.
    fn upload_best(&mut self, fitted: &SwimmerFile) -> Outcome<(OptimalGait, AnyGait, f64, f64)> {
        let mut bound = self.servo.max_angle;
        loop {
            match self.try_bound(fitted, bound) {
                Ok((best, gait, period_s)) => return Ok((best, gait, bound, period_s)),
                Err(Refused::Here(_)) if bound - BOUND_STEP > LEAST_BOUND => bound -= BOUND_STEP,
                Err(Refused::Here(failure) | Refused::Everywhere(failure)) => return Err(failure),
            }
        }
    }

    fn try_bound(
        &mut self,
        fitted: &SwimmerFile,
        bound: f64,
    ) -> Result<(OptimalGait, AnyGait, f64), Refused> {
        let within = playable(Bounds::within(bound), fitted);
        let search = |bounds| {
            let free = DisplacementProblem::new(fitted.swimmer);
            Ok(displacement(&DisplacementProblem { bounds, ..free })?)
        };
        let best =
            searched(fitted, true, within, |gait| gait, search).map_err(|error| {
                match error.kind {
                    ErrorKind::Failed => Refused::Here(error.into()),
                    ErrorKind::BadInput => Refused::Everywhere(error.into()),
                }
            })?;
        let gait = best.gait().map_err(|error| {
            Refused::Everywhere(Failure::Tried(format!(
                "the optimised gait cannot be swum: {error}"
            )))
        })?;
        let period_s = self.upload(&gait)?;
        Ok((best, gait, period_s))
    }
}

/// Reason why the gait is not on the robot.
enum Refused {
    /// Not with these shapes; others may do.
    Here(Failure),
    Everywhere(Failure),
}

impl From<Refused> for Failure {
    fn from((Refused::Here(failure) | Refused::Everywhere(failure)): Refused) -> Self {
        failure
    }
}

/// The circles that the servos can do, degrees.
fn circles(max_angle: f64) -> impl Iterator<Item = u32> {
    CIRCLES
        .step_by(CIRCLE_STEP)
        .filter(move |degrees| f64::from(*degrees).to_radians() <= max_angle)
}
