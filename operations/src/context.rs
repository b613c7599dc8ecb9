//! Surroundings of an operation: files, warnings, threads, clock and progress.

use std::fmt;

use crate::Cancel;

/// Access to files by path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Files {
    /// The file system of this machine.
    Disk,
    /// None: the lab page has no file system, and gets the texts of files.
    Unavailable,
}

/// Stage of a long computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Search of unknown length.
    Search,
    /// Search for closed curves.
    ClosedCurves,
    /// Search for loops.
    Loops,
    /// Search for the fastest gait.
    FastestGait,
    /// Search for gaits that join.
    JoiningGaits,
    /// Search for all optima.
    Optima,
    /// Continuation of gaits.
    Continuation,
    /// Search for a plan.
    Plan,
    /// Blocks of a sweep.
    Blocks,
}

/// Progress of a long computation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Progress {
    /// A stage begins.
    Begin(Stage),
    /// This share of the stage is complete; less than before if it begins again.
    Share(f64),
    /// The stage ends.
    End,
}

/// Receiver of progress, which may be called from any thread.
pub type Watch = Box<dyn Fn(Progress) + Send + Sync>;

/// Surroundings of an operation.
pub struct Context {
    /// Access to files by path.
    pub files: Files,
    /// Warnings and notes for the user, in the order in which they arose, each a sentence.
    pub warnings: Vec<String>,
    /// Number of threads of a search; results do not depend on it.
    pub threads: usize,
    /// Clock \[s\] from any start, for the duration of searches; `None` leaves durations out of the outputs.
    pub clock: Option<fn() -> f64>,
    /// Receiver of progress.
    pub watch: Watch,
    /// Request of the caller to end the computation.
    pub cancel: Cancel,
}

impl Context {
    /// A context with the file system of this machine, one thread, no clock and no progress.
    pub fn on_disk() -> Self {
        Self {
            files: Files::Disk,
            warnings: Vec::new(),
            threads: 1,
            clock: None,
            watch: Box::new(|_| ()),
            cancel: Cancel::default(),
        }
    }

    /// The same without a file system, as in a browser.
    pub fn without_files() -> Self {
        Self {
            files: Files::Unavailable,
            ..Self::on_disk()
        }
    }

    /// Adds a warning.
    pub(crate) fn warn(&mut self, warning: impl Into<String>) {
        self.warnings.push(warning.into());
    }

    /// Runs a stage, which reports the completed share, and measures its duration. A request to cancel ends it when it reports.
    pub(crate) fn timed<T>(
        &self,
        stage: Stage,
        compute: impl FnOnce(&(dyn Fn(f64) + Sync)) -> T,
    ) -> Timed<T> {
        self.cancel.check();
        let begun = self.clock.map(|clock| clock());
        (self.watch)(Progress::Begin(stage));
        let result = compute(&|share| {
            self.cancel.check();
            (self.watch)(Progress::Share(share));
        });
        (self.watch)(Progress::End);
        let ended = self.clock.map(|clock| clock());
        Timed {
            result,
            seconds: ended.zip(begun).map(|(ended, begun)| ended - begun),
        }
    }
}

/// Result of a stage.
pub(crate) struct Timed<T> {
    pub(crate) result: T,
    /// Duration \[s\]; `None` without a clock.
    pub(crate) seconds: Option<f64>,
}

impl fmt::Debug for Context {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Context")
            .field("files", &self.files)
            .field("warnings", &self.warnings)
            .field("threads", &self.threads)
            .finish_non_exhaustive()
    }
}
