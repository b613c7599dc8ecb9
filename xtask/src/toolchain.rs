//! Finds a compiler for the chip: the active toolchain where it has the target or rustup can fetch it, Debian's `rustc-web`
//! where it cannot.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::failure::{Failure, Outcome};
use crate::run::{cargo, command, read};

mod fallback;
mod rustup;

/// The RP2040's Cortex-M0+.
pub(crate) const TARGET: &str = "thumbv6m-none-eabi";

/// How to compile for the chip.
#[derive(Debug)]
pub(crate) enum ChipToolchain {
    /// The active toolchain has the target; nothing to set.
    Active,
    /// A private prefix made from Debian's packages.
    Private(PathBuf),
}

impl ChipToolchain {
    /// Finds or makes it; the second time it only finds it.
    ///
    /// # Errors
    /// When the active toolchain lacks the target, rustup cannot fetch it and Debian's packages are out of reach; the message
    /// has the command.
    pub(crate) fn find_or_make() -> Outcome<Self> {
        let compiler = HostCompiler::active()?;
        if has_core(&compiler.sysroot) {
            return Ok(Self::Active);
        }
        if let Some(prefix) = fallback::find()? {
            return Ok(Self::Private(prefix));
        }
        match rustup::add_target() {
            Ok(()) if has_core(&compiler.sysroot) => return Ok(Self::Active),
            Ok(()) => {
                eprintln!("rustup has added {TARGET} to a toolchain that is not the active one");
            }
            Err(why) => eprintln!("{why}\nNow Debian's packages are tried in its place."),
        }
        fallback::make(&compiler).map(Self::Private)
    }

    /// `cargo SUBCOMMAND --target …` for the chip, in the small profile of the firmware.
    pub(crate) fn cargo(&self, subcommand: &str) -> Command {
        let mut cargo = cargo([subcommand, "--target", TARGET, "--profile", "firmware"]);
        if let Self::Private(prefix) = self {
            cargo.env("RUSTC", prefix.join("bin/rustc"));
        }
        cargo
    }

    /// `cargo clippy` for the chip, warnings denied.
    pub(crate) fn clippy(&self) -> Command {
        match self {
            Self::Active => {
                // cargo-clippy takes its driver's flags after `--`, behind the packages that the caller adds.
                self.cargo("clippy")
            }
            Self::Private(prefix) => {
                // cargo-clippy would pick the active toolchain's driver; this is what it does, with the right one.
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

    /// Flags for [`Self::clippy`] that stand at the end of its command line.
    pub(crate) fn clippy_flags(&self) -> &'static [&'static str] {
        match self {
            Self::Active => &["--", "-D", "warnings"],
            Self::Private(_) => &[],
        }
    }

    /// One line for the reader.
    pub(crate) fn describe(&self) -> String {
        match self {
            Self::Active => format!("the active toolchain has {TARGET}"),
            Self::Private(prefix) => {
                format!("{TARGET} from Debian's rustc-web, in {}", prefix.display())
            }
        }
    }
}

/// The compiler that cargo uses for the host.
#[derive(Debug)]
struct HostCompiler {
    sysroot: PathBuf,
    /// Its target triple, such as `x86_64-unknown-linux-gnu`.
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

/// Whether a sysroot holds `core` for the chip.
fn has_core(sysroot: &Path) -> bool {
    fs::read_dir(library_folder(sysroot)).is_ok_and(|entries| {
        entries.flatten().any(|entry| {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            name.starts_with("libcore-") && name.ends_with(".rlib")
        })
    })
}

/// Where a sysroot keeps its libraries for the chip.
fn library_folder(sysroot: &Path) -> PathBuf {
    sysroot.join("lib/rustlib").join(TARGET).join("lib")
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
        assert!(!has_core(sysroot.path()));
        let folder = library_folder(sysroot.path());
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("libcore-1234.rmeta"), "").unwrap();
        assert!(!has_core(sysroot.path()));
        fs::write(folder.join("libcore-1234.rlib"), "").unwrap();
        assert!(has_core(sysroot.path()));
    }
}
