//! Installation of a target by rustup, which needs a network.

use std::time::Duration;

use super::Target;
use crate::failure::{Failure, Outcome};
use crate::run::{command, run_for, works};

/// Time limit, since a server may be unreachable and there is an alternative.
const PATIENCE: Duration = Duration::from_mins(2);

/// `rustup target add` for the chip, `rustup component add rust-src` for the page; for the active toolchain.
///
/// # Errors
/// rustup is missing or cannot fetch the target.
pub(super) fn add(target: Target) -> Outcome {
    if !works(command("rustup").arg("--version")) {
        return Err(Failure::new(
            "looking for `rustup`",
            "it is not there",
            "install Rust from https://rustup.rs, or go on without",
        ));
    }
    let what = match target {
        Target::Chip => ["target", "add", target.triple()],
        Target::Page => ["component", "add", "rust-src"],
    };
    run_for(
        PATIENCE,
        command("rustup").args(what),
        "check the network, or go on without",
    )
}
