//! Robots that need no hardware: the twin, whose brain runs here, and the emulated one, whose brain is the firmware's image on
//! an emulated chip. Both swim in the same tank and hang on the same line.

use std::env;
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use emulator::{
    Board, BoardConfig, BoardKind, EmulatedRobot, EmulatorError, LogLevel, LogLine, commission,
};
use host_link::port::{VirtualPort, WireSpeed};
use swimmer_files::SwimmerFile;
use twin::{Twin, TwinConfig, VirtualRobot, World};

use crate::failure::{Failure, Outcome};
use crate::new_file::may_be_written;
use crate::output::aside;

/// The host's end of a line to a robot that needs no hardware, in virtual time.
pub(crate) type VirtualLine = VirtualPort<Box<dyn VirtualRobot>>;

/// Implementation of a robot without hardware.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Carrier {
    /// This machine: the brain alone
    Twin,
    /// An emulated RP2040: the very firmware that is flashed
    Emulator,
}

/// Firmware of the emulated robot, and its emulator.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Emulated robot")]
pub(crate) struct EmulatedBoard {
    /// Board of the emulated robot
    #[arg(
        long,
        value_enum,
        value_name = "BOARD",
        default_value = "nano-connect",
        global = true,
        hide_short_help = true
    )]
    board: BoardName,
    /// Firmware of the emulated robot; left out: what `cargo xtask firmware` built in this checkout
    #[arg(long, value_name = "FILE.elf", global = true, hide_short_help = true)]
    firmware: Option<PathBuf>,
    /// Folder with the emulator that `cargo xtask emulator` set up; left out: emulator/board of this checkout
    #[arg(long, value_name = "DIR", global = true, hide_short_help = true)]
    emulator: Option<PathBuf>,
    /// Write the log of the emulated robot's firmware here, with emulated times; nothing may be there yet. Warnings and
    /// errors in it are shown anyway
    #[arg(long, value_name = "FILE", global = true, hide_short_help = true)]
    firmware_log: Option<PathBuf>,
}

impl Default for EmulatedBoard {
    /// The usual board, with the files of this checkout.
    fn default() -> Self {
        Self {
            board: BoardName::NanoConnect,
            firmware: None,
            emulator: None,
            firmware_log: None,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum BoardName {
    NanoConnect,
    Pico,
}

impl Carrier {
    /// A line to a robot that was just switched on, in a tank where `file` is the truth, set up as its laboratory does it.
    ///
    /// # Errors
    /// [`Failure::BadInput`] when the file describes no swimmer or what an emulated board needs is missing,
    /// [`Failure::Tried`] when the emulated board fails or its firmware refuses the file's servos.
    pub(crate) fn line(
        self,
        file: &SwimmerFile,
        seed: u64,
        board: &EmulatedBoard,
    ) -> Outcome<VirtualLine> {
        self.line_with(file, &TwinConfig::new(file, seed), board)
    }

    /// The same with the servos that the configuration names.
    ///
    /// # Errors
    /// As [`line`](Self::line).
    pub(crate) fn line_with(
        self,
        file: &SwimmerFile,
        config: &TwinConfig,
        board: &EmulatedBoard,
    ) -> Outcome<VirtualLine> {
        let no_swimmer =
            |error| Failure::BadInput(format!("the swimmer `{}` cannot swim: {error}", file.name));
        match self {
            Self::Twin => {
                let twin = Twin::new(config.clone()).map_err(no_swimmer)?;
                Ok(VirtualPort::new(Box::new(twin), WireSpeed::robot()))
            }
            Self::Emulator => {
                let world = World::new(config).map_err(no_swimmer)?;
                let robot = EmulatedRobot::new(Board::start(&board.config()?)?, world)?
                    .with_log_reader(log_reader(board.firmware_log.as_deref())?)
                    .without_events();
                let line = commission(robot, config)?;
                Ok(line.map_device(|robot| Box::new(robot) as Box<dyn VirtualRobot>))
            }
        }
    }
}

impl EmulatedBoard {
    /// Paths of firmware and emulator: as named, else in the checkout around the working directory.
    fn config(&self) -> Outcome<BoardConfig> {
        let here = env::current_dir().map_err(|error| {
            Failure::Tried(format!(
                "cannot tell the working directory: {error}; go to one that exists"
            ))
        })?;
        let target = env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
        let kind = match self.board {
            BoardName::NanoConnect => BoardKind::NanoConnect,
            BoardName::Pico => BoardKind::Pico,
        };
        let mut config = BoardConfig::of_checkout(&here, target.as_deref(), kind);
        if let Some(firmware) = &self.firmware {
            config.firmware.clone_from(firmware);
        }
        if let Some(emulator) = &self.emulator {
            config.scripts.clone_from(emulator);
        }
        Ok(config)
    }
}

/// Handler of the firmware's log: all lines go to `file`, warnings and errors also to standard error.
fn log_reader(file: Option<&Path>) -> Outcome<impl FnMut(&LogLine) + Send + 'static> {
    let mut file = file.map(new_log).transpose()?;
    Ok(move |line: &LogLine| {
        if line.level >= LogLevel::Warn {
            aside(&format!("The firmware says: {line}"));
        }
        if let Some(open) = &mut file
            && let Err(error) = writeln!(open, "{line}")
        {
            aside(&format!("The firmware's log ends here: {error}"));
            file = None;
        }
    })
}

fn new_log(place: &Path) -> Outcome<File> {
    let shown = place.display();
    may_be_written(place)?;
    let file = File::create(place).map_err(|error| {
        Failure::Tried(format!(
            "cannot write the firmware's log to {shown}: {error}; may you write there, and is there room?"
        ))
    })?;
    aside(&format!("The firmware's log grows in {shown}."));
    Ok(file)
}

impl From<EmulatorError> for Failure {
    /// Missing files are bad input, since they can be named or installed; other errors are failures.
    fn from(error: EmulatorError) -> Self {
        match error {
            EmulatorError::Missing { .. } | EmulatorError::Node(_) => Self::bad_input(&error),
            EmulatorError::Gone { .. } | EmulatorError::Failed { .. } => Self::tried(&error),
        }
    }
}
