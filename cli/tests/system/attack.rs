//! A client in Python, written from `docs/reference/protocol.md` alone (`tests/attack`), attacks the twin and the emulated image
//! over TCP. It shares no code with this workspace, and needs `python3` with its standard library.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::binary::command;
use crate::emulated::board;

/// A twin that listens at a port of its own; killed at the end.
struct Target {
    child: Child,
    address: String,
}

impl Target {
    fn start(more: &[&str]) -> Self {
        let words = [&["twin", "--tcp", "127.0.0.1:0"], more].concat();
        let mut child = command(Path::new("."), &words)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.as_mut().unwrap())
            .read_line(&mut line)
            .unwrap();
        let address = line
            .split_once("tcp:")
            .and_then(|(_, rest)| rest.split_once(';'))
            .map(|(address, _)| address.to_owned());
        Self {
            address: address.unwrap_or_else(|| panic!("no address in {line:?}")),
            child,
        }
    }

    /// Runs all attacks of one kind; every one of them must be refused.
    fn withstands(&self, kind: &str) {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/attack/attacks.py");
        let ran = Command::new("python3")
            .arg("-B")
            .arg(&script)
            .args([kind, &self.address])
            .output()
            .unwrap_or_else(|error| panic!("python3 cannot be started: {error}; install it"));
        let said = String::from_utf8_lossy(&ran.stdout).into_owned();
        println!("{said}");
        assert!(
            ran.status.success(),
            "{said}{}",
            String::from_utf8_lossy(&ran.stderr)
        );
    }
}

impl Drop for Target {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn the_twin_refuses_a_stranger_on_the_radio() {
    Target::start(&["--radio"]).withstands("radio");
}

#[test]
fn the_twin_refuses_a_stranger_once_a_key_is_set() {
    Target::start(&[]).withstands("bench");
}

#[test]
fn the_firmware_refuses_a_stranger_on_the_radio() {
    let board = board();
    let mut words = vec!["--robot", "emulator", "--radio"];
    words.extend(board.iter().map(String::as_str));
    Target::start(&words).withstands("radio");
}
