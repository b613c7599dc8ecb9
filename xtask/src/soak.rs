//! `cargo xtask soak`: runs the long tests that are not part of every check.

use crate::emulator;
use crate::failure::Outcome;
use crate::firmware::{self, Variant};
use crate::run::{cargo, run};
use crate::toolchain::{Target, Toolchain};

/// Provides images and emulator for the tests of the booted firmware.
fn prepare() -> Outcome {
    emulator::install()?;
    let toolchain = Toolchain::find_or_make(Target::Chip)?;
    Variant::TESTED
        .into_iter()
        .try_for_each(|variant| firmware::build(&toolchain, variant))
}

/// Runs every test marked `#[ignore]` in release mode, one after the other, and shows the output.
///
/// # Errors
/// A test fails, or images or emulator are not available.
pub(crate) fn run_ignored(filter: Option<&str>) -> Outcome {
    prepare()?;
    let mut test = cargo(["test", "--workspace", "--release", "--no-fail-fast"]);
    // No doctests: examples marked `ignore` are not meant to run.
    test.args(["--lib", "--bins", "--tests"]).args(filter);
    test.args(["--", "--ignored", "--nocapture", "--test-threads=1"]);
    run(&mut test, "fix what the tests report above")
}
