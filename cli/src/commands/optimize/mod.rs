//! `swimmer optimize`: one command over an objective. [`Search`] loads the swimmer, writes and tells what is found; each objective
//! has a file, with its options, its search and how its gait is told.

pub(crate) mod answer;
mod displacement;
mod efficiency;
mod front;
mod pace;
mod robust;
mod sideways;
mod speed;
pub(crate) mod steer;
mod timing;
mod turning;

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::time::Instant;

use swimmer_files::{GaitFile, SwimmerFile};

use crate::arguments::load_swimmer;
use crate::document::Document;
use crate::failure::Outcome;
use crate::new_file::may_be_written;
use crate::new_folder::NewFolder;
use crate::output::Output;
use crate::progress::Progress;

/// Find an optimal gait
#[derive(Debug, clap::Subcommand)]
pub(crate) enum Optimize {
    Displacement(Search<displacement::Displacement>),
    Efficiency(Search<efficiency::Efficiency>),
    Turning(Search<turning::Turning>),
    Sideways(Search<sideways::Sideways>),
    Speed(Search<speed::Speed>),
    Steer(Search<steer::Steer>),
}

impl Optimize {
    /// Finds the gait that was asked for.
    pub(crate) fn run(self, output: Output) -> Outcome {
        match self {
            Self::Displacement(search) => search.run(output),
            Self::Efficiency(search) => search.run(output),
            Self::Turning(search) => search.run(output),
            Self::Sideways(search) => search.run(output),
            Self::Speed(search) => search.run(output),
            Self::Steer(search) => search.run(output),
        }
    }
}

/// What gaits are optimal for, with the options that belong to it.
pub(crate) trait Objective: clap::Args {
    /// Whether `-o` is a folder of gaits.
    const FOLDER: bool = false;
    /// What `-o` does.
    const WRITES: &'static str =
        "Write the gait, at constant power or as timed for the servos, as a gait file";

    /// Finds the best gait, and says how it is told.
    ///
    /// # Errors
    /// Those of the search; nothing has been written then.
    fn search(&self, task: &Task) -> Outcome<Found>;
}

/// For which swimmer, and where to.
pub(crate) struct Task<'a> {
    file: SwimmerFile,
    output: Option<&'a Path>,
    /// What the search took.
    seconds: Cell<f64>,
}

impl Task<'_> {
    /// Runs the search, whose time is told.
    fn timed<T>(&self, search: impl FnOnce() -> T) -> T {
        let begun = Instant::now();
        let found = search();
        self.seconds.set(begun.elapsed().as_secs_f64());
        found
    }

    /// The same with its progress shown.
    fn watched<T>(&self, what: &str, search: impl FnOnce(&(dyn Fn(f64) + Sync)) -> T) -> T {
        let progress = Progress::of_a_whole(what);
        self.timed(|| search(&|share| progress.at_share(share)))
    }
}

/// What a search leads to.
pub(crate) struct Found {
    answer: Document,
    /// As written; the names are those in a folder.
    gaits: Vec<(String, GaitFile)>,
}

// Its help is the objective's.
#[derive(Debug, clap::Args)]
pub(crate) struct Search<O: Objective> {
    /// purcell, robot, robot-slender or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    #[command(flatten)]
    objective: O,
    #[arg(short, long, value_name = if O::FOLDER { "DIR" } else { "FILE" }, help = O::WRITES)]
    output: Option<PathBuf>,
}

impl<O: Objective> Search<O> {
    fn run(self, output: Output) -> Outcome {
        let place = self.output.as_deref();
        let folder = place
            .filter(|_| O::FOLDER)
            .map(NewFolder::start)
            .transpose()?;
        if folder.is_none() {
            place.map_or(Ok(()), may_be_written)?;
        }
        let task = Task {
            file: load_swimmer(&self.swimmer)?,
            output: place,
            seconds: Cell::default(),
        };
        let found = self.objective.search(&task)?;
        for (name, gait) in &found.gaits {
            match (&folder, place) {
                (Some(folder), _) => gait.save(&folder.draft().join(name))?,
                (None, Some(file)) => gait.save(file)?,
                (None, None) => {}
            }
        }
        folder.map_or(Ok(()), NewFolder::publish)?;
        output.answer(&found.answer);
        Ok(())
    }
}
