//! `cargo xtask fuzz`: runs every fuzz target for a minute, from the seeds in the repository and the corpus of earlier runs.

use std::path::{Path, PathBuf};

use crate::debian;
use crate::failure::{Failure, Outcome};
use crate::run::{command, read, run, target_folder};
use crate::tools::FUZZ;

/// Small files of the tests of the tracking readers.
const TRACKS: &str = "calibrate/tests/formats";

/// Runs one target, or all, for `seconds` each.
///
/// # Errors
/// A target found a failing case, whose file is named, or cargo-fuzz is not available.
pub(crate) fn run_targets(only: Option<&str>, seconds: u32) -> Outcome {
    debian::ensure_tool(command("c++").arg("--version"), &["g++"])?;
    let fuzz = || -> Outcome<_> {
        let mut fuzz = FUZZ.cargo(true)?;
        // Sanitizers need unstable flags; this variable makes the stable compiler accept them.
        fuzz.env("RUSTC_BOOTSTRAP", "1");
        Ok(fuzz)
    };
    let targets = read(fuzz()?.arg("list"), "see fuzz/Cargo.toml")?;
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
        let corpus = corpus(target)?;
        let time = format!("-max_total_time={seconds}");
        let mut target_run = fuzz()?;
        // No sanitizer: the workspace has no unsafe code on a host, and the targets run several times faster without one.
        target_run
            .args(["run", "--sanitizer", "none", target])
            .arg(&corpus);
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
            "run the named file alone with `cargo fuzz run TARGET FILE`, fix the fault, and keep the file as a test",
        )?;
    }
    Ok(())
}

/// Corpus folder of a target: outside the repository, with copies of the repository's seeds.
fn corpus(target: &str) -> Outcome<PathBuf> {
    let corpus = target_folder()?.join("fuzz-corpus").join(target);
    let copy = || -> std::io::Result<()> {
        std::fs::create_dir_all(&corpus)?;
        for seed in seeds(Path::new("."), target)? {
            if let Some(name) = seed.file_name() {
                std::fs::copy(&seed, corpus.join(name))?;
            }
        }
        Ok(())
    };
    copy().map_err(|why| {
        Failure::new(
            format!("filling {} with seeds", corpus.display()),
            why,
            "check the folder",
        )
    })?;
    Ok(corpus)
}

/// Initial corpus of a target: its seeds, or the files of the readers' tests in its format.
fn seeds(root: &Path, target: &str) -> std::io::Result<Vec<PathBuf>> {
    let begins: &[&str] = match target {
        "tracks" => &[""],
        "tracks_wide" => &["motive-1.2", "motive-excel"],
        "tracks_records" => &["motive-1.1.", "trackingtools"],
        "tracks_headerless" => &["motive-without-header"],
        "tracks_trc" => &["tank.trc", "cortex.trc"],
        _ => &[target.strip_prefix("tracks_").unwrap_or_default()],
    };
    let folder = if target.starts_with("tracks") {
        root.join(TRACKS)
    } else {
        root.join("fuzz/seeds").join(target)
    };
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let files = std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path()));
    let files: Vec<PathBuf> = files.collect::<std::io::Result<_>>()?;
    let wanted = |file: &PathBuf| {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        begins.iter().any(|begin| name.starts_with(begin))
    };
    Ok(files.into_iter().filter(wanted).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reader_starts_from_files_of_its_format() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let targets = std::fs::read_dir(root.join("fuzz/fuzz_targets")).unwrap();
        let mut sown = 0;
        for target in targets {
            let target = target.unwrap().path();
            let target = target.file_stem().unwrap().to_str().unwrap();
            if target.starts_with("tracks") {
                let seeds = seeds(&root, target).unwrap();
                assert!(!seeds.is_empty(), "{target}");
                sown += usize::from(target != "tracks") * seeds.len();
            }
        }
        let files = std::fs::read_dir(root.join(TRACKS)).unwrap().count();
        assert_eq!(sown, files, "each file belongs to one format");
    }
}
