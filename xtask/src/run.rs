//! Execution of other programs: prints the command line, passes output through, and converts an error exit into a [`Failure`].

use std::ffi::OsStr;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::failure::{Failure, Outcome};

/// Variables that `cargo run` sets for xtask only; a nested cargo must not see them.
const OF_THE_OUTER_CARGO: [&str; 2] = ["CARGO_PKG_", "CARGO_MANIFEST_"];

/// Command for a child process: rustup does not download anything, and the variables of the outer `cargo run` are removed.
pub(crate) fn command(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    command.env("RUSTUP_AUTO_INSTALL", "0");
    for (name, _) in std::env::vars_os() {
        if name.to_str().is_some_and(|name| {
            OF_THE_OUTER_CARGO
                .iter()
                .any(|prefix| name.starts_with(prefix))
        }) {
            command.env_remove(name);
        }
    }
    command
}

/// Command of the cargo that runs xtask (or of the one in PATH), with these arguments.
pub(crate) fn cargo<const N: usize>(arguments: [&str; N]) -> Command {
    let mut cargo = command(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(arguments);
    cargo
}

/// Runs the command and passes its output through.
///
/// # Errors
/// It cannot be started or fails; `next` is the next step for the user.
pub(crate) fn run(command: &mut Command, next: &str) -> Outcome {
    let line = command_line(command);
    eprintln!("$ {line}");
    let doing = || format!("running `{line}`");
    let status = command
        .status()
        .map_err(|why| Failure::new(doing(), why, next))?;
    if status.success() {
        Ok(())
    } else {
        Err(Failure::new(doing(), status, next))
    }
}

/// Like [`run`], but ends the command after `patience`.
///
/// # Errors
/// As [`run`]; the command took too long.
pub(crate) fn run_for(patience: Duration, command: &mut Command, next: &str) -> Outcome {
    let line = command_line(command);
    eprintln!("$ {line}");
    let failed = |why: &dyn std::fmt::Display| Failure::new(format!("running `{line}`"), why, next);
    let mut child = command.spawn().map_err(|why| failed(&why))?;
    let begun = Instant::now();
    loop {
        match child.try_wait().map_err(|why| failed(&why))? {
            Some(status) if status.success() => return Ok(()),
            Some(status) => return Err(failed(&status)),
            None if begun.elapsed() > patience => {
                let _ = child.kill();
                let _ = child.wait();
                return Err(failed(&format_args!("no end after {patience:?}")));
            }
            None => std::thread::sleep(Duration::from_millis(50)),
        }
    }
}

/// Runs the command quietly and returns its standard output.
///
/// # Errors
/// It cannot be started or fails; its standard error is part of the reason.
pub(crate) fn read(command: &mut Command, next: &str) -> Outcome<String> {
    let line = command_line(command);
    let doing = || format!("running `{line}`");
    let output = command
        .stdin(Stdio::null())
        .output()
        .map_err(|why| Failure::new(doing(), why, next))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        let why = format!(
            "{}: {}",
            output.status,
            String::from_utf8_lossy(&output.stderr).trim()
        );
        Err(Failure::new(doing(), why, next))
    }
}

/// Returns `true` if the command starts and succeeds; prints nothing.
pub(crate) fn works(command: &mut Command) -> bool {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

/// Target folder of cargo, with the user's configuration taken into account.
pub(crate) fn target_folder() -> Outcome<PathBuf> {
    let next = "run `cargo metadata` by hand to see why";
    let metadata = read(
        &mut cargo(["metadata", "--no-deps", "--format-version", "1"]),
        next,
    )?;
    let metadata: serde_json::Value = serde_json::from_str(&metadata)
        .map_err(|why| Failure::new("reading `cargo metadata`", why, next))?;
    metadata["target_directory"]
        .as_str()
        .map(PathBuf::from)
        .ok_or_else(|| {
            Failure::new(
                "reading `cargo metadata`",
                "no key `target_directory`",
                next,
            )
        })
}

/// Command line for display, with the variables that were set for it (except the constant one).
pub(crate) fn command_line(command: &Command) -> String {
    let variables = command.get_envs().filter_map(|(name, value)| {
        let (name, value) = (name.to_str()?, value?.to_str()?);
        (name != "RUSTUP_AUTO_INSTALL").then(|| format!("{name}={}", quoted(value)))
    });
    let words = std::iter::once(command.get_program())
        .chain(command.get_args())
        .map(|word| quoted(&word.to_string_lossy()));
    variables.chain(words).collect::<Vec<_>>().join(" ")
}

fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,+@%^~".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_can_be_pasted_into_a_shell() {
        let mut echo = command("echo");
        echo.args(["two words", "it's", "plain"])
            .env("FLAGS", "-D warnings");
        assert_eq!(
            command_line(&echo),
            r"FLAGS='-D warnings' echo 'two words' 'it'\''s' plain"
        );
    }

    #[test]
    fn a_bad_exit_names_the_command_and_the_next_step() {
        let failure = run(command("sh").args(["-c", "exit 3"]), "try again")
            .unwrap_err()
            .to_string();
        assert!(failure.contains("sh -c 'exit 3'"), "{failure}");
        assert!(failure.contains("exit status: 3"), "{failure}");
        assert!(failure.ends_with("next: try again"), "{failure}");
    }

    #[test]
    fn what_never_ends_is_ended() {
        let patience = Duration::from_millis(100);
        let failure = run_for(patience, command("sleep").arg("60"), "go on without")
            .unwrap_err()
            .to_string();
        assert!(
            failure.contains("`sleep 60`: no end after 100ms"),
            "{failure}"
        );
        assert!(run_for(Duration::from_mins(1), &mut command("true"), "").is_ok());
    }

    #[test]
    fn a_missing_program_is_a_failure_not_a_panic() {
        assert!(read(&mut command("no-such-program-anywhere"), "install it").is_err());
        assert!(!works(&mut command("no-such-program-anywhere")));
    }
}
