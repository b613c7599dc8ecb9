//! Configuration of an emulated board, with a check that all its files exist.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use super::EmulatorError;

/// Board for which the firmware was built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BoardKind {
    /// Arduino Nano RP2040 Connect.
    NanoConnect,
    /// Raspberry Pi Pico.
    Pico,
}

impl BoardKind {
    /// Name of the board in file names of images and in cargo features.
    pub fn word(self) -> &'static str {
        match self {
            Self::NanoConnect => "nano-connect",
            Self::Pico => "pico",
        }
    }
}

/// Files from which an emulated board is started.
#[derive(Debug, Clone, PartialEq)]
pub struct BoardConfig {
    /// The folder of `serve.mjs` with its `node_modules`.
    pub scripts: PathBuf,
    /// The firmware's ELF file, as it is flashed.
    pub firmware: PathBuf,
    /// Board for which the firmware was built.
    pub kind: BoardKind,
}

impl BoardConfig {
    /// Returns the first missing requirement: firmware, script, emulator or Node.js; `None` if all exist.
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
