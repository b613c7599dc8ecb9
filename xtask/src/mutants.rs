//! `cargo xtask mutants`: mutation tests of the safety-relevant code (promise R14). Makes one small change at a time and lists the
//! changes that no test detects. Results: docs/carrying-on/mutants.md; `.cargo/mutants.toml` excludes changes without effect.

use crate::disk::make_folder;
use crate::failure::{Failure, Outcome};
use crate::run::{run, target_folder};
use crate::tools::MUTANTS;

/// Safety-relevant crates and their files.
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

/// Excluded test: it takes longer than all others together, and checks paths between states, not these files.
const NOT_FOR_EACH: &str = "brain::model_check";

/// Tests every mutant of one crate or of all; the lists are under target/mutants.
///
/// # Errors
/// A mutant survives, or cargo-mutants is missing.
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
        // Mutants are not debugged, and linking without debug information takes half the time.
        mutants.env("CARGO_PROFILE_DEV_DEBUG", "0");
        // Failing cases found for one mutant must not be stored for the next one. They would hide that a case was found by
        // chance, and a wrong property would seem to detect all later mutants.
        mutants.env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1");
        // Each copy has its own target folder; in a shared one, tests of one mutant could use the build of another.
        mutants.env_remove("CARGO_TARGET_DIR");
        mutants.args(["--jobs", "2", "--colors", "never"]);
        mutants.args(["--minimum-test-timeout", "60"]);
        mutants.args(["--", "--lib", "--tests", "--", "--skip", NOT_FOR_EACH]);
        run(
            &mut mutants,
            "extend the tests for each missed mutant, or document why it does not matter",
        )?;
    }
    Ok(())
}
