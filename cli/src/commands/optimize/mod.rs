//! `swimmer optimize`: one subcommand for each objective. Each file has the options of an objective, their conversion to a request,
//! and the text of the output. [`Search`] writes the gait and prints.

mod displacement;
mod efficiency;
pub(crate) mod front;
mod passive;
mod robust;
mod sideways;
mod speed;
pub(crate) mod steer;
mod text;
mod timing;
mod turning;

use std::path::PathBuf;

use operations::optimize::GaitOutput;
use operations::{Context, SwimmerSource};
use serde::Serialize;

use crate::context::context;
use crate::failure::Outcome;
use crate::new_file::may_be_written;
use crate::output::{Output, asides};

/// Find an optimal gait
#[derive(Debug, clap::Subcommand)]
pub(crate) enum Optimize {
    Displacement(Search<displacement::Displacement>),
    Efficiency(Search<efficiency::Efficiency>),
    Turning(Search<turning::Turning>),
    Sideways(Search<sideways::Sideways>),
    Speed(Search<speed::Speed>),
    Steer(steer::Search),
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
    /// Help text of `-o`.
    const WRITES: &'static str =
        "Write the gait, at constant power or as timed for the servos, as a gait file";

    /// Output of the search.
    type Output: Serialize;

    /// Searches for the best gait.
    ///
    /// # Errors
    /// Those of the search; nothing has been written then.
    fn search(&self, swimmer: SwimmerSource, context: &mut Context) -> Outcome<Self::Output>;

    /// Gait of an output.
    fn gait(output: &mut Self::Output) -> &mut GaitOutput;

    /// Output as text.
    fn text(output: &Self::Output) -> String;
}

// Its help is the objective's.
#[derive(Debug, clap::Args)]
pub(crate) struct Search<O: Objective> {
    /// A preset that `swimmer swimmers` lists, or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    #[command(flatten)]
    objective: O,
    #[arg(short, long, value_name = "FILE", help = O::WRITES)]
    output: Option<PathBuf>,
}

impl<O: Objective> Search<O> {
    fn run(self, output: Output) -> Outcome {
        self.output.as_deref().map_or(Ok(()), may_be_written)?;
        let mut context = context();
        let swimmer = SwimmerSource::from(self.swimmer.as_str());
        let found = self.objective.search(swimmer, &mut context);
        asides(&context);
        let mut found = found?;
        if let Some(path) = self.output {
            let gait = O::gait(&mut found);
            gait.file.save(&path)?;
            gait.gait = Some(path);
        }
        output.rendered(&found, &O::text(&found));
        Ok(())
    }
}
