//! `swimmer optimize speed`: the fastest gait that servos can play.

use gait_optimizer::{
    Fastest, HeadingRule, SpeedError, SpeedProblem, fastest, front, robust_speed,
};
use swimmer_files::{ServoFile, SwimmerFile};

use super::front::FrontFile;
use super::output::add_arcs;
use super::pace::{SEARCHING, add_as_played, at_pace};
use super::robust::{Robustly, add_robustness, as_written, refused};
use super::{Objective, SearchResult, Task};
use crate::arguments::{rate, seconds};
use crate::bounds::CycleBounds;
use crate::document::Document;
use crate::failure::{Failure, Outcome};
use crate::new_file::may_be_written;
use crate::own_robot::servo_rates;
use crate::quantity;
use crate::threads;

/// Find the fastest gait: most net displacement per unit of time, without net rotation, with servos that turn no faster than a
/// given rate
///
/// With --robust or --gain: with the worst swimmer of the uncertainty, or in the mean, compared with the fastest gait of the
/// estimates: along gaits that turn none of the swimmers, which is usual for the fastest gaits of equal side links.
///
/// Fastest means the best of all cycles of at most 16 corners: a chain of unlike cycles may always beat each of them, and a
/// longer cycle that is better by more than 1e-6 is reported. With a prescribed heading there often is one, as a cycle may tack:
/// lead to either side of the heading in turn, the faster the less often it turns, up to the speed of the fastest gait of any
/// heading, which is also reported. The gait is timed as it shall run, with its corners where a servo reverses.
#[derive(Debug, clap::Args)]
pub(crate) struct Speed {
    /// No servo turns faster than this angle a second; a second one is that of joint 2
    #[arg(long, value_name = "ANGLE_PER_S", value_parser = rate, num_args = 1..=2, required_unless_present = "playable")]
    max_rate: Vec<f64>,
    /// Direction of the displacement, relative to the mean heading of its cycle
    #[arg(long, value_name = "HEADING", value_enum, default_value = "any")]
    heading: Heading,
    /// The farthest gait in this many seconds, instead of the fastest: a cycle, several laps of one, or one and a rest
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    period: Option<f64>,
    #[command(flatten)]
    bounds: CycleBounds,
    #[command(flatten)]
    robustly: Robustly,
    /// Also draw displacement per cycle against speed, of the farthest gaits in shorter and longer periods: a figure, or their
    /// table
    #[arg(long, value_name = "FILE.svg|.csv", conflicts_with_all = ["period", "robust", "gain"])]
    front: Option<FrontFile>,
}

/// Direction of the displacement.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Heading {
    /// Wherever it is fastest
    Any,
    /// Along the mean heading
    Forward,
    /// Across it
    Sideways,
}

impl Objective for Speed {
    const WRITES: &'static str = "Write the gait, timed as it shall run, as a gait file";

    fn search(&self, task: &Task) -> Outcome<SearchResult> {
        if let Some(front) = &self.front {
            may_be_written(&front.path)?;
        }
        let file = &task.file;
        let bounds = self.bounds.of(file);
        let rates = servo_rates(&self.max_rate, self.bounds.playable(), file);
        let Some(rates) = rates else {
            return Err(Failure::BadInput(
                "give --max-rate or --playable".to_owned(),
            ));
        };
        let uncertain = self.robustly.load(file)?;
        let heading = match self.heading {
            Heading::Any => HeadingRule::Any,
            Heading::Forward => HeadingRule::Forward,
            Heading::Sideways => HeadingRule::Sideways,
        };
        let problem = SpeedProblem {
            bounds,
            period: self.period,
            threads: threads::available(),
            ..SpeedProblem::new(file.swimmer, rates).led(heading)
        };
        let (mut farthest, mut robustness) = (None, None);
        let found = task.watched(SEARCHING, |watch| -> Outcome<_> {
            if let Some((uncertainty, over)) = &uncertain {
                let found = robust_speed(&problem, uncertainty, *over, watch)
                    .map_err(|error| refused(error, &self.bounds))?;
                robustness = Some(found.robustness);
                Ok(found.fastest)
            } else if self.front.is_some() {
                let front = farthest.insert(front(&problem, watch)?);
                Ok(front.fastest.clone())
            } else {
                Ok(problem.watched(watch)?)
            }
        })?;
        let (kind, gait) = match robustness {
            Some(_) => ("robust fastest", &as_written(&found.gait)),
            None => ("fastest", &found.gait),
        };
        let mut document = document_of(kind, file, &found);
        if let Some(robustness) = &robustness {
            add_robustness(&mut document, robustness, "|d|/(L T)");
        }
        if robustness.is_none() && self.period.is_none() && heading != HeadingRule::Any {
            add_any_heading(&mut document, &problem, found.speed_over_length)?;
        }
        let servo = file
            .servo
            .or(self.bounds.playable().then(ServoFile::default));
        add_as_played(
            &mut document,
            file,
            servo,
            (gait, found.period - found.rest),
        );
        if let (Some(place), Some(farthest)) = (&self.front, &farthest) {
            place.write(farthest, file, &mut document)?;
        }
        Ok(SearchResult::gait(document, task, gait, None))
    }
}

/// Adds the speed of the fastest gait of any heading to the output of a gait with a prescribed heading.
fn add_any_heading(document: &mut Document, led: &SpeedProblem, speed: f64) -> Outcome<()> {
    let any = fastest(&led.led(HeadingRule::Any))?.speed_over_length;
    document.key("any_heading_speed_over_length_per_s", any);
    let more = any / speed - 1.0;
    if more > 1e-6 {
        let bound = format!(
            "{:.2} % faster: long cycles that tack come near it",
            more * 100.0
        );
        document.row("any heading", bound);
    }
    Ok(())
}

/// Output of a gait of this kind, without robustness, servos and front.
fn document_of(kind: &str, file: &SwimmerFile, found: &Fastest) -> Document {
    let speed = found.speed_over_length;
    let way = found.distance_over_length;
    let mut document = at_pace(kind, file, (speed, way), found.period);
    document
        // Of the displacement against the cycle's mean heading.
        .key("heading_rad", found.heading)
        .key("rotation_rad", found.gait.rotation)
        .row(
            "leads",
            format!("{} off the mean heading", quantity::angle(found.heading)),
        )
        .row(
            "found",
            format!("from {} of {} starts", found.found, found.starts),
        );
    if let Some(moves) = found.gait.optimal_period {
        document.key("rest_s", found.rest);
        if found.rest > 0.0 {
            document.row(
                "rests",
                format!("{:.6} s after a cycle of {moves:.6} s", found.rest),
            );
        }
    }
    add_arcs(&mut document, &found.gait.arcs);
    document
        // Fractions of the period where a servo turns round or stops, and how many a cycle may have.
        .key("corners", found.gait.corners().to_vec())
        .key("max_corners", SpeedProblem::MAX_CORNERS)
        // Closed curves that were started from, and how many led to this gait.
        .key("starts", found.starts)
        .key("found", found.found)
        // Of a certified cycle with more corners, where one is better by more than 1e-6 of it.
        .key("longer_speed_over_length_per_s", found.longer)
        // Of a faster chain of arcs that failed its certificate.
        .key("uncertified_speed_over_length_per_s", found.uncertified);
    let better = |other: f64| format!("{:.4} % faster", (other / speed - 1.0) * 100.0);
    if let Some(longer) = found.longer {
        document.row(
            "longer cycle",
            format!(
                "one of more than {} corners is {}",
                SpeedProblem::MAX_CORNERS,
                better(longer)
            ),
        );
    }
    if let Some(uncertified) = found.uncertified {
        document.row(
            "not certified",
            format!(
                "another chain of arcs is {}, but meets not all conditions",
                better(uncertified)
            ),
        );
    }
    document
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
