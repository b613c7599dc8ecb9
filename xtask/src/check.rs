//! `cargo xtask test`: all checks and tests that a change must pass.

use std::process::Command;

use crate::book;
use crate::debian;
use crate::emulator;
use crate::failure::Outcome;
use crate::firmware::{self, Variant};
use crate::lab;
use crate::python;
use crate::run::{cargo, command, read, run};
use crate::slurm;
use crate::steps::Steps;
use crate::toolchain::{Target, Toolchain};

/// Crates that also run on the chip.
const ON_THE_CHIP: [&str; 3] = ["swimmer-model", "link-protocol", "gait-player"];

/// All crates but the book's builder. mdbook turns on features of common crates: built together with it, they and all crates above
/// them would be built again for the wheel.
const OURS: [&str; 3] = ["--workspace", "--exclude", "book"];

/// The fuzz targets' own workspace.
const FUZZ: &str = "fuzz/Cargo.toml";

/// Runs all steps, cheap ones first, continues after a failure, and prints the time of each step.
///
/// # Errors
/// The failed steps.
pub(crate) fn all() -> Outcome {
    let mut steps = Steps::default();
    let toolchain = steps.take("what is needed", what_is_needed);
    steps.take("format", || {
        run(
            &mut cargo(["fmt", "--all", "--check"]),
            "run `cargo fmt --all`",
        )?;
        run(
            &mut cargo(["fmt", "--check", "--manifest-path", FUZZ]),
            &format!("run `cargo fmt --manifest-path {FUZZ}`"),
        )
    });
    if let Some(toolchain) = toolchain {
        for_the_chip(&mut steps, &toolchain);
    }
    // Without the emulator the tests of the booted firmware fail; this step reports the reason.
    steps.take("emulator for the firmware", emulator::install);
    // Other systems than Debian have no Slurm here and skip the test with a message; CI requires it.
    let required = std::env::var("CI").is_ok_and(|ci| ci == "true");
    steps.take("Slurm for the test of job arrays", || {
        slurm::unpack().or_else(|failure| {
            println!("{failure}");
            if required { Err(failure) } else { Ok(()) }
        })
    });
    // A system test reads the twin's NatNet stream with a Python package, in an environment of its own.
    steps.take("Python for system tests", || {
        python::ensure().or_else(|failure| {
            println!("{failure}");
            if required { Err(failure) } else { Ok(()) }
        })
    });
    steps.take("clippy for the host", || {
        run(
            cargo(["clippy", "--all-targets"])
                .args(OURS)
                .args(["--", "-D", "warnings"]),
            "fix what clippy reports above",
        )
    });
    steps.take("fuzz targets, checked", || {
        run(
            // If this path is set, libFuzzer is not compiled, which would need a C++ compiler and a minute. Nothing is linked here.
            cargo(["clippy", "--manifest-path", FUZZ, "--all-targets"])
                .args(["--", "-D", "warnings"])
                .env("CUSTOM_LIBFUZZER_PATH", "target/libfuzzer.a"),
            "fix the targets under fuzz/",
        )
    });
    steps.take("documentation", || {
        run(
            cargo(["doc", "--no-deps"])
                .args(OURS)
                .env("RUSTDOCFLAGS", "-Dwarnings"),
            "fix what rustdoc reports above",
        )
    });
    steps.take("book: builder, pages, formulas, links", || {
        book::test()?;
        book::build()
    });
    steps.take("tests and doctests", || {
        run(
            cargo(["test", "--no-fail-fast"]).args(OURS),
            "fix what the tests report above",
        )
    });
    // A developer may continue without these tests, CI may not. The tests above have built the command.
    steps.take("lab page: sizes, command, browsers", || lab::test(required));
    steps.take("Python wheel", || python::test(required));
    println!("\n{}", steps.summary());
    steps.verdict()
}

fn for_the_chip(steps: &mut Steps, toolchain: &Toolchain) {
    steps.take("firmware: ELF, UF2, sizes", || {
        Variant::TESTED
            .into_iter()
            .try_for_each(|variant| firmware::build(toolchain, variant))
    });
    steps.take("clippy for the chip", || {
        let mut clippy = toolchain.clippy();
        packages(&mut clippy, &ON_THE_CHIP);
        packages(&mut clippy, &["firmware"]);
        run(
            clippy.args(toolchain.clippy_flags()),
            "fix what clippy reports above",
        )
    });
}

fn packages(cargo: &mut Command, names: &[&str]) {
    for name in names {
        cargo.args(["-p", name]);
    }
}

/// Finds every required tool, or installs it.
fn what_is_needed() -> Outcome<Toolchain> {
    debian::ensure_tool(command("cc").arg("--version"), &["gcc", "libc6-dev"])?;
    for component in ["fmt", "clippy"] {
        let next = "run `rustup component add rustfmt clippy`, and repeat the command";
        println!(
            "{}",
            read(&mut cargo([component, "--version"]), next)?.trim()
        );
    }
    let toolchain = Toolchain::find_or_make(Target::Chip)?;
    println!("{}", toolchain.describe());
    Ok(toolchain)
}
