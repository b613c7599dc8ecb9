//! The RP2040 emulator of `emulator/board`: a package of npm at a pinned version, installed beside its scripts.

use std::path::Path;

use crate::debian;
use crate::failure::Outcome;
use crate::run::{command, run};

const BOARD: &str = "emulator/board";

/// Installs what `package-lock.json` names, where it is not there yet.
///
/// # Errors
/// Node or npm cannot be had, or the package cannot be fetched.
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
