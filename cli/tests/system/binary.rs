//! Runs the `swimmer` binary and reads what it says.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// Result of a run of the binary.
pub(crate) struct Ran {
    pub(crate) status: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Ran {
    /// The one JSON document on standard output.
    pub(crate) fn json(&self) -> Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| {
            panic!("standard output is not one JSON document ({error}): {self}")
        })
    }

    /// The same run, which must have ended with this exit status.
    #[track_caller]
    pub(crate) fn with_status(self, status: i32) -> Self {
        assert_eq!(self.status, status, "{self}");
        self
    }
}

impl std::fmt::Display for Ran {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "exit status {}\nstdout:\n{}\nstderr:\n{}",
            self.status, self.stdout, self.stderr
        )
    }
}

impl From<Output> for Ran {
    fn from(output: Output) -> Self {
        Self {
            status: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8(output.stdout).expect("UTF-8 on standard output"),
            stderr: String::from_utf8(output.stderr).expect("UTF-8 on standard error"),
        }
    }
}

/// The binary with these words, in this folder.
pub(crate) fn command(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_swimmer"));
    command.current_dir(folder).args(words);
    command
}

/// The binary with a limit on file sizes in blocks of 512 bytes, which acts as a full disk.
pub(crate) fn on_a_small_disk(folder: &Path, blocks: u32, words: &[&str]) -> Command {
    let mut shell = Command::new("sh");
    let limited = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$@\"");
    shell.current_dir(folder).args(["-c", &limited, "sh"]);
    shell.arg(env!("CARGO_BIN_EXE_swimmer")).args(words);
    shell
}

/// Runs the binary to its end.
pub(crate) fn swimmer_in(folder: &Path, words: &[&str]) -> Ran {
    command(folder, words)
        .output()
        .expect("the binary starts")
        .into()
}

/// The same, its words as they are typed.
pub(crate) fn typed(folder: &Path, line: &str) -> Ran {
    swimmer_in(folder, &line.split(' ').collect::<Vec<_>>())
}

/// Runs the binary to its end where it needs no folder.
pub(crate) fn swimmer(words: &[&str]) -> Ran {
    swimmer_in(&std::env::temp_dir(), words)
}

/// A number in a JSON document.
#[track_caller]
pub(crate) fn number(document: &Value, key: &str) -> f64 {
    document[key]
        .as_f64()
        .unwrap_or_else(|| panic!("no number under {key} in {document:#}"))
}

/// Ctrl-C, as the terminal sends it.
#[cfg(unix)]
pub(crate) fn interrupt(child: &std::process::Child) {
    // By the system call: a bare machine has no `kill` program.
    let id = rustix::process::Pid::from_child(child);
    rustix::process::kill_process(id, rustix::process::Signal::INT).expect("the process lives");
}

/// A `swimmer twin` process; interrupted and waited for at the end, so that none outlives its test.
#[cfg(unix)]
pub(crate) struct TwinProcess {
    child: std::process::Child,
    link: std::path::PathBuf,
}

#[cfg(unix)]
impl TwinProcess {
    pub(crate) fn start(folder: &Path, more: &[&str]) -> Self {
        let mut words = vec!["twin", "--pty", "robot"];
        words.extend(more);
        let child = command(folder, &words)
            .stdout(std::process::Stdio::null())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        let twin = Self {
            child,
            link: folder.join("robot"),
        };
        let patience = std::time::Instant::now() + std::time::Duration::from_secs(20);
        while !twin.link.exists() {
            assert!(
                std::time::Instant::now() < patience,
                "the twin made no link {}",
                twin.link.display()
            );
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
        twin
    }

    /// Ctrl-C, then the exit status.
    pub(crate) fn interrupt(&mut self) -> Option<i32> {
        interrupt(&self.child);
        self.child.wait().unwrap().code()
    }
}

#[cfg(unix)]
impl Drop for TwinProcess {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
