//! Surroundings of operations at a terminal: file system, threads, clock and progress line.

use std::sync::{LazyLock, Mutex};
use std::time::Instant;

use operations::{Context, Error, Progress, Stage, Watch};

use crate::failure::Outcome;
use crate::interrupt::locked;
use crate::output::asides;
use crate::progress::Progress as Line;
use crate::threads;

/// Runs an operation on the file system and prints its warnings.
pub(crate) fn perform<T>(operation: impl FnOnce(&mut Context) -> Result<T, Error>) -> Outcome<T> {
    let mut context = context();
    let done = operation(&mut context);
    asides(&context);
    Ok(done?)
}

/// Surroundings of an operation.
pub(crate) fn context() -> Context {
    Context {
        threads: threads::available(),
        clock: Some(seconds),
        watch: watch(),
        ..Context::on_disk()
    }
}

/// Time since the first call \[s\].
fn seconds() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    START.elapsed().as_secs_f64()
}

/// Shows progress on a line at the terminal.
fn watch() -> Watch {
    let line: Mutex<Option<Line>> = Mutex::new(None);
    Box::new(move |progress| {
        let mut line = locked(&line);
        match progress {
            Progress::Begin(stage) => *line = Some(line_of(stage)),
            Progress::Share(share) => {
                if let Some(line) = line.as_ref() {
                    line.at_share(share);
                }
            }
            Progress::End => *line = None,
        }
    })
}

fn line_of(stage: Stage) -> Line {
    match stage {
        Stage::Search => Line::of_unknown_length("searching; a bounded gait can take a minute"),
        Stage::ClosedCurves => Line::with_share("looking for closed curves"),
        Stage::Loops => Line::with_share("looking for loops"),
        Stage::FastestGait => Line::with_share("looking for the fastest gait"),
        Stage::JoiningGaits => Line::with_share("looking for gaits that join"),
        Stage::Optima => Line::with_share("looking for optima"),
        Stage::Continuation => Line::with_share("following the gaits"),
        Stage::Plan => Line::with_share("searching for a plan"),
        Stage::Blocks => Line::with_share("solving the blocks"),
    }
}
