//! `cargo xtask deny`: licences, sources, doubled versions and known holes of everything we depend on.

use crate::failure::Outcome;
use crate::run::run;
use crate::tools::DENY;

/// The house, and the fuzz targets' workspace beside it.
const WORKSPACES: [&str; 2] = ["Cargo.toml", "fuzz/Cargo.toml"];

/// Holds both Cargo.lock against deny.toml.
///
/// # Errors
/// Something is not allowed, or cargo-deny is not there.
pub(crate) fn check(install: bool) -> Outcome {
    // Known holes last: they alone need the network, and the rest is told without.
    for checks in [&["licenses", "bans", "sources"][..], &["advisories"]] {
        for workspace in WORKSPACES {
            run(
                // What is only a remark would bury what is not.
                DENY.cargo(install)?
                    .args(["--log-level", "error", "--config", "deny.toml"])
                    .args(["--manifest-path", workspace])
                    .args(["check", "--hide-inclusion-graph"])
                    .args(checks),
                "take another crate or version, or say in deny.toml why this one may stay; where RustSec's database cannot be \
                 fetched, all before it is checked all the same",
            )?;
        }
    }
    Ok(())
}
