//! `cargo xtask fuzz`: every fuzz target for a minute, from the seeds in the repository and whatever earlier runs found.

use std::path::{Path, PathBuf};

use crate::debian;
use crate::failure::{Failure, Outcome};
use crate::run::{command, read, run, target_folder};

/// What runs the targets, at the version these were tried with.
const CARGO_FUZZ: (&str, &str) = ("cargo-fuzz", "0.13.2");

/// Runs one target, or all, for `seconds` each.
///
/// # Errors
/// A target found a case that breaks its promise (its file is named, to be run again alone), or cargo-fuzz cannot be had.
pub(crate) fn run_targets(only: Option<&str>, seconds: u32) -> Outcome {
    let tools = target_folder()?.join("tools");
    let path = install(&tools)?;
    let fuzz = || {
        let mut fuzz = command("cargo");
        // Sanitizers ask for unstable flags; the stable compiler takes them with this.
        fuzz.arg("fuzz")
            .env("RUSTC_BOOTSTRAP", "1")
            .env("PATH", &path);
        fuzz
    };
    let targets = read(fuzz().arg("list"), "see fuzz/Cargo.toml")?;
    let targets: Vec<&str> = targets
        .lines()
        .filter(|target| only.is_none_or(|only| only == *target))
        .collect();
    if targets.is_empty() {
        let asked = only.unwrap_or("any");
        return Err(Failure::new(
            format!("looking for the fuzz target `{asked}`"),
            "there is none",
            "`cargo fuzz list` names them",
        ));
    }
    for target in targets {
        let grown = target_folder()?.join("fuzz-corpus").join(target);
        std::fs::create_dir_all(&grown).map_err(|why| {
            Failure::new(
                format!("making {}", grown.display()),
                why,
                "check the folder",
            )
        })?;
        let seeds = seeds(target);
        let time = format!("-max_total_time={seconds}");
        // New inputs go into the first folder; the seeds of the repository are only read.
        let mut target_run = fuzz();
        // No sanitizer: the workspace has no unsafe code on a host, and without one the targets run several times faster.
        target_run
            .args(["run", "--sanitizer", "none", target])
            .arg(&grown);
        if seeds.exists() {
            target_run.arg(&seeds);
        }
        target_run.args([
            "--",
            &time,
            "-max_len=65536",
            "-timeout=25",
            "-print_final_stats=1",
            "-verbosity=0",
        ]);
        run(
            &mut target_run,
            "run the named file alone with `cargo fuzz run TARGET FILE`, mend, and keep it as a test",
        )?;
    }
    Ok(())
}

/// Where a target starts: its own seeds, or the small files that the readers' tests use.
fn seeds(target: &str) -> PathBuf {
    match target {
        "tracks" => PathBuf::from("calibrate/tests/formats"),
        _ => Path::new("fuzz/seeds").join(target),
    }
}

/// cargo-fuzz in `tools`, where it is not there yet; a search path that finds it.
fn install(tools: &Path) -> Outcome<std::ffi::OsString> {
    debian::ensure_tool(command("c++").arg("--version"), &["g++"])?;
    let (name, version) = CARGO_FUZZ;
    if !tools.join("bin").join(name).exists() {
        run(
            command("cargo")
                .args(["install", "--locked", name, "--version", version, "--root"])
                .arg(tools),
            "check the network, and repeat the command",
        )?;
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::iter::once(tools.join("bin")).chain(std::env::split_paths(&path));
    std::env::join_paths(folders.collect::<Vec<PathBuf>>())
        .map_err(|why| Failure::new("naming the folder of cargo-fuzz", why, "mend PATH"))
}
