//! `cargo xtask soak`: the tests that take too long for every change.

use crate::failure::Outcome;
use crate::run::{cargo, run};

/// Runs every test marked `#[ignore]`, in release, one after the other, with what it prints.
///
/// # Errors
/// When one fails.
pub(crate) fn run_ignored(filter: Option<&str>) -> Outcome {
    let mut test = cargo(["test", "--workspace", "--release", "--no-fail-fast"]);
    // No doctests: an example marked `ignore` is not meant to run.
    test.args(["--lib", "--bins", "--tests"]).args(filter);
    test.args(["--", "--ignored", "--nocapture", "--test-threads=1"]);
    run(&mut test, "mend what the tests name above")
}
