//! Progress and remaining time, for people at a terminal; silent otherwise.

use std::fmt::Write;
use std::io::IsTerminal;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use indicatif::style::ProgressTracker;
use indicatif::{ProgressBar, ProgressState, ProgressStyle};

use crate::interrupt::locked;
use crate::output::for_scripts;

/// A progress line on standard error; shown only if that is a terminal and `--json` is not set.
#[derive(Debug)]
pub(crate) struct Progress(ProgressBar);

/// Narrower terminals show no bar: what is done and how long it takes says more.
const ROOM_FOR_A_BAR: u16 = 60;
/// Before this share is done, how long the rest takes is a guess.
const TELLING: f64 = 0.03;

impl Progress {
    /// A bar of `steps` steps.
    pub(crate) fn of_steps(steps: u64) -> Self {
        Self::drawn(ProgressBar::new(steps), "{pos:>3}/{len}", left)
    }

    /// A bar of `bytes` bytes.
    pub(crate) fn of_bytes(bytes: u64) -> Self {
        Self::drawn(ProgressBar::new(bytes), "{pos:>5}/{len} bytes", left)
    }

    /// A bar of one whole, whose share is set with [`Self::at_share`].
    pub(crate) fn with_share(what: &str) -> Self {
        let progress = Self::drawn(ProgressBar::new(1000), "{percent:>3} %", left);
        progress.doing(what);
        progress
    }

    /// A line with the time since its start, for work of unknown length.
    pub(crate) fn of_unknown_length(what: &'static str) -> Self {
        if !is_shown() {
            return Self(ProgressBar::hidden());
        }
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {wide_msg}") {
            bar.set_style(style);
        }
        bar.set_message(what);
        bar.enable_steady_tick(Duration::from_millis(100));
        Self(bar)
    }

    fn drawn(bar: ProgressBar, count: &str, left: impl ProgressTracker + 'static) -> Self {
        if !is_shown() {
            return Self(ProgressBar::hidden());
        }
        let template = if columns() < ROOM_FOR_A_BAR {
            "{wide_msg} {left}".to_owned()
        } else {
            format!("{{bar:28}} {count} {{left}} {{wide_msg}}")
        };
        if let Ok(style) = ProgressStyle::with_template(&template) {
            bar.set_style(style.progress_chars("━╸ ").with_key("left", left));
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Self(bar)
    }

    /// Names what is being done now.
    pub(crate) fn doing(&self, what: impl Into<String>) {
        self.0.set_message(what.into());
    }

    /// One step is done.
    pub(crate) fn step(&self) {
        self.0.inc(1);
    }

    /// This share of the whole is done; less than before where the work begins again.
    pub(crate) fn at_share(&self, share: f64) {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // 0 to 1000; saturates
        let position = (1000.0 * share) as u64;
        // Threads may report in another order than they counted.
        if position + 500 < self.0.position() {
            self.0.reset_elapsed();
            self.0.set_position(position);
        } else {
            self.0.set_position(position.max(self.0.position()));
        }
    }

    /// So much is done.
    pub(crate) fn at(&self, position: u64) {
        self.0.set_position(position);
    }
}

/// Returns `true` if a person looks at standard error.
fn is_shown() -> bool {
    std::io::stderr().is_terminal() && !for_scripts()
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Width of the terminal on standard error; a default if it is unknown.
fn columns() -> u16 {
    #[cfg(unix)]
    let width = rustix::termios::tcgetwinsize(std::io::stderr()).map(|size| size.ws_col);
    #[cfg(not(unix))]
    let width = crossterm::terminal::size().map(|(columns, _)| columns);
    width
        .ok()
        .filter(|columns| *columns > 0)
        .unwrap_or(ROOM_FOR_A_BAR)
}

/// Remaining time, if the rest goes as fast as the work so far.
fn left(state: &ProgressState, out: &mut dyn Write) {
    let share = f64::from(state.fraction());
    if share < TELLING {
        return;
    }
    say_left(state.elapsed().as_secs_f64() * (1.0 - share) / share, out);
}

fn say_left(seconds: f64, out: &mut dyn Write) {
    // A line that cannot be written is no reason to fail.
    let _ = if seconds < 90.0 {
        write!(out, "{seconds:.0} s left")
    } else {
        write!(out, "{:.0} min left", seconds / 60.0)
    };
}

/// Stages of a command, one after the other, each with the time that it takes as a rule.
#[derive(Debug)]
pub(crate) struct Stages {
    progress: Progress,
    pace: Arc<Mutex<Pace>>,
    begun: Instant,
}

/// Progress over the stages; usual durations in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pace {
    /// Usual duration of all stages.
    usual: f64,
    /// Usual duration of the completed stages, and their real duration.
    done: f64,
    took: f64,
    /// Usual duration of the present stage.
    present: f64,
}

impl Pace {
    /// Remaining seconds, `elapsed` seconds after the beginning: the rest is slower than usual by the same factor as the work so
    /// far.
    fn left(&self, elapsed: f64) -> f64 {
        let slower = if self.done > 0.0 {
            self.took / self.done
        } else {
            1.0
        };
        let of_present = ((elapsed - self.took) / slower.max(1e-3)).min(self.present);
        slower * (self.usual - self.done - of_present).max(0.0)
    }
}

impl Stages {
    /// All that will come, by their usual times in seconds.
    pub(crate) fn new(usual: &[f64]) -> Self {
        let pace = Arc::new(Mutex::new(Pace {
            usual: usual.iter().sum(),
            done: 0.0,
            took: 0.0,
            present: 0.0,
        }));
        let (shared, begun) = (Arc::clone(&pace), Instant::now());
        let left = move |_: &ProgressState, out: &mut dyn Write| {
            let seconds = locked(&shared).left(begun.elapsed().as_secs_f64());
            say_left(seconds, out);
        };
        Self {
            progress: Progress::drawn(ProgressBar::new(1000), "{percent:>3} %", left),
            pace,
            begun,
        }
    }

    /// Begins the next stage, which usually takes `usual` seconds.
    pub(crate) fn next(&mut self, what: &str, usual: f64) {
        let mut pace = locked(&self.pace);
        pace.done += pace.present;
        pace.took = self.begun.elapsed().as_secs_f64();
        pace.present = usual;
        let share = pace.done / pace.usual.max(f64::MIN_POSITIVE);
        drop(pace);
        self.progress.doing(what);
        self.progress.at_share(share);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_follows_the_pace_so_far() {
        let begun = Pace {
            usual: 10.0,
            done: 0.0,
            took: 0.0,
            present: 4.0,
        };
        assert!((begun.left(0.0) - 10.0).abs() < 1e-12 && (begun.left(3.0) - 7.0).abs() < 1e-12);
        // A stage that takes longer than usual stands still at its end.
        assert!((begun.left(40.0) - 6.0).abs() < 1e-12);
        let slow = Pace {
            done: 4.0,
            took: 8.0,
            present: 6.0,
            ..begun
        };
        assert!((slow.left(8.0) - 12.0).abs() < 1e-12 && (slow.left(10.0) - 10.0).abs() < 1e-12);
        assert!(slow.left(100.0).abs() < 1e-12);
    }
}
