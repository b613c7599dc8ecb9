//! `cargo xtask soak`: the tests that take too long for every change.

use crate::emulator;
use crate::failure::Outcome;
use crate::firmware::{self, Variant};
use crate::run::{cargo, run};
use crate::toolchain::{Target, Toolchain};

/// Provides what the tests of the booted firmware need.
fn prepare() -> Outcome {
    emulator::install()?;
    let toolchain = Toolchain::find_or_make(Target::Chip)?;
    Variant::TESTED
        .into_iter()
        .try_for_each(|variant| firmware::build(&toolchain, variant))
}

/// Runs every test marked `#[ignore]`, in release, one after the other, with what it prints.
///
/// # Errors
/// When one fails, or what the tests of the booted firmware need cannot be had.
pub(crate) fn run_ignored(filter: Option<&str>) -> Outcome {
    prepare()?;
    let mut test = cargo(["test", "--workspace", "--release", "--no-fail-fast"]);
    // No doctests: an example marked `ignore` is not meant to run.
    test.args(["--lib", "--bins", "--tests"]).args(filter);
    test.args(["--", "--ignored", "--nocapture", "--test-threads=1"]);
    run(&mut test, "mend what the tests name above")
}
