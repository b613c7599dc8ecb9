//! `cargo xtask deny`: licences, sources, known holes and doubled versions of everything we depend on.

use crate::failure::Outcome;
use crate::run::run;
use crate::tools::DENY;

/// Holds Cargo.lock against deny.toml.
///
/// # Errors
/// Something is not allowed, or cargo-deny is not there.
pub(crate) fn check(install: bool) -> Outcome {
    run(
        // What is only a remark would bury what is not.
        DENY.cargo(install)?
            .args(["--log-level", "error", "check", "--hide-inclusion-graph"]),
        "take another crate or version, or say in deny.toml why this one may stay",
    )
}
