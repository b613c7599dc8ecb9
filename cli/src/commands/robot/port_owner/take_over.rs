//! Past a `swimmer` that has the port and hangs: a second way to the same robot, or the end of that process.

use std::path::Path;
use std::time::{Duration, Instant};

use host_link::port::OccupiedPort;
use rustix::process::{Pid, Signal, kill_process};

use super::super::port::is_a_path;

/// A killed process lets go of its port in less.
const TO_LET_GO: Duration = Duration::from_secs(1);
const LOOK_AGAIN: Duration = Duration::from_millis(5);

/// A second connection to the device. Returns `None` if the port is no device or cannot be opened twice.
pub(super) fn occupied(port: &str) -> Option<OccupiedPort> {
    if !is_a_path(port) {
        return None;
    }
    OccupiedPort::open(Path::new(port)).ok()
}

/// Ends the process, which must be a `swimmer`, and waits until `is_gone`.
///
/// # Errors
/// The reason why it was left alone, as a clause.
pub(super) fn end(process: &str, is_gone: impl Fn() -> bool) -> Result<(), String> {
    // Numbers below one mean groups of processes to the system.
    let number = process.parse().ok().filter(|number: &i32| *number > 0);
    let pid = number.and_then(Pid::from_raw);
    let Some(pid) = pid.filter(|_| is_a_swimmer(process)) else {
        return Err(format!(
            "process {process} was left alone, because it does not look like a `swimmer`"
        ));
    };
    kill_process(pid, Signal::KILL)
        .map_err(|error| format!("process {process} could not be ended: {error}"))?;
    let begun = Instant::now();
    while !is_gone() {
        if begun.elapsed() > TO_LET_GO {
            return Err(format!("process {process} was ended and still has it"));
        }
        std::thread::sleep(LOOK_AGAIN);
    }
    Ok(())
}

/// `true` if the process runs this program, by its name: process numbers are reused.
fn is_a_swimmer(process: &str) -> bool {
    let ours = std::env::current_exe().ok();
    let ours = ours.as_deref().and_then(name_of).unwrap_or("swimmer");
    program_of(process).is_some_and(|program| {
        // What Linux says of a program that was built anew since.
        let program = program.trim_end_matches(" (deleted)");
        name_of(Path::new(program)).is_some_and(|name| name == ours || name == "swimmer")
    })
}

fn name_of(program: &Path) -> Option<&str> {
    program.file_name()?.to_str()
}

#[cfg(target_os = "linux")]
fn program_of(process: &str) -> Option<String> {
    let program = std::fs::read_link(format!("/proc/{process}/exe")).ok()?;
    program.to_str().map(str::to_owned)
}

#[cfg(not(target_os = "linux"))]
fn program_of(process: &str) -> Option<String> {
    let words = ["-p", process, "-o", "comm="];
    let output = std::process::Command::new("ps").args(words).output().ok()?;
    let program = String::from_utf8(output.stdout).ok()?;
    Some(program.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::{Command, Stdio};

    /// The number of a process may be another program's by now: that one lives on.
    #[test]
    fn a_process_that_is_no_swimmer_is_left_alone() {
        let mut other = Command::new("sh")
            .args(["-c", "read line"])
            .stdin(Stdio::piped())
            .spawn()
            .unwrap();
        let refused = end(&other.id().to_string(), || true).unwrap_err();
        assert!(refused.contains("left alone"), "{refused}");
        assert!(other.try_wait().unwrap().is_none(), "it lives");
        drop(other.stdin.take());
        other.wait().unwrap();
        for nonsense in ["", "0", "-1", "unknown", "1e3"] {
            assert!(end(nonsense, || true).is_err(), "{nonsense}");
        }
    }

    #[test]
    fn this_program_knows_itself() {
        assert!(is_a_swimmer(&std::process::id().to_string()));
    }
}
