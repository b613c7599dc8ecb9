//! Tools of optional chores: found in PATH or under target/tools, and installed there on request.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;

use crate::failure::{Failure, Outcome};
use crate::run::{command, run, target_folder, works};

/// Program that cargo installs.
#[derive(Clone, Copy)]
pub(crate) struct Tool {
    /// Package, `cargo-something`.
    package: &'static str,
    /// Version with which the chores were tested.
    version: &'static str,
}

/// Checks the dependencies against deny.toml.
pub(crate) const DENY: Tool = Tool {
    package: "cargo-deny",
    version: "0.20.2",
};
/// Lists the dependencies of the command for a release.
pub(crate) const CYCLONEDX: Tool = Tool {
    package: "cargo-cyclonedx",
    version: "0.5.9",
};
/// Mutates the code and counts the changes that no test detects.
pub(crate) const MUTANTS: Tool = Tool {
    package: "cargo-mutants",
    version: "27.1.0",
};
/// Fuzzes the decoder, the brain, the session and the readers.
pub(crate) const FUZZ: Tool = Tool {
    package: "cargo-fuzz",
    version: "0.13.2",
};

impl Tool {
    /// Returns a `cargo` command that finds the tool, with the tool's name as its first argument.
    ///
    /// # Errors
    /// The tool is missing and `install` is `false`; the message names the command that installs it.
    pub(crate) fn cargo(self, install: bool) -> Outcome<Command> {
        let tools = target_folder()?.join("tools");
        let path = search_path(&tools)?;
        let subcommand = self.package.trim_start_matches("cargo-");
        let cargo = || {
            let mut cargo = command("cargo");
            cargo.arg(subcommand).env("PATH", &path);
            cargo
        };
        if works(cargo().arg("--version")) {
            return Ok(cargo());
        }
        let Self { package, version } = self;
        if !install {
            return Err(Failure::new(
                format!("looking for {package}"),
                "it is not installed",
                format!(
                    "`cargo install --locked {package} --version {version} --root {}`, or repeat the command with --install",
                    tools.display()
                ),
            ));
        }
        run(
            command("cargo")
                .args(["install", "--locked", package, "--version", version])
                .arg("--root")
                .arg(&tools),
            "check the network, and repeat the command",
        )?;
        Ok(cargo())
    }
}

fn search_path(tools: &std::path::Path) -> Outcome<OsString> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::iter::once(tools.join("bin")).chain(std::env::split_paths(&path));
    std::env::join_paths(folders.collect::<Vec<PathBuf>>())
        .map_err(|why| Failure::new("naming the folder of tools", why, "correct PATH"))
}
