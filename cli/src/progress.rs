//! What is going on, for people at a terminal; silent everywhere else.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// A progress line on standard error; drawn only when that is a terminal.
#[derive(Debug)]
pub(crate) struct Progress(ProgressBar);

impl Progress {
    /// A bar of `steps` steps.
    pub(crate) fn of_steps(steps: u64) -> Self {
        Self::drawn(
            ProgressBar::new(steps),
            "{bar:28} {pos:>3}/{len} {wide_msg}",
        )
    }

    /// A bar of `bytes` bytes.
    pub(crate) fn of_bytes(bytes: u64) -> Self {
        Self::drawn(
            ProgressBar::new(bytes),
            "{bar:28} {pos:>5}/{len} bytes {wide_msg}",
        )
    }

    /// A bar of one whole, whose share is set with [`Self::at_share`].
    pub(crate) fn of_a_whole() -> Self {
        Self::drawn(ProgressBar::new(1000), "{bar:28} {wide_msg}")
    }

    fn drawn(bar: ProgressBar, template: &str) -> Self {
        if !std::io::stderr().is_terminal() {
            return Self(ProgressBar::hidden());
        }
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("━╸ "));
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

    /// This share of the whole is done.
    pub(crate) fn at_share(&self, share: f64) {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // 0 to 1000; saturates
        self.0.set_position((1000.0 * share) as u64);
    }

    /// So much is done.
    pub(crate) fn at(&self, position: u64) {
        self.0.set_position(position);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
