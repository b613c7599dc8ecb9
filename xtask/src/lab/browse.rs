//! The page's tests: the module against the command under node, the page in Chromium and in Firefox.

use std::path::Path;

use super::{PAGE, build};
use crate::debian;
use crate::disk::entries;
use crate::failure::{Failure, Outcome};
use crate::run::{cargo, command, run, target_folder};

/// Programs of the browsers, and their Debian packages.
const BROWSERS: [(&str, &str); 2] = [("chromium", "chromium"), ("firefox-esr", "firefox-esr")];

/// Builds the page and the command, and runs what `tests/` holds. Where a browser cannot be had, its tests are left out loudly,
/// unless they are required.
///
/// # Errors
/// The page cannot be built, a test fails, or a browser that is required cannot be had.
pub(crate) fn test(required: bool) -> Outcome {
    build()?;
    let next = "mend what the compiler names above";
    run(&mut cargo(["build", "--quiet", "-p", "swimmer"]), next)?;
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
            // One file at a time: each has browsers of its own, and they measure times.
            .args(["--test", "--test-concurrency=1", "--test-reporter=spec"])
            .args(names)
            .env("LAB_TARGET", target_folder()?)
            .current_dir(PAGE),
        "mend what the tests name above; pictures lie in target/lab/screenshots",
    )
}

/// Prints how long the page takes for what follows a hand.
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
