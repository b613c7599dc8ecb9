//! `cargo xtask mutants`: promise R14. Breaks the code that protects, one small change at a time, and lists the changes
//! that no test notices. What was found, and what cannot matter, stands in docs/carrying-on/mutants.md; `.cargo/mutants.toml` leaves the
//! latter out.

use crate::disk::make_folder;
use crate::failure::{Failure, Outcome};
use crate::run::{run, target_folder};
use crate::tools::MUTANTS;

/// What protects: which crate, and which of its files.
const GUARDS: [(&str, &[&str]); 2] = [
    (
        "link-protocol",
        &[
            "link-protocol/src/decoder.rs",
            "link-protocol/src/frame.rs",
            "link-protocol/src/seal.rs",
        ],
    ),
    (
        "gait-player",
        &[
            "gait-player/src/brain.rs",
            "gait-player/src/brain/*.rs",
            "gait-player/src/clamp.rs",
            "gait-player/src/limits.rs",
            "gait-player/src/servo.rs",
            "gait-player/src/starts.rs",
        ],
    ),
];

/// Left out: takes longer than all other tests together, and looks at paths between states, not at these files.
const NOT_FOR_EACH: &str = "brain::model_check";

/// Tries every mutant of one crate's guards, or of all; their lists are under target/mutants.
///
/// # Errors
/// One survives, or cargo-mutants is not there.
pub(crate) fn hunt(only: Option<&str>, install: bool) -> Outcome {
    let chosen: Vec<_> = GUARDS
        .iter()
        .filter(|(package, _)| only.is_none_or(|only| only == *package))
        .collect();
    if chosen.is_empty() {
        return Err(Failure::new(
            format!("looking for the guards of `{}`", only.unwrap_or_default()),
            "that crate has none",
            format!("name one of {:?}", GUARDS.map(|(package, _)| package)),
        ));
    }
    for (package, files) in chosen {
        let output = target_folder()?.join("mutants").join(package);
        make_folder(&output)?;
        let mut mutants = MUTANTS.cargo(install)?;
        mutants.args(["--package", package, "--output"]).arg(output);
        for file in *files {
            mutants.args(["--file", file]);
        }
        // Nobody steps through a mutant, and without the tables that this needs each is linked in half the time.
        mutants.env("CARGO_PROFILE_DEV_DEBUG", "0");
        // What a property found against one mutant must not be kept in the tree in which the next is tried: it would hide
        // that only luck found it, and a property that is itself broken would "catch" all that follow.
        mutants.env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1");
        // Each copy builds in a folder of its own; in a shared one, tests of one mutant could run on another's build.
        mutants.env_remove("CARGO_TARGET_DIR");
        mutants.args(["--jobs", "2", "--colors", "never"]);
        mutants.args(["--minimum-test-timeout", "60"]);
        mutants.args(["--", "--lib", "--tests", "--", "--skip", NOT_FOR_EACH]);
        run(
            &mut mutants,
            "mend the tests for each that was missed, or say why it does not matter",
        )?;
    }
    Ok(())
}
