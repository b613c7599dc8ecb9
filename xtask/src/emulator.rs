//! Installation of the RP2040 emulator: an npm package at a pinned version, next to the scripts in `emulator/board`.

use std::path::Path;

use crate::debian;
use crate::failure::Outcome;
use crate::run::{command, run};

const BOARD: &str = "emulator/board";

/// Installs the packages of `package-lock.json` if they are missing.
///
/// # Errors
/// Node or npm is not available, or a package cannot be fetched.
pub(crate) fn install() -> Outcome {
    debian::ensure_tool(command("node").arg("--version"), &["nodejs"])?;
    if Path::new(BOARD).join("node_modules/rp2040js").exists() {
        println!("rp2040js is there");
        return Ok(());
    }
    debian::ensure_tool(command("npm").arg("--version"), &["npm"])?;
    run(
        command("npm")
            .args(["ci", "--no-audit", "--no-fund"])
            .current_dir(BOARD),
        "check the network and npm's registry, and repeat the command",
    )
}
