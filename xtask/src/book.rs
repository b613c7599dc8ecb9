//! `cargo xtask book`: the book as HTML, offline, with every link in it followed.

use std::path::Path;

use crate::debian;
use crate::failure::Outcome;
use crate::run::{cargo, command, run, target_folder};

/// Where the book's builder lies; npm puts what sets formulas beside it.
const BUILDER: &str = "xtask/book";

/// Installs `KaTeX` where it is not there yet, and builds the book.
///
/// # Errors
/// Node or npm cannot be had, a page cannot be built, or a link leads nowhere.
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
        "mend the pages or links that are named above",
    )
}
