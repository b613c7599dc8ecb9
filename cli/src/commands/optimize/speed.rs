//! `swimmer optimize speed`: the fastest gait that servos can play.

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use gait_optimizer::{Arc, Fastest, HeadingRule, SpeedError, SpeedProblem, front, robust_speed};
use serde::Serialize;
use swimmer_files::{AnyGait, ServoFile, SwimmerFile};

use crate::arguments::{load_swimmer, rate, seconds, watts};
use crate::bounds::WholeBounds;
use crate::failure::{Failure, Outcome};
use crate::output::Output;
use crate::progress::Progress;
use crate::quantity::{self, Rows};

use super::answer::{Closing, Pace, arc_rows, unfolded};
use super::front::{FrontAnswer, FrontFile};
use super::limited::{Limits, within};
use super::robust::{Brings, Robustly, as_written, refused};
use crate::new_file::may_be_written;
use crate::own_robot::{PlayedSpeed, servo_rates};
use crate::threads;

/// Find the fastest gait: most net displacement per unit of time, without net rotation, with servos that turn no faster than a
/// given rate
///
/// With --robust or --gain: with the worst swimmer that is left open, or in the mean, beside what the fastest gait of the estimates
/// would bring there: along gaits that turn none of the swimmers, as the fastest as a rule are where both side links are alike.
///
/// With --power instead: with servos that together give no more than so many watts, which is the most efficient gait at constant
/// power; with --torque: with servos each of which gives no more than the swimmer file says, less the faster it turns. Such limits
/// hold together, and with --max-rate; the answer says which of them binds on what share of the cycle.
///
/// Fastest means the best of all cycles of at most 16 corners: a chain of unlike cycles may always beat each of them, and a
/// longer cycle that was met and is better by more than 1e-6 is told. The gait is timed as it shall run, with its corners where
/// a servo turns round.
#[derive(Debug, clap::Args)]
pub(crate) struct Speed {
    /// purcell, robot, robot-slender or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    /// No servo turns faster than this angle a second; a second one is that of joint 2
    #[arg(long, value_name = "ANGLE_PER_S", value_parser = rate, num_args = 1..=2, required_unless_present_any = ["playable", "power", "torque"])]
    max_rate: Vec<f64>,
    /// The servos together give no more than this many watts; the swimmer file names its fluid
    #[arg(long, value_name = "WATTS", value_parser = watts, conflicts_with_all = ["heading", "period", "front", "robust", "gain"])]
    power: Option<f64>,
    /// Each servo gives no more torque than the swimmer file says, which falls evenly to 0 at its rate without a load
    #[arg(long, conflicts_with_all = ["heading", "period", "front"])]
    torque: bool,
    /// Which way the gait shall lead, against the mean heading of its cycle
    #[arg(long, value_name = "HEADING", value_enum, default_value = "any")]
    heading: Heading,
    /// The farthest gait in this many seconds, instead of the fastest
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    period: Option<f64>,
    #[command(flatten)]
    bounds: WholeBounds,
    #[command(flatten)]
    robustly: Robustly,
    /// Also draw displacement per cycle against speed, of the farthest gaits in shorter and longer periods: a figure, or their
    /// table
    #[arg(long, value_name = "FILE.svg|.csv", conflicts_with_all = ["period", "robust", "gain"])]
    front: Option<FrontFile>,
    /// Write the gait, timed as it shall run, as a gait file
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
}

/// Which way a gait leads.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Heading {
    /// Wherever it is fastest
    Any,
    /// Along the mean heading
    Forward,
    /// Across it
    Sideways,
}

impl Speed {
    pub(super) fn run(self, output: Output) -> Outcome {
        if let Some(front) = &self.front {
            may_be_written(&front.path)?;
        }
        let file = load_swimmer(&self.swimmer)?;
        if self.power.is_some() || self.torque {
            let limits = Limits {
                power: self.power,
                rates: servo_rates(&self.max_rate, self.bounds.playable(), &file),
                torque: self.torque,
            };
            return within(&file, self.bounds.of(&file), &limits, self.output, output);
        }
        let Some(rates) = servo_rates(&self.max_rate, self.bounds.playable(), &file) else {
            return Err(Failure::BadInput(
                "give --max-rate or --playable".to_owned(),
            ));
        };
        let uncertain = self.robustly.load(&file)?;
        let begun = Instant::now();
        let progress = Progress::of_a_whole("looking for the fastest gait");
        let problem = SpeedProblem {
            bounds: self.bounds.of(&file),
            heading: match self.heading {
                Heading::Any => HeadingRule::Any,
                Heading::Forward => HeadingRule::Forward,
                Heading::Sideways => HeadingRule::Sideways,
            },
            period: self.period,
            threads: threads::available(),
            ..SpeedProblem::new(file.swimmer, rates)
        };
        let watch = |share| progress.at_share(share);
        let mut robust = None;
        let (found, farthest) = if let Some((uncertainty, over)) = uncertain {
            let found = robust_speed(&problem, &uncertainty, over, &watch)
                .map_err(|error| refused(error, &self.bounds))?;
            robust = Some(Brings::new(&found.robustness, "|d|/(L T)"));
            (found.fastest, None)
        } else if self.front.is_some() {
            let front = front(&problem, &watch)?;
            (front.fastest.clone(), Some(front))
        } else {
            (problem.watched(&watch)?, None)
        };
        drop(progress);
        let seconds = begun.elapsed().as_secs_f64();
        unfolded(&found.gait)?;
        let gait_file = if robust.is_some() {
            as_written(&found.gait).gait_file(&file.name)
        } else {
            found.gait.gait_file(&file.name)
        };
        let mut answer = Answer::new(&file, &found, seconds, self.output.clone());
        answer.robust = robust;
        if let Ok(curve) = AnyGait::from_file(&gait_file) {
            let servo = self.servo(&file);
            answer.played =
                servo.and_then(|servo| PlayedSpeed::new(&file, servo, &curve, found.period));
            let period = answer
                .played
                .as_ref()
                .map_or(found.period, |played| played.period_s);
            crate::own_robot::say_if_beyond(&file, &curve, period);
        }
        if let (Some(place), Some(farthest)) = (&self.front, &farthest) {
            let length = file.swimmer.total_length();
            answer.front = Some(place.write(farthest, &file.name, length)?);
        }
        if let Some(path) = &self.output {
            gait_file.save(path)?;
        }
        output.answer(&answer);
        Ok(())
    }

    /// The servos that shall play it: the file's, or the paper's where that is asked for.
    fn servo(&self, file: &SwimmerFile) -> Option<ServoFile> {
        let paper = self.bounds.playable().then(ServoFile::default);
        file.servo.or(paper)
    }
}

#[derive(Debug, Serialize)]
struct Answer {
    #[serde(skip)]
    name: String,
    #[serde(flatten)]
    pace: Pace,
    /// Of the displacement against the cycle's mean heading.
    heading_rad: f64,
    rotation_rad: f64,
    arcs: Vec<Arc>,
    /// Fractions of the period where a servo turns round or stops.
    corners: Vec<f64>,
    /// Most corners of the cycles that were looked at.
    max_corners: usize,
    /// Closed curves that were started from, and how many led to this gait.
    starts: usize,
    found: usize,
    /// The speed of a certified cycle with more corners, where one is better by more than 1e-6 of it.
    longer_speed_over_length_per_s: Option<f64>,
    /// The speed of a faster chain of arcs that failed its certificate.
    uncertified_speed_over_length_per_s: Option<f64>,
    /// Of a robust gait: what robustness costs and brings.
    #[serde(skip_serializing_if = "Option::is_none")]
    robust: Option<Brings>,
    /// What the robot of the file makes of it, as fast as it can.
    #[serde(skip_serializing_if = "Option::is_none")]
    played: Option<PlayedSpeed>,
    #[serde(skip_serializing_if = "Option::is_none")]
    front: Option<FrontAnswer>,
    #[serde(flatten)]
    closing: Closing,
}

impl Answer {
    fn new(file: &SwimmerFile, found: &Fastest, seconds: f64, output: Option<PathBuf>) -> Self {
        let gait = &found.gait;
        Self {
            name: file.name.clone(),
            pace: Pace::new(
                file,
                (found.speed_over_length, found.distance_over_length),
                found.period,
            ),
            heading_rad: found.heading,
            rotation_rad: gait.rotation,
            arcs: gait.arcs.clone(),
            corners: gait.corners().to_vec(),
            max_corners: SpeedProblem::MAX_CORNERS,
            starts: SpeedProblem::STARTS,
            found: found.found,
            longer_speed_over_length_per_s: found.longer,
            uncertified_speed_over_length_per_s: found.uncertified,
            robust: None,
            played: None,
            front: None,
            closing: Closing::new(gait, None, seconds, output),
        }
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        self.pace.rows(&mut rows);
        rows.row(
            "leads",
            format!("{} off the mean heading", quantity::angle(self.heading_rad)),
        )
        .row(
            "found",
            format!("from {} of {} starts", self.found, self.starts),
        );
        arc_rows(&mut rows, &self.arcs);
        let better = |speed: f64| {
            format!(
                "{:.4} % faster",
                (speed / self.pace.speed_over_length_per_s - 1.0) * 100.0
            )
        };
        if let Some(speed) = self.longer_speed_over_length_per_s {
            rows.row(
                "longer cycle",
                format!(
                    "one of more than {} corners is {}",
                    self.max_corners,
                    better(speed)
                ),
            );
        }
        if let Some(speed) = self.uncertified_speed_over_length_per_s {
            rows.row(
                "not certified",
                format!(
                    "another chain of arcs is {}, but meets not all conditions",
                    better(speed)
                ),
            );
        }
        if let Some(robust) = &self.robust {
            robust.rows(&mut rows);
        }
        if let Some(played) = &self.played {
            rows.row(
                "as played",
                format!(
                    "{} a second, a cycle in {:.3} s: table, ticks and servos take {:.2} %",
                    quantity::length(played.speed_m_per_s),
                    played.period_s,
                    played.lost_share * 100.0
                ),
            );
        }
        if let Some(front) = &self.front {
            rows.row(
                "front",
                format!(
                    "{}: the farthest gait in {} of {} periods",
                    front.file.display(),
                    front.told,
                    front.periods
                ),
            );
        }
        self.closing.rows(&mut rows);
        write!(
            f,
            "{}: the {}fastest gait swims {} in {:.2} s, {} a second\n{rows}",
            self.name,
            if self.robust.is_some() { "robust " } else { "" },
            quantity::length(self.pace.displacement_m),
            self.pace.period_s,
            quantity::length(self.pace.speed_m_per_s),
        )
    }
}

impl From<SpeedError> for Failure {
    /// A problem that makes no sense is bad input; one without a certified gait was tried.
    fn from(error: SpeedError) -> Self {
        match error {
            SpeedError::NoGait { .. } | SpeedError::Immobile(_) => Self::tried(&error),
            _ => Self::bad_input(&error),
        }
    }
}
