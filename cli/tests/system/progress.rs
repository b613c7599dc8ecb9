//! Jobs of more than a second show their progress and the remaining time: on a terminal, and only there.

use std::fs::File;
use std::io::Read as _;
use std::os::fd::OwnedFd;
use std::process::Stdio;

use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

use super::binary::command;

/// Output of a command to a terminal on its standard error.
fn on_a_terminal(words: &[&str], columns: u16) -> String {
    let terminal = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&terminal).unwrap();
    unlockpt(&terminal).unwrap();
    let name = ptsname(&terminal, Vec::new()).unwrap();
    let slave = File::options()
        .read(true)
        .write(true)
        .open(name.to_str().unwrap())
        .unwrap();
    let size = rustix::termios::Winsize {
        ws_row: 24,
        ws_col: columns,
        ws_xpixel: 0,
        ws_ypixel: 0,
    };
    rustix::termios::tcsetwinsize(&slave, size).unwrap();
    let mut child = command(&std::env::temp_dir(), words)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::from(OwnedFd::from(slave)))
        .spawn()
        .unwrap();
    let mut said = Vec::new();
    let mut terminal = File::from(terminal);
    let mut some = [0; 4096];
    // The other end is gone where the command is: an error, as Linux has it.
    while let Ok(count @ 1..) = terminal.read(&mut some) {
        said.extend_from_slice(&some[..count]);
    }
    assert!(child.wait().unwrap().success());
    String::from_utf8_lossy(&said).into_owned()
}

const ATLAS: [&str; 8] = [
    "atlas",
    "--swimmer",
    "robot",
    "--objective",
    "displacement",
    "--max-angle",
    "2.8",
    "--starts=60",
];

#[test]
fn progress_is_told_on_a_terminal_however_narrow_and_without_colour() {
    for columns in [100, 20] {
        let said = on_a_terminal(&ATLAS, columns);
        assert!(said.contains("looking"), "{said}");
        assert!(said.contains(" s left"), "{said}");
        // No colour: no sequence that ends in m.
        let colours = said.split('\u{1b}').skip(1);
        let coloured = |sequence: &str| {
            sequence
                .trim_start_matches(|c: char| !c.is_alphabetic())
                .starts_with('m')
        };
        assert!(!colours.clone().any(coloured), "{said:?}");
    }
}

#[test]
fn scripts_are_told_nothing_of_it() {
    let said = on_a_terminal(&[&ATLAS[..], &["--json"]].concat(), 100);
    assert_eq!(said, "");
}
