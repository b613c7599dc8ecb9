//! `cargo xtask release --dry-run`: writes the content of a release to one folder, with checksums and notes. Parts that cannot be
//! made yet are named in a message.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::debian;
use crate::disk::{copy, entries, make_folder, read_bytes, remove_folder, write};
use crate::failure::{Failure, Outcome};
use crate::firmware::{self, Board, Variant};
use crate::lab;
use crate::run::{cargo, command, read, run, target_folder};
use crate::toolchain::{Target, Toolchain};

const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Files in the archive of the command, in addition to the program and its manual.
const PAPERS: [&str; 5] = [
    "README.md",
    "CHANGELOG.md",
    "CITATION.cff",
    "LICENSE-MIT",
    "LICENSE-APACHE",
];
/// Fixed time in archives, so that equal sources give equal bytes.
const EPOCH: &str = "--mtime=@0";

/// Makes everything under `target/release-dry-run`.
///
/// # Errors
/// `dry_run` is `false`, or a part cannot be made.
pub(crate) fn prepare(dry_run: bool) -> Outcome {
    if !dry_run {
        return Err(Failure::new(
            "releasing",
            "there is no place to release to yet",
            "see what a release would hold: `cargo xtask release --dry-run`",
        ));
    }
    let target = target_folder()?;
    let folder = target.join("release-dry-run");
    remove_folder(&folder)?;
    make_folder(&folder)?;
    let mut missing = Vec::new();
    command_archive(&target, &folder)?;
    images(&target, &folder)?;
    wheel(&folder, &mut missing)?;
    lab_page(&folder)?;
    let changelog = String::from_utf8_lossy(&read_bytes(Path::new("CHANGELOG.md"))?).into_owned();
    write(&folder.join("NOTES.md"), notes(&changelog)?)?;
    let sums = checksums(&folder)?;
    write(&folder.join("SHA256SUMS"), &sums)?;
    print!("\n{}:\n{sums}", folder.display());
    for part in &missing {
        println!("MISSING: {part}");
    }
    Ok(())
}

/// Archive of the command for this platform, with its manual pages and completions.
fn command_archive(target: &Path, folder: &Path) -> Outcome {
    let next = "fix what the compiler reports above";
    run(&mut cargo(["build", "--release", "-p", "swimmer"]), next)?;
    let rustc = read(command("rustc").arg("-vV"), "check `rustc -vV`")?;
    let host = host(&rustc)?;
    let name = format!("swimmer-{VERSION}-{host}");
    let stage = folder.join(&name);
    let program = format!("swimmer{}", std::env::consts::EXE_SUFFIX);
    make_folder(&stage)?;
    let built = target.join("release").join(&program);
    copy(&built, &stage.join(&program))?;
    for paper in PAPERS {
        copy(Path::new(paper), &stage.join(paper))?;
    }
    let next = "run it by hand to see why";
    read(
        command(&built).args(["man", "-o"]).arg(stage.join("man")),
        next,
    )?;
    for shell in ["bash", "zsh", "fish"] {
        let text = read(command(&built).args(["completions", shell]), next)?;
        write(&stage.join("completions").join(shell), text)?;
    }
    let archive = folder.join(format!("{name}.tar.gz"));
    run(
        command("tar")
            .args([
                "--sort=name",
                "--owner=0",
                "--group=0",
                "--numeric-owner",
                EPOCH,
                "-C",
            ])
            .arg(folder)
            .args(["--use-compress-program=gzip -n", "-cf"])
            .arg(&archive)
            .arg(&name),
        "install GNU tar",
    )?;
    remove_folder(&stage)
}

/// Platform in the output of `rustc -vV`.
fn host(version: &str) -> Outcome<&str> {
    let line = version.lines().find_map(|line| line.strip_prefix("host: "));
    line.ok_or_else(|| Failure::new("reading `rustc -vV`", "it names no host", "run it by hand"))
}

/// UF2 files of both boards.
fn images(target: &Path, folder: &Path) -> Outcome {
    let toolchain = Toolchain::find_or_make(Target::Chip)?;
    for board in Board::ALL {
        firmware::build(&toolchain, Variant::plain(board))?;
    }
    for board in ["nano-connect", "pico"] {
        let from = target
            .join("firmware-images")
            .join(format!("swimmer-{board}.uf2"));
        copy(
            &from,
            &folder.join(format!("swimmer-{VERSION}-{board}.uf2")),
        )?;
    }
    Ok(())
}

/// Python wheel, built by pip.
fn wheel(folder: &Path, missing: &mut Vec<&'static str>) -> Outcome {
    if !Path::new("pyproject.toml").is_file() {
        missing.push("the Python wheel: there is no pyproject.toml");
        return Ok(());
    }
    debian::ensure_tool(
        command("python3").args(["-m", "pip", "--version"]),
        &["python3-pip", "python3-venv"],
    )?;
    run(
        command("python3")
            .args(["-m", "pip", "wheel", "--no-deps", "--quiet", "-w"])
            .arg(folder)
            .arg("."),
        "fix what pip or maturin reports above",
    )
}

/// Lab page.
fn lab_page(folder: &Path) -> Outcome {
    let page = lab::build()?;
    copy(&page, &folder.join(format!("swimmer-lab-{VERSION}.html")))
}

/// Section `[Unreleased]` of the changelog.
fn notes(changelog: &str) -> Outcome<String> {
    let start = changelog.find("## [Unreleased]");
    let section = start
        .and_then(|start| changelog.get(start..))
        .unwrap_or_default();
    let body: Vec<&str> = section
        .lines()
        .skip(1)
        .take_while(|line| !line.starts_with("## ["))
        .collect();
    let body = body.join("\n");
    if body.trim().is_empty() {
        return Err(Failure::new(
            "reading CHANGELOG.md",
            "nothing stands under `## [Unreleased]`",
            "write there what users will notice",
        ));
    }
    Ok(format!("# swimmer {VERSION}\n\n{}\n", body.trim()))
}

/// One line per file in the format of `sha256sum`.
fn checksums(folder: &Path) -> Outcome<String> {
    let mut sums = String::new();
    let files: Vec<PathBuf> = entries(folder, |_| true)?;
    for file in files.iter().filter(|file| file.is_file()) {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        for byte in Sha256::digest(read_bytes(file)?) {
            // Writing to a string cannot fail.
            let _ = write!(sums, "{byte:02x}");
        }
        let _ = writeln!(sums, "  {name}");
    }
    Ok(sums)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_are_what_is_not_released_yet() {
        let log = "# Changelog\n\n## [Unreleased]\n\n### Added\n\n- one\n\n## [0.0.1]\n\n- old\n";
        let notes = notes(log).unwrap();
        assert!(
            notes.starts_with("# swimmer ") && notes.ends_with("### Added\n\n- one\n"),
            "{notes}"
        );
        for empty in ["", "## [Unreleased]\n\n## [0.0.1]\n- old\n"] {
            assert!(super::notes(empty).is_err());
        }
    }

    #[test]
    fn checksums_are_those_of_sha256sum() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("b"), "abc").unwrap();
        std::fs::write(folder.path().join("a"), "").unwrap();
        let expected = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855  a\n\
                        ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad  b\n";
        assert_eq!(checksums(folder.path()).unwrap(), expected);
    }

    #[test]
    fn the_host_is_named() {
        assert_eq!(host("rustc 1\nhost: x86_64-a-b\n").unwrap(), "x86_64-a-b");
        assert!(host("").is_err());
    }
}
