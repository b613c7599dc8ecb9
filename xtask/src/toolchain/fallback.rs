//! Compiler for a target on a Debian machine whose rustup cannot fetch it.
//!
//! Debian's security suite carries `rustc-web`, a current rustc with its sources. The packages are downloaded and
//! unpacked into a folder of our own under the user's cache (nothing is installed, nothing shadowed), then the standard
//! library is built once for the target: half a minute for the chip, a whole one for the page. The linker is the `rust-lld` of
//! the active toolchain.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use super::{HostCompiler, Target, has_core, library_folder};
use crate::debian;
use crate::disk::{copy, entries, failed, make_folder, remove_folder, write};
use crate::failure::{Failure, Outcome};
use crate::run::{cargo, command, read, run, target_folder, works};

/// Part of the folder's name; raise it if the recipe below changes, so that old prefixes are made again.
const RECIPE: u32 = 4;
/// Package whose version all others share.
const COMPILER: &str = "rustc-web";
/// Empty package, built to build the standard library.
const PROJECT: &str = "library-of-the-target";

/// Returns the private prefix, or `None` if it has not been made.
///
/// # Errors
/// The cache folder is unknown.
pub(super) fn find(target: Target) -> Outcome<Option<PathBuf>> {
    if !debian::is_debian() {
        return Ok(None);
    }
    let candidate = debian::candidate(COMPILER);
    let prefix = newest_made(&cache_folder()?, candidate.as_deref(), target);
    Ok(prefix.filter(|prefix| usable(prefix, target)))
}

/// Makes the private prefix, unless another process has just made it.
///
/// # Errors
/// The system is not Debian, has no package lists, or a download or the build of `core` fails.
pub(super) fn make(host: &HostCompiler, target: Target) -> Outcome<PathBuf> {
    let triple = target.triple();
    if !debian::is_debian() {
        return Err(Failure::new(
            format!("looking for a compiler for {triple}"),
            "the active Rust toolchain has no such target, and this is not Debian, where packages could stand in",
            format!("run `rustup target add {triple}`, then repeat the command"),
        ));
    }
    let folder = cache_folder()?;
    make_folder(&folder)?;
    let lock_path = folder.join("lock");
    let lock = File::create(&lock_path).map_err(|why| failed("making", &lock_path, why))?;
    lock.lock()
        .map_err(|why| failed("locking", &lock_path, why))?; // released when the file is closed
    debian::update()?; // a candidate of an old list may be gone from the mirror
    if let Some(prefix) = find(target)? {
        return Ok(prefix);
    }
    let version = debian::candidate(COMPILER).ok_or_else(|| {
        Failure::new(
            format!("looking for a compiler for {triple}"),
            format!("the active Rust toolchain has no such target, and the package lists know no {COMPILER}"),
            format!("run `rustup target add {triple}`; or, as root, `apt-get update` with Debian's security suite enabled"),
        )
    })?;
    let prefix = folder.join(prefix_name(&version, target));
    unpack_and_build(&folder, &prefix, &version, host, target)?;
    Ok(prefix)
}

/// Downloads, unpacks and builds next to the prefix, and moves the result there when it is complete.
fn unpack_and_build(
    folder: &Path,
    prefix: &Path,
    version: &str,
    host: &HostCompiler,
    target: Target,
) -> Outcome {
    let triple = target.triple();
    let unfinished = folder.join("unfinished");
    for stale in [&unfinished, prefix] {
        remove_folder(stale)?;
    }
    let packages = unfinished.join("packages");
    make_folder(&packages)?;
    eprintln!(
        "No {triple} in the active toolchain: unpacking Debian's {COMPILER} {version} under {}",
        folder.display()
    );
    download(&packages, version)?;
    unpack(&packages, &unfinished)?;
    build_library(&unfinished, host, target)?;
    write_wrappers(&unfinished, prefix, host)?;
    // Crates compiled against another copy of `core` cannot be linked with this one.
    remove_folder(&target_folder()?.join(triple))?;
    fs::rename(&unfinished, prefix).map_err(|why| failed("moving into place", prefix, why))?;
    if usable(prefix, target) {
        Ok(())
    } else {
        Err(Failure::new(
            format!("trying the compiler in {}", prefix.display()),
            "it, its clippy or its linker does not run",
            "run `bin/rustc -vV` there to see why, remove the folder, and repeat the command",
        ))
    }
}

fn download(packages: &Path, version: &str) -> Outcome {
    let next = "check the network, run `apt-get update` as root, and repeat the command";
    let library = format!("libstd-rust-web-{}", minor_version(version));
    let same_version = [
        COMPILER,
        &library,
        "libstd-rust-web-dev",
        "rust-web-src",
        "rust-web-clippy",
    ]
    .map(|name| format!("{name}={version}"));
    let mut fetch = command("apt-get");
    fetch
        .current_dir(packages)
        .args(["download", "-qq", "-o", "APT::Sandbox::User=root"]);
    run(fetch.args(&same_version), next)?;
    // Dependencies that the machine lacks: LLVM, and possibly the libraries that LLVM needs.
    let plan = read(
        command("apt-get")
            .args(["install", "--simulate", "--no-install-recommends"])
            .args([&same_version[1], &same_version[4]]),
        next,
    )?;
    let missing: Vec<&str> = planned(&plan)
        .filter(|name| !same_version.iter().any(|own| is_of(own, name)))
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    let mut fetch = command("apt-get");
    fetch
        .current_dir(packages)
        .args(["download", "-qq", "-o", "APT::Sandbox::User=root"]);
    run(fetch.args(missing), next)
}

/// Packages that a simulated `apt-get install` would install.
fn planned(plan: &str) -> impl Iterator<Item = &str> {
    plan.lines()
        .filter_map(|line| line.strip_prefix("Inst ")?.split_whitespace().next())
}

/// Returns `true` if `name=version` names the package.
fn is_of(asked: &str, package: &str) -> bool {
    asked
        .split_once('=')
        .is_some_and(|(name, _)| name == package)
}

fn unpack(packages: &Path, prefix: &Path) -> Outcome {
    for package in debs(packages)? {
        run(
            command("dpkg-deb").arg("-x").arg(&package).arg(prefix),
            "check the free space of the disk, and repeat the command",
        )?;
    }
    remove_folder(packages)
}

/// Builds the standard library from the unpacked sources, with the crates vendored among them.
fn build_library(prefix: &Path, host: &HostCompiler, target: Target) -> Outcome {
    let rust = prefix.join("usr/lib/rustlib/src/rust");
    let project = prefix.join(PROJECT);
    write(&project.join("src/lib.rs"), "#![no_std]\n")?;
    write(
        &project.join("Cargo.toml"),
        "[package]\nname = \"library-of-the-target\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n[workspace]\n\n\
         [profile.release]\npanic = \"abort\"\ncodegen-units = 1\n",
    )?;
    write(
        &project.join(".cargo/config.toml"),
        format!(
            "[source.crates-io]\nreplace-with = \"vendored\"\n\n[source.vendored]\ndirectory = '{}'\n",
            rust.join("library/vendor").display()
        ),
    )?;
    let mut build = cargo([
        "build",
        "--offline",
        "--release",
        "--target",
        target.triple(),
    ]);
    build
        .args(target.own_library())
        .current_dir(&project)
        .env("CARGO_TARGET_DIR", project.join("target"))
        .env("RUSTC", prefix.join("usr/bin/rustc"))
        .env("RUSTC_BOOTSTRAP", "1") // build-std is unstable; the result is an ordinary sysroot
        .env("LD_LIBRARY_PATH", library_path(prefix, host))
        // Removes paths of this machine from panic messages.
        .env(
            "RUSTFLAGS",
            format!(
                "-Cembed-bitcode=yes --remap-path-prefix={}=/rustc {}",
                rust.display(),
                target.flags()
            ),
        )
        .env_remove("RUSTC_WRAPPER")
        .env_remove("RUSTC_WORKSPACE_WRAPPER");
    run(
        &mut build,
        "remove the folder `unfinished` beside it, and repeat the command",
    )?;

    let libraries = library_folder(&prefix.join("usr"), target);
    make_folder(&libraries)?;
    let built = project
        .join("target")
        .join(target.triple())
        .join("release/deps");
    let of_the_project = format!("lib{}-", PROJECT.replace('-', "_"));
    let built = entries(&built, |file| {
        has_ending(file, "rlib") && !file.starts_with(&of_the_project)
    })?;
    for library in built {
        copy(
            &library,
            &libraries.join(library.file_name().unwrap_or_default()),
        )?;
    }
    for done_with in [
        project,
        prefix.join("usr/share"),
        prefix.join("usr/src"),
        rust,
    ] {
        remove_folder(&done_with)?;
    }
    Ok(())
}

/// Writes scripts with the names that cargo expects; the compiler must be called `rustc`.
fn write_wrappers(unfinished: &Path, prefix: &Path, host: &HostCompiler) -> Outcome {
    let libraries = library_path(prefix, host);
    for name in ["rustc", "clippy-driver"] {
        write_script(
            &unfinished.join("bin").join(name),
            &format!(
                "LD_LIBRARY_PATH=\"{}${{LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}}\" exec \"{}\" \"$@\"",
                libraries,
                prefix.join("usr/bin").join(name).display()
            ),
        )?;
    }
    let tools = Path::new("lib/rustlib")
        .join(&host.triple)
        .join("bin/rust-lld");
    write_script(
        &unfinished.join("usr").join(&tools),
        &format!("exec \"{}\" \"$@\"", host.sysroot.join(&tools).display()),
    )
}

fn write_script(path: &Path, body: &str) -> Outcome {
    write(path, format!("#!/bin/sh\n{body}\n"))?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        fs::set_permissions(path, fs::Permissions::from_mode(0o755))
            .map_err(|why| failed("making executable", path, why))?;
    }
    Ok(())
}

/// Returns `true` if compiler, clippy, library and linker exist and run.
fn usable(prefix: &Path, target: Target) -> bool {
    let rustlib = prefix.join("usr/lib/rustlib");
    let linker = entries(&rustlib, |name| name.contains("-linux-"))
        .unwrap_or_default()
        .into_iter()
        .map(|triple| triple.join("bin/rust-lld"))
        .find(|path| path.exists());
    has_core(&prefix.join("usr"), target)
        && works(command(prefix.join("bin/rustc")).arg("--version"))
        && works(command(prefix.join("bin/clippy-driver")).arg("--version"))
        && linker.is_some_and(|linker| works(command(linker).args(["-flavor", "gnu", "--version"])))
}

/// Prefix of the candidate version; without package lists, any prefix made by this recipe.
fn newest_made(folder: &Path, candidate: Option<&str>, target: Target) -> Option<PathBuf> {
    let fits = |name: &str| match candidate {
        Some(version) => name == prefix_name(version, target),
        None => name.ends_with(&prefix_name("", target)),
    };
    entries(folder, fits).ok()?.pop()
}

fn prefix_name(version: &str, target: Target) -> String {
    format!("{version}-{}-recipe-{RECIPE}", target.triple())
}

/// `1.96.0+dfsg1-1~deb12u2` → `1.96`, as Debian names its library package.
fn minor_version(version: &str) -> String {
    version.split('.').take(2).collect::<Vec<_>>().join(".")
}

/// Folders of the unpacked shared libraries for `LD_LIBRARY_PATH`; some packages still use the folder at the root.
fn library_path(prefix: &Path, host: &HostCompiler) -> String {
    let folder = multiarch(&host.triple);
    let root = prefix.display();
    format!("{root}/usr/lib/{folder}:{root}/lib/{folder}")
}

/// Debian's name of the triple's library folder.
fn multiarch(triple: &str) -> String {
    let processor = triple.split('-').next().unwrap_or(triple);
    format!("{processor}-linux-gnu")
}

fn cache_folder() -> Outcome<PathBuf> {
    let cache = std::env::var_os("XDG_CACHE_HOME")
        .filter(|path| !path.is_empty())
        .map(PathBuf::from)
        .or_else(|| std::env::home_dir().map(|home| home.join(".cache")))
        .ok_or_else(|| {
            Failure::new(
                "looking for the user's cache folder",
                "neither XDG_CACHE_HOME nor HOME is set",
                "set HOME",
            )
        })?;
    Ok(cache.join("swimmer-toolchains"))
}

fn debs(folder: &Path) -> Outcome<Vec<PathBuf>> {
    entries(folder, |name| has_ending(name, "deb"))
}

fn has_ending(name: &str, ending: &str) -> bool {
    Path::new(name)
        .extension()
        .is_some_and(|found| found == ending)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_follow_the_version() {
        assert_eq!(minor_version("1.96.0+dfsg1-1~deb12u2"), "1.96");
        assert_eq!(
            prefix_name("1.96.0", Target::Chip),
            "1.96.0-thumbv6m-none-eabi-recipe-4"
        );
        assert_eq!(multiarch("aarch64-unknown-linux-gnu"), "aarch64-linux-gnu");
    }

    #[test]
    fn reads_what_apt_would_install() {
        let plan = "NOTE: This is only a simulation!\nInst libedit2 (3.1 Debian:12/stable [amd64])\n\
                    Inst libllvm22 (1:22.1.8 Debian:12/stable [amd64]) []\nConf libedit2 (3.1)\n";
        assert_eq!(planned(plan).collect::<Vec<_>>(), ["libedit2", "libllvm22"]);
        assert!(is_of("rustc-web=1.96.0", "rustc-web") && !is_of("rustc-web=1.96.0", "rustc"));
    }

    #[test]
    fn a_new_candidate_does_not_find_the_old_prefix() {
        let folder = tempfile::tempdir().unwrap();
        let old = folder.path().join(prefix_name("1.96.0", Target::Page));
        fs::create_dir(&old).unwrap();
        fs::create_dir(folder.path().join("unfinished")).unwrap();
        assert_eq!(
            newest_made(folder.path(), Some("1.96.0"), Target::Page),
            Some(old.clone())
        );
        assert_eq!(
            newest_made(folder.path(), Some("1.97.0"), Target::Page),
            None
        );
        assert_eq!(
            newest_made(folder.path(), Some("1.96.0"), Target::Chip),
            None
        );
        assert_eq!(newest_made(folder.path(), None, Target::Page), Some(old));
    }

    #[test]
    fn an_empty_prefix_is_not_usable() {
        let folder = tempfile::tempdir().unwrap();
        assert!(!usable(folder.path(), Target::Page));
    }
}
