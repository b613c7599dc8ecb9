//! `cargo xtask deny`: checks licences, sources, duplicate versions and known vulnerabilities of all dependencies.

use crate::failure::Outcome;
use crate::run::run;
use crate::tools::DENY;

/// Main workspace and workspace of the fuzz targets.
const WORKSPACES: [&str; 2] = ["Cargo.toml", "fuzz/Cargo.toml"];

/// Checks both Cargo.lock files against deny.toml.
///
/// # Errors
/// A dependency violates deny.toml, or cargo-deny is missing.
pub(crate) fn check(install: bool) -> Outcome {
    // Vulnerabilities last: only they need the network, and the other results are printed without it.
    for checks in [&["licenses", "bans", "sources"][..], &["advisories"]] {
        for workspace in WORKSPACES {
            run(
                // Remarks would hide errors.
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
