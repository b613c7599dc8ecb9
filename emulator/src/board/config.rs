//! What a board is started from, and what of it is missing.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use super::EmulatorError;

/// Which board the firmware was built for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BoardKind {
    /// Arduino Nano RP2040 Connect.
    NanoConnect,
    /// Raspberry Pi Pico.
    Pico,
}

impl BoardKind {
    /// The word in the names of images and features.
    pub fn word(self) -> &'static str {
        match self {
            Self::NanoConnect => "nano-connect",
            Self::Pico => "pico",
        }
    }
}

/// What is needed to start a board.
#[derive(Debug, Clone, PartialEq)]
pub struct BoardConfig {
    /// The folder of `serve.mjs` with its `node_modules`.
    pub scripts: PathBuf,
    /// The firmware's ELF file, as it is flashed.
    pub firmware: PathBuf,
    /// The board it was built for.
    pub kind: BoardKind,
}

impl BoardConfig {
    /// The first thing that is needed and not there: firmware, script, emulator or Node.js.
    pub fn missing(&self) -> Option<EmulatorError> {
        let script = self.scripts.join("serve.mjs");
        let emulator = self.scripts.join("node_modules/rp2040js");
        let needed = [
            (
                "the firmware",
                &self.firmware,
                "build it with `cargo xtask firmware`",
            ),
            (
                "its script",
                &script,
                "name the folder `emulator/board` of the sources",
            ),
            (
                "the RP2040 emulator",
                &emulator,
                "install it with `cargo xtask emulator`",
            ),
        ];
        let absent = needed.into_iter().find(|(_, path, _)| !path.exists());
        if let Some((what, path, advice)) = absent {
            return Some(EmulatorError::Missing {
                what,
                path: path.clone(),
                advice,
            });
        }
        let node = Command::new("node")
            .arg("--version")
            .stdout(Stdio::null())
            .status();
        node.err().map(EmulatorError::Node)
    }
}
