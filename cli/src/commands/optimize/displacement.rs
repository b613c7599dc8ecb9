//! `swimmer optimize displacement`: the gait of most displacement per cycle.

use gait_optimizer::{
    DisplacementError, DisplacementProblem, Heading, OptimalGait, displacement, robust_displacement,
};

use super::closed::Closed;
use super::output::{add_quarter, say_if_beyond};
use super::robust::{Robustly, refused, robust_gait};
use super::timing::ServoTiming;
use super::{Objective, SearchResult, Task};
use crate::bounds::QuarterBounds;
use crate::document::Document;
use crate::failure::{Failure, Outcome};
use crate::playable::searched;

/// Find the simple gait of most displacement per cycle by the maximum principle, with its certificate
///
/// Simple closed curves with the paper's two symmetries, or any simple closed curve if the side links differ. The farthest gait of either sense, run so that it swims forwards (X > 0):
/// if that is clockwise, the arcs and the start angle printed are those of the counter-clockwise quarter. --sign takes the
/// local optimum of one sense instead, run counter-clockwise as in the paper: + for its gaits (a) and (b), - for (c) and (d).
#[derive(Debug, clap::Args)]
pub(crate) struct Displacement {
    #[command(flatten)]
    bounds: QuarterBounds,
    /// The sign of X, run counter-clockwise: + or -; the farther of both, swum forwards, unless given
    #[arg(long, value_name = "SIGN", value_parser = sign, allow_hyphen_values = true)]
    sign: Option<Heading>,
    #[command(flatten)]
    robustly: Robustly,
    #[command(flatten)]
    timing: ServoTiming,
}

impl Objective for Displacement {
    fn search(&self, task: &Task) -> Outcome<SearchResult> {
        let problem = DisplacementProblem {
            bounds: self.bounds.of(&task.file),
            heading: self.sign,
            ..DisplacementProblem::new(task.file.swimmer)
        };
        if let Some((uncertainty, over)) = self.robustly.load(&task.file)? {
            let found = task
                .timed(|| robust_displacement(&problem, &uncertainty, over))
                .map_err(|error| refused(error, &self.bounds))?;
            return robust_gait(task, ("displacement", "X/L"), found, &self.timing);
        }
        let is_playable = self.bounds.playable();
        if !task.file.swimmer.is_symmetric() {
            if self.sign.is_some() {
                return Err(Failure::BadInput(
                    "--sign is that of gaits with the paper's symmetries, and the side links of this swimmer differ: leave it out"
                        .to_owned(),
                ));
            }
            let objective = swimmer_files::Objective::Displacement;
            let found = Closed::search(task, objective, problem.bounds, is_playable)?;
            say_if_beyond(task, found.gait());
            let timed = self.timing.of(task, found.gait())?;
            let title = format!("{}, a local optimum of displacement", task.file.name);
            let mut document = Document::new(title);
            found.add(&mut document, objective);
            return Ok(SearchResult::gait(document, task, found.gait(), timed));
        }
        let search = |bounds| Ok(displacement(&DisplacementProblem { bounds, ..problem })?);
        let gait = task.timed(|| {
            let robot = (&task.file, is_playable);
            searched(robot, problem.bounds, |gait| gait, search)
        })?;
        say_if_beyond(task, &gait);
        let timed = self.timing.of(task, &gait)?;
        let mut document = Document::new(format!(
            "{}, a local optimum of displacement",
            task.file.name
        ));
        add_quarter(&mut document, &gait);
        document
            .key_if("extremals", gait.extremals)
            .row("best of", class(&gait, self.sign));
        Ok(SearchResult::gait(document, task, &gait, timed))
    }
}

/// The class of gaits that this one is the best of.
fn class(gait: &OptimalGait, sign: Option<Heading>) -> String {
    let of = match gait.extremals {
        None => String::new(),
        Some(1) => "the only extremal found ".to_owned(),
        Some(count) => format!("the {count} extremals found "),
    };
    let sign_of_x = if (gait.displacement > 0.0) == gait.is_clockwise() {
        "<"
    } else {
        ">"
    };
    let both = match sign {
        None => ", the farther sense",
        Some(_) => "",
    };
    format!(
        "{of}with the paper's symmetries and X {sign_of_x} 0 counter-clockwise{both}; `swimmer atlas --objective displacement` \
         looks beyond"
    )
}

fn sign(text: &str) -> Result<Heading, String> {
    match text {
        "+" => Ok(Heading::Forwards),
        "-" => Ok(Heading::Backwards),
        _ => Err("write + or -".to_owned()),
    }
}

impl From<DisplacementError> for Failure {
    /// An invalid problem is bad input; one without an optimum was tried.
    fn from(error: DisplacementError) -> Self {
        match error {
            DisplacementError::Problem(_) => Self::bad_input(&error),
            _ => Self::tried_with_details(&error, error.details()),
        }
    }
}
