//! Experiments for a caller in the same process: the outputs of `swimmer experiment` as values.

use std::path::PathBuf;

use serde::Serialize;

use crate::captured::noted;
use crate::commands::experiment::{self, ExperimentPaths};
use crate::commands::robot::{IsInterrupted, Reply, RobotOptions};
use crate::interrupt::Interrupt;

/// Spec of an experiment, and its folder.
#[derive(Debug, Clone)]
pub struct Experiment {
    /// Path of the spec.
    pub spec: PathBuf,
    /// Folder; `None`: named as the spec, next to it.
    pub folder: Option<PathBuf>,
}

impl Experiment {
    fn paths(&self) -> ExperimentPaths {
        ExperimentPaths::new(self.spec.clone(), self.folder.clone())
    }

    /// Computes the gaits, fixes the order of the trials, and writes the folder.
    ///
    /// # Errors
    /// An invalid spec, a gait that cannot be found or played, and a folder that exists.
    pub fn plan(&self) -> Reply<impl Serialize + use<>> {
        noted(|| experiment::plan(&self.paths()))
    }

    /// Plays the trials that are left. It polls `is_interrupted`, and `true` stops the robot.
    ///
    /// # Errors
    /// The reason for which the run ended early: the same call goes on.
    pub fn run(
        &self,
        robot: &RobotOptions,
        is_interrupted: IsInterrupted,
    ) -> Reply<impl Serialize + use<>> {
        noted(|| {
            let (access, tracked) = robot.tracked()?;
            let interrupt = Interrupt::polled(is_interrupted);
            experiment::play(&self.paths(), &access, &tracked, interrupt)
        })
    }

    /// Progress by the journal.
    ///
    /// # Errors
    /// A folder or a journal that cannot be read.
    pub fn status(&self) -> Reply<impl Serialize + use<>> {
        noted(|| experiment::status(&self.paths()))
    }

    /// Compares the gaits, and writes report.json and report.html.
    ///
    /// # Errors
    /// A folder or a journal that cannot be read, and a disk that refuses.
    pub fn report(&self) -> Reply<impl Serialize + use<>> {
        noted(|| experiment::report(&self.paths()))
    }
}
