//! `cargo xtask release`: builds an archive for users without Rust or Node, and tries it as such a user would.
//!
//! The archive holds the command with the lab page inside, its manual and completions, the wheel, the firmware of both boards, the book,
//! a bill of materials, notes and checksums.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use sha2::{Digest, Sha256};

use crate::book;
use crate::debian;
use crate::disk::{
    copy, copy_folder, files_below, make_folder, read_bytes, remove_file, remove_folder, write,
};
use crate::failure::{Failure, Outcome};
use crate::firmware::{self, Board, Variant};
use crate::lab;
use crate::python;
use crate::run::{cargo, command, read, run, target_folder};
use crate::toolchain::{Target, Toolchain};
use crate::tools::CYCLONEDX;

const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Files of the checkout that a release repeats.
const PAPERS: [&str; 5] = [
    "README.md",
    "CHANGELOG.md",
    "CITATION.cff",
    "LICENSE-MIT",
    "LICENSE-APACHE",
];
/// Feature of the command and of the wheel that compiles the lab page into them.
const PAGE_INSIDE: [&str; 2] = ["--features", "embedded-page"];
/// Variable with the path of the page that is compiled in.
const PAGE: &str = "SWIMMER_LAB_PAGE";
/// Time of all files in archives, so that equal sources give equal bytes: 1980, the earliest that a wheel can hold.
const EPOCH: &str = "315532800";

/// Builds everything under `target/release-VERSION`, packs it, and tries the archive.
///
/// # Errors
/// A part cannot be built, or does not work alone.
pub(crate) fn build() -> Outcome {
    let target = target_folder()?;
    let folder = target.join(format!("release-{VERSION}"));
    remove_folder(&folder)?;
    let rustc = read(command("rustc").arg("-vV"), "check `rustc -vV`")?;
    let name = format!("swimmer-{VERSION}-{}", host(&rustc)?);
    let stage = folder.join(&name);
    make_folder(&stage)?;
    let page = lab::build()?;
    command_with_page(&target, &stage, &page)?;
    images(&target, &stage.join("firmware"))?;
    wheel(&stage, &page)?;
    book::build()?;
    copy_folder(&target.join("book"), &stage.join("book"))?;
    bill_of_materials(&stage)?;
    for paper in PAPERS {
        copy(Path::new(paper), &stage.join(paper))?;
    }
    let changelog = String::from_utf8_lossy(&read_bytes(Path::new("CHANGELOG.md"))?).into_owned();
    write(&stage.join("NOTES.md"), notes(&changelog)?)?;
    write(&stage.join("SHA256SUMS"), checksums(&stage)?)?;
    let archive = pack(&folder, &name)?;
    remove_folder(&stage)?;
    let sum = checksums(&folder)?;
    write(&folder.join("SHA256SUMS"), &sum)?;
    try_out(&archive, &folder.join("trial"), &name)?;
    remove_folder(&folder.join("trial"))?;
    print!("\n{}:\n{sum}", folder.display());
    Ok(())
}

/// The command, its manual pages and completions.
fn command_with_page(target: &Path, stage: &Path, page: &Path) -> Outcome {
    run(
        cargo(["build", "--release", "-p", "swimmer"])
            .args(PAGE_INSIDE)
            .env(PAGE, page),
        "fix what the compiler reports above",
    )?;
    let program = format!("swimmer{}", std::env::consts::EXE_SUFFIX);
    let built = target.join("release").join(&program);
    copy(&built, &stage.join(&program))?;
    let next = "run it by hand to see why";
    read(
        command(&built).args(["man", "-o"]).arg(stage.join("man")),
        next,
    )?;
    for shell in ["bash", "zsh", "fish"] {
        let text = read(command(&built).args(["completions", shell]), next)?;
        write(&stage.join("completions").join(shell), text)?;
    }
    Ok(())
}

/// Platform in the output of `rustc -vV`.
fn host(version: &str) -> Outcome<&str> {
    let line = version.lines().find_map(|line| line.strip_prefix("host: "));
    line.ok_or_else(|| Failure::new("reading `rustc -vV`", "it names no host", "run it by hand"))
}

/// UF2 files of both boards.
fn images(target: &Path, folder: &Path) -> Outcome {
    let toolchain = Toolchain::find_or_make(Target::Chip)?;
    make_folder(folder)?;
    for board in Board::ALL {
        let variant = Variant::plain(board);
        firmware::build(&toolchain, variant)?;
        let image = format!("swimmer-{}.uf2", variant.name());
        let from = target.join("firmware-images").join(&image);
        copy(&from, &folder.join(&image))?;
    }
    Ok(())
}

/// Python wheel, built by pip.
fn wheel(stage: &Path, page: &Path) -> Outcome {
    debian::ensure_tool(
        command("python3").args(["-m", "pip", "--version"]),
        &["python3-pip", "python3-venv"],
    )?;
    run(
        command("python3")
            .args(["-m", "pip", "wheel", "--no-deps", "--quiet", "-w"])
            .arg(stage)
            .arg(".")
            .env("MATURIN_PEP517_ARGS", PAGE_INSIDE.join(" "))
            .env("SOURCE_DATE_EPOCH", EPOCH)
            .env(PAGE, page),
        "fix what pip or maturin reports above",
    )
}

/// Crates in the command, with versions and licences (`CycloneDX`). The tool writes next to each Cargo.toml of the workspace.
fn bill_of_materials(stage: &Path) -> Outcome {
    const NAME: &str = "swimmer-sbom";
    run(
        CYCLONEDX
            .cargo(true)?
            .args(["--manifest-path", "cli/Cargo.toml", "--format", "json"])
            .args(["--override-filename", NAME])
            .env("SOURCE_DATE_EPOCH", EPOCH),
        "run it by hand to see why",
    )?;
    let file = format!("{NAME}.json");
    let written = read_bytes(&Path::new("cli").join(&file))?;
    // Equal for every checkout.
    let checkout = std::env::current_dir()
        .map_err(|why| Failure::new("finding the checkout", why, "repeat the command"))?;
    let text = String::from_utf8_lossy(&written).replace(&*checkout.to_string_lossy(), "/swimmer");
    write(&stage.join(&file), text)?;
    let manifests = read(
        command("git").args(["ls-files", "*Cargo.toml"]),
        "build a release from a git checkout",
    )?;
    for manifest in manifests.lines() {
        remove_file(&Path::new(manifest).with_file_name(&file))?;
    }
    Ok(())
}

/// Packs the folder `name`, in a fixed order and with a fixed time.
fn pack(folder: &Path, name: &str) -> Outcome<PathBuf> {
    let archive = folder.join(format!("{name}.tar.gz"));
    run(
        command("tar")
            .args([
                "--sort=name",
                "--owner=0",
                "--group=0",
                "--numeric-owner",
                "--mode=u=rwX,go=rX",
            ])
            .arg(format!("--mtime=@{EPOCH}"))
            .arg("-C")
            .arg(folder)
            .args(["--use-compress-program=gzip -n", "-cf"])
            .arg(&archive)
            .arg(name),
        "install GNU tar",
    )?;
    Ok(archive)
}

/// Unpacks the archive and uses it without the checkout: demo, lab page, wheel.
fn try_out(archive: &Path, folder: &Path, name: &str) -> Outcome {
    python::ensure()?;
    make_folder(folder)?;
    let begun = Instant::now();
    let next = "repeat the steps above by hand, in an empty folder";
    // Nothing of the developer's environment but the system's programs and pip's configuration.
    let alone = |program: &Path| {
        let mut alone = command(program);
        alone
            .current_dir(folder)
            .env_remove("SWIMMER_LAB_PAGE")
            .env("PATH", "/usr/local/bin:/usr/bin:/bin");
        alone
    };
    let tar = Path::new("tar");
    run(alone(tar).arg("-xzf").arg(archive), next)?;
    let unpacked = folder.join(name);
    run(
        command("sha256sum")
            .args(["--check", "--quiet", "SHA256SUMS"])
            .current_dir(&unpacked),
        next,
    )?;
    let swimmer = unpacked.join(format!("swimmer{}", std::env::consts::EXE_SUFFIX));
    run(alone(&swimmer).args(["demo", "-o", "demo"]), next)?;
    run(alone(&swimmer).args(["lab", "--export", "page.html"]), next)?;
    for file in ["demo/report.html", "demo/lab.html", "page.html"] {
        read_bytes(&folder.join(file))?;
    }
    let python = folder.join("python/bin/python");
    run(
        alone(Path::new("python3")).args(["-m", "venv", "python"]),
        next,
    )?;
    let wheel = files_below(&unpacked)?
        .into_iter()
        .find(|path| path.extension().is_some_and(|ending| ending == "whl"))
        .ok_or_else(|| Failure::new("trying the release", "it holds no wheel", next))?;
    run(
        alone(&python)
            .args(["-m", "pip", "install", "--quiet"])
            .arg(wheel),
        next,
    )?;
    run(
        alone(&python).args([
            "-c",
            "import swimmer as sw; print(sw.__version__, sw.optimize.displacement(sw.Swimmer.preset('purcell')).displacement_over_length)",
        ]),
        next,
    )?;
    run(
        alone(&python).args(["-m", "swimmer", "lab", "--export", "wheel.html"]),
        next,
    )?;
    println!(
        "demo, lab page and wheel from the archive alone: {:.0} s",
        begun.elapsed().as_secs_f64()
    );
    Ok(())
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

/// One line per file below the folder, in the format of `sha256sum`.
fn checksums(folder: &Path) -> Outcome<String> {
    let mut sums = String::new();
    for file in files_below(folder)? {
        for byte in Sha256::digest(read_bytes(&file)?) {
            // Writing to a string cannot fail.
            let _ = write!(sums, "{byte:02x}");
        }
        let name = file.strip_prefix(folder).unwrap_or(&file);
        let _ = writeln!(sums, "  {}", name.display());
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
