//! `swimmer optimize`: one subcommand for each objective. [`Search`] loads the swimmer, writes the gait and prints the output; each
//! objective has a file with its options, its search and the rows of its output.

mod closed;
mod displacement;
mod efficiency;
mod front;
pub(crate) mod output;
mod pace;
mod passive;
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
    Passive(passive::Passive),
}

impl Optimize {
    /// Searches for the gait of the subcommand.
    pub(crate) fn run(self, output: Output) -> Outcome {
        match self {
            Self::Displacement(search) => search.run(output),
            Self::Efficiency(search) => search.run(output),
            Self::Turning(search) => search.run(output),
            Self::Sideways(search) => search.run(output),
            Self::Speed(search) => search.run(output),
            Self::Steer(search) => search.run(output),
            Self::Passive(passive) => passive.run(output),
        }
    }
}

/// Objective of a search, with its options.
pub(crate) trait Objective: clap::Args {
    /// True if `-o` is a folder of gaits.
    const FOLDER: bool = false;
    /// Help text of `-o`.
    const WRITES: &'static str =
        "Write the gait, at constant power or as timed for the servos, as a gait file";

    /// Searches for the best gait, and returns it with its output.
    ///
    /// # Errors
    /// Those of the search; nothing has been written then.
    fn search(&self, task: &Task) -> Outcome<SearchResult>;
}

/// Swimmer of a search, and the file to write.
pub(crate) struct Task<'a> {
    file: SwimmerFile,
    output: Option<&'a Path>,
    /// Duration of the search.
    seconds: Cell<f64>,
}

impl Task<'_> {
    /// Runs the search, measures its duration and shows that it goes on.
    fn timed<T>(&self, search: impl FnOnce() -> T) -> T {
        let _progress = Progress::of_unknown_length("searching; a bounded gait can take a minute");
        self.measured(search)
    }

    fn measured<T>(&self, search: impl FnOnce() -> T) -> T {
        let begun = Instant::now();
        let found = search();
        self.seconds.set(begun.elapsed().as_secs_f64());
        found
    }

    /// Runs the search, measures its duration and shows its progress.
    fn watched<T>(&self, what: &str, search: impl FnOnce(&(dyn Fn(f64) + Sync)) -> T) -> T {
        let progress = Progress::with_share(what);
        self.measured(|| search(&|share| progress.at_share(share)))
    }
}

/// Result of a search.
pub(crate) struct SearchResult {
    document: Document,
    /// Gait files to write, with their names in a folder.
    gaits: Vec<(String, GaitFile)>,
}

// Its help is the objective's.
#[derive(Debug, clap::Args)]
pub(crate) struct Search<O: Objective> {
    /// A preset that `swimmer swimmers` lists, or a swimmer file
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
        output.print(&found.document);
        Ok(())
    }
}
