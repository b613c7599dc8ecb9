//! Tests of the lab page: the module compared with the command in node, and the page in Chromium and Firefox.

use std::path::Path;

use super::{PAGE, build};
use crate::debian;
use crate::disk::entries;
use crate::failure::{Failure, Outcome};
use crate::run::{command, run, target_folder};

/// Browsers and their Debian packages.
const BROWSERS: [(&str, &str); 2] = [("chromium", "chromium"), ("firefox-esr", "firefox-esr")];

/// Builds the page, and runs the tests in `tests/` with the command that `cargo test` has built. If a browser is not available, its
/// tests are skipped with a message, unless they are `required`.
///
/// # Errors
/// The page cannot be built, a test fails, or a required browser is not available.
pub(crate) fn test(required: bool) -> Outcome {
    build()?;
    let tests = entries(&Path::new(PAGE).join("tests"), |name| {
        name.ends_with(".test.mjs")
    })?;
    let with_browsers = match browsers() {
        Ok(()) => true,
        Err(why) if required => return Err(why),
        Err(why) => {
            eprintln!("\nNOT TESTED in browsers: {why}\n");
            false
        }
    };
    let names = tests
        .iter()
        .filter_map(|path| path.file_name()?.to_str())
        .filter(|name| with_browsers || *name == "agreement.test.mjs")
        .map(|name| format!("tests/{name}"));
    run(
        command("node")
            // One file at a time: each starts its own browsers, and some measure times.
            .args(["--test", "--test-concurrency=1", "--test-reporter=spec"])
            .args(names)
            .env("LAB_TARGET", target_folder()?)
            .current_dir(PAGE),
        "fix what the tests report above; pictures are in target/lab/screenshots",
    )
}

/// Prints the response times of the page while a gait is dragged.
///
/// # Errors
/// The page cannot be built or opened.
pub(crate) fn bench() -> Outcome {
    build()?;
    browsers()?;
    run(
        command("node")
            .arg("tests/figures.mjs")
            .env("LAB_TARGET", target_folder()?)
            .current_dir(PAGE),
        "run it by hand to see why",
    )
}

fn browsers() -> Outcome {
    for (program, package) in BROWSERS {
        debian::ensure_tool(command(program).arg("--version"), &[package]).map_err(|why| {
            Failure::new(
                "looking for the browsers of the page's tests",
                why,
                "install both, and repeat the command",
            )
        })?;
    }
    Ok(())
}
