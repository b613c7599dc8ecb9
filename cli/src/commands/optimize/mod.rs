//! `swimmer optimize`: finds an optimal gait and, with `-o`, writes it. One file for each objective.

pub(crate) mod answer;
mod better;
mod displacement;
mod efficiency;
mod front;
mod limited;
mod no_optimum;
mod robust;
mod sideways;
mod speed;
pub(crate) mod steer;
mod timing;
mod turning;

use std::path::Path;

use crate::failure::Outcome;
use crate::new_file::may_be_written;
use crate::output::Output;

/// Find an optimal gait
#[derive(Debug, clap::Subcommand)]
pub(crate) enum Optimize {
    Displacement(displacement::Displacement),
    Efficiency(efficiency::Efficiency),
    Turning(turning::Turning),
    Sideways(sideways::Sideways),
    Speed(speed::Speed),
    Steer(steer::Steer),
}

impl Optimize {
    /// Finds the gait that was asked for.
    pub(crate) fn run(self, output: Output) -> Outcome {
        self.file().map_or(Ok(()), may_be_written)?;
        match self {
            Self::Displacement(arguments) => arguments.run(output),
            Self::Efficiency(arguments) => arguments.run(output),
            Self::Turning(arguments) => arguments.run(output),
            Self::Sideways(arguments) => arguments.run(output),
            Self::Speed(arguments) => arguments.run(output),
            Self::Steer(arguments) => arguments.run(output),
        }
    }

    /// Where the gait shall be written.
    fn file(&self) -> Option<&Path> {
        let file = match self {
            Self::Displacement(arguments) => &arguments.output,
            Self::Efficiency(arguments) => &arguments.output,
            Self::Turning(arguments) => &arguments.output,
            Self::Sideways(arguments) => &arguments.output,
            Self::Speed(arguments) => &arguments.output,
            // A folder, which looks after itself.
            Self::Steer(_) => &None,
        };
        file.as_deref()
    }
}
