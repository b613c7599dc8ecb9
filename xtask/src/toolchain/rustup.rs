//! The ordinary way to a target, for whoever has rustup and a network that reaches its server.

use std::time::Duration;

use super::Target;
use crate::failure::{Failure, Outcome};
use crate::run::{command, run_for, works};

/// A server that cannot be reached must not hold anybody up: there is another way.
const PATIENCE: Duration = Duration::from_mins(2);

/// `rustup target add` for the chip, `rustup component add rust-src` for the page; for the active toolchain.
///
/// # Errors
/// There is no rustup, or it cannot fetch the target.
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
