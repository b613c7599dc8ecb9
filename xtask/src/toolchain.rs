//! Compilers for the chip and the lab page: the active toolchain if it has the target or rustup can fetch it, otherwise Debian's
//! `rustc-web`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::failure::{Failure, Outcome};
use crate::run::{cargo, command, read};

mod fallback;
mod rustup;

/// Target other than this machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Target {
    /// The RP2040's Cortex-M0+.
    Chip,
    /// The lab page, in a browser.
    Page,
}

impl Target {
    /// Target triple of rustc.
    pub(crate) const fn triple(self) -> &'static str {
        match self {
            Self::Chip => "thumbv6m-none-eabi",
            Self::Page => "wasm32-unknown-unknown",
        }
    }

    /// Cargo profile of the target.
    const fn profile(self) -> &'static str {
        match self {
            Self::Chip => "firmware",
            Self::Page => "lab",
        }
    }

    /// Crates of the standard library that our code for the target uses.
    const fn library(self) -> &'static str {
        match self {
            Self::Chip => "core,alloc",
            Self::Page => "std,panic_abort",
        }
    }

    /// Flags of rustc for our crates and for the standard library. The page's modules leave out the messages of panics, which are
    /// a tenth of a module and which a page cannot show. They inline only small functions, such as the steps of a formula. Vector
    /// instructions, which all current browsers have, make the modules smaller as well.
    const fn flags(self) -> &'static str {
        match self {
            Self::Chip => "",
            Self::Page => {
                "-Zunstable-options -Cpanic=immediate-abort -Ctarget-feature=+simd128 -Cllvm-args=-inline-threshold=25"
            }
        }
    }

    /// Arguments of cargo that build the standard library together with our crates.
    fn own_library(self) -> Vec<String> {
        let crates = format!("-Zbuild-std={}", self.library());
        match self {
            Self::Chip => vec![crates],
            Self::Page => vec![crates, "-Zbuild-std-features=optimize_for_size".to_owned()],
        }
    }

    /// Returns `true` if a toolchain can compile for the target: it has the library, or for the page its sources.
    fn is_served_by(self, sysroot: &Path) -> bool {
        match self {
            Self::Chip => has_core(sysroot, self),
            Self::Page => sysroot
                .join("lib/rustlib/src/rust/library/Cargo.lock")
                .is_file(),
        }
    }
}

/// Compiler for a target.
#[derive(Debug)]
pub(crate) struct Toolchain {
    target: Target,
    /// Private prefix made from Debian packages; `None` if the active toolchain has the target.
    prefix: Option<PathBuf>,
}

impl Toolchain {
    /// Finds the compiler, or makes it.
    ///
    /// # Errors
    /// The active toolchain lacks the target, rustup cannot fetch it, and Debian packages are not available. The message has the
    /// command to run.
    pub(crate) fn find_or_make(target: Target) -> Outcome<Self> {
        let prefix = find_or_make_prefix(target)?;
        Ok(Self { target, prefix })
    }

    /// `cargo SUBCOMMAND --target …` with the profile of the target.
    pub(crate) fn cargo(&self, subcommand: &str) -> Command {
        let (triple, profile) = (self.target.triple(), self.target.profile());
        let mut cargo = cargo([subcommand, "--target", triple, "--profile", profile]);
        if let Some(prefix) = &self.prefix {
            cargo.env("RUSTC", prefix.join("bin/rustc"));
        }
        if self.target == Target::Page {
            cargo
                .env("RUSTC_BOOTSTRAP", "1") // for the flags, and for a library of our own
                .env_remove("RUSTFLAGS") // either would take the place of ours
                .env_remove("CARGO_ENCODED_RUSTFLAGS")
                .env(
                    "CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS",
                    self.target.flags(),
                );
            if self.prefix.is_none() {
                cargo.args(self.target.own_library());
            }
        }
        cargo
    }

    /// `cargo clippy` for the target, warnings denied.
    pub(crate) fn clippy(&self) -> Command {
        match &self.prefix {
            None => {
                // cargo-clippy takes its driver's flags after `--`, behind the packages that the caller adds.
                self.cargo("clippy")
            }
            Some(prefix) => {
                // cargo-clippy would use the driver of the active toolchain; this does the same with the right driver.
                let mut check = self.cargo("check");
                check.env("RUSTC_WORKSPACE_WRAPPER", prefix.join("bin/clippy-driver"));
                check.env(
                    "CLIPPY_ARGS",
                    "-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__",
                );
                check
            }
        }
    }

    /// Flags for the end of the command line of [`Self::clippy`].
    pub(crate) fn clippy_flags(&self) -> &'static [&'static str] {
        match self.prefix {
            None => &["--", "-D", "warnings"],
            Some(_) => &[],
        }
    }

    /// Description in one line.
    pub(crate) fn describe(&self) -> String {
        let triple = self.target.triple();
        match &self.prefix {
            None => format!("the active toolchain has what {triple} takes"),
            Some(prefix) => format!("{triple} from Debian's rustc-web, in {}", prefix.display()),
        }
    }
}

fn find_or_make_prefix(target: Target) -> Outcome<Option<PathBuf>> {
    let compiler = HostCompiler::active()?;
    if target.is_served_by(&compiler.sysroot) {
        return Ok(None);
    }
    if let Some(prefix) = fallback::find(target)? {
        return Ok(Some(prefix));
    }
    let triple = target.triple();
    match rustup::add(target) {
        Ok(()) if target.is_served_by(&compiler.sysroot) => return Ok(None),
        Ok(()) => eprintln!("rustup has served {triple} in a toolchain that is not the active one"),
        Err(why) => eprintln!("{why}\nNow Debian's packages are tried in its place."),
    }
    fallback::make(&compiler, target).map(Some)
}

/// Compiler that cargo uses for the host.
#[derive(Debug)]
struct HostCompiler {
    sysroot: PathBuf,
    /// Target triple, such as `x86_64-unknown-linux-gnu`.
    triple: String,
}

impl HostCompiler {
    fn active() -> Outcome<Self> {
        let next = "install Rust from https://rustup.rs and repeat the command";
        let sysroot = read(command("rustc").args(["--print", "sysroot"]), next)?;
        let version = read(command("rustc").arg("-vV"), next)?;
        let triple = host_triple(&version).ok_or_else(|| {
            Failure::new(
                "reading `rustc -vV`",
                "it has no line `host: …`",
                "check which rustc stands first in PATH",
            )
        })?;
        Ok(Self {
            sysroot: PathBuf::from(sysroot.trim()),
            triple: triple.to_owned(),
        })
    }
}

fn host_triple(verbose_version: &str) -> Option<&str> {
    verbose_version
        .lines()
        .find_map(|line| line.strip_prefix("host: "))
        .map(str::trim)
}

/// Returns `true` if a sysroot has `core` for the target.
fn has_core(sysroot: &Path, target: Target) -> bool {
    fs::read_dir(library_folder(sysroot, target)).is_ok_and(|entries| {
        entries.flatten().any(|entry| {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            name.starts_with("libcore-") && name.ends_with(".rlib")
        })
    })
}

/// Folder of a sysroot with the libraries for the target.
fn library_folder(sysroot: &Path, target: Target) -> PathBuf {
    sysroot
        .join("lib/rustlib")
        .join(target.triple())
        .join("lib")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_the_host_triple() {
        let version = "rustc 1.95.0 (59807616e 2026-04-14)\nbinary: rustc\nhost: x86_64-unknown-linux-gnu\nrelease: 1.95.0\n";
        assert_eq!(host_triple(version), Some("x86_64-unknown-linux-gnu"));
        assert_eq!(host_triple("rustc 1.95.0"), None);
    }

    #[test]
    fn a_target_counts_only_with_its_core() {
        let sysroot = tempfile::tempdir().unwrap();
        assert!(!has_core(sysroot.path(), Target::Page));
        let folder = library_folder(sysroot.path(), Target::Page);
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("libcore-1234.rmeta"), "").unwrap();
        assert!(!has_core(sysroot.path(), Target::Page));
        fs::write(folder.join("libcore-1234.rlib"), "").unwrap();
        assert!(has_core(sysroot.path(), Target::Page));
        assert!(!has_core(sysroot.path(), Target::Chip));
    }

    #[test]
    fn a_page_takes_the_sources_of_the_library() {
        let sysroot = tempfile::tempdir().unwrap();
        assert!(!Target::Page.is_served_by(sysroot.path()));
        let library = sysroot.path().join("lib/rustlib/src/rust/library");
        fs::create_dir_all(&library).unwrap();
        fs::write(library.join("Cargo.lock"), "").unwrap();
        assert!(Target::Page.is_served_by(sysroot.path()));
        assert!(!Target::Chip.is_served_by(sysroot.path()));
    }
}
