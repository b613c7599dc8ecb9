//! `cargo xtask book`: builds the book as HTML for offline reading and checks its links.

use std::path::Path;

use crate::debian;
use crate::failure::Outcome;
use crate::run::{cargo, command, run, target_folder};

/// Folder of the book's builder, in which npm installs `KaTeX` for the formulas.
const BUILDER: &str = "xtask/book";

/// Lints and tests the builder.
///
/// # Errors
/// Clippy or a test reports a fault.
pub(crate) fn test() -> Outcome {
    run(
        cargo(["clippy", "-p", "book", "--all-targets"]).args(["--", "-D", "warnings"]),
        "fix what clippy reports above",
    )?;
    run(
        &mut cargo(["test", "-p", "book"]),
        "fix what the tests report above",
    )
}

/// Installs `KaTeX` if it is missing, and builds the book.
///
/// # Errors
/// Node or npm is not available, a page cannot be built, or a link is broken.
pub(crate) fn build() -> Outcome {
    debian::ensure_tool(command("node").arg("--version"), &["nodejs"])?;
    if !Path::new(BUILDER).join("node_modules/katex").exists() {
        debian::ensure_tool(command("npm").arg("--version"), &["npm"])?;
        run(
            command("npm")
                .args(["ci", "--no-audit", "--no-fund"])
                .current_dir(BUILDER),
            "check the network and npm's registry, and repeat the command",
        )?;
    }
    run(
        cargo(["run", "--quiet", "-p", "book", "--"]).arg(target_folder()?.join("book")),
        "fix the pages or links named above",
    )
}
