//! `swimmer robot flash`: a new firmware over the USB cable, without a probe. The robot enters its chip's boot loader, which
//! appears as a drive; the image is copied onto that.

mod drive;

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use firmware_image::{BinaryInfo, Flash as FlashMemory};
use link_protocol::{Board, StateName};
use serde::Serialize;

use super::access::Access;
use super::info::board;
use super::outputs::state;
use super::port::Pace;
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output::{Output, aside};

/// A drive takes some seconds to come up, a computer some to mount it.
const TO_COME_UP: Duration = Duration::from_secs(30);
/// Folder of the images of `cargo xtask firmware`, from the top of the checkout.
const IMAGES: &str = "target/firmware-images";

/// Put a new firmware onto the robot's board, over its USB cable
///
/// The robot, stopped and with somebody at it (over its USB cable, or with its bench jumper closed), is sent to its boot
/// loader; its drive is found, and the image copied onto it. A board that does not answer is brought there by hand: Pico,
/// hold BOOTSEL while you plug it in; Nano, join REC to GND while you plug it in; then --by-hand.
#[derive(Debug, clap::Args)]
pub(super) struct Flash {
    /// The image; left out, what `cargo xtask firmware` built in this checkout for the robot's board
    #[arg(value_name = "FILE.uf2")]
    file: Option<PathBuf>,
    /// Ask no robot: the board is in its boot loader already
    #[arg(long, requires = "file")]
    by_hand: bool,
    /// The boot loader's drive; left out, it is looked for
    #[arg(long, value_name = "DIR")]
    drive: Option<PathBuf>,
}

#[derive(Debug, Serialize)]
struct Flashed {
    file: String,
    /// Version in the image's binary information.
    version: Option<String>,
    board: Option<&'static str>,
    drive: String,
    bytes: usize,
}

impl fmt::Display for Flashed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "Copied {} ({}, for {}) onto {}: the board restarts with it. Settings and the stored gait stay; `swimmer robot info` prints the new version.",
            self.file,
            self.version.as_deref().unwrap_or("of no version"),
            self.board.unwrap_or("a board that it does not name"),
            self.drive
        )
    }
}

/// An image of this robot's firmware.
struct Checked {
    file: PathBuf,
    bytes: Vec<u8>,
    info: BinaryInfo,
}

/// `swimmer robot flash`.
pub(super) fn run(access: &Access, arguments: &Flash, output: Output) -> Outcome {
    let interrupt = Interrupt::install()?;
    // A named file is read before any robot is disturbed.
    let named = arguments.file.as_deref().map(Checked::read).transpose()?;
    if let Some(folder) = &arguments.drive
        && arguments.by_hand
    {
        is_a_drive(folder)?;
    }
    let checked = match named {
        Some(checked) if arguments.by_hand => checked,
        named => into_the_boot_loader(access, named)?,
    };
    let drive = match &arguments.drive {
        Some(folder) => folder.clone(),
        None => drive::wait(TO_COME_UP, &interrupt)?,
    };
    is_a_drive(&drive)?;
    let name = checked
        .file
        .file_name()
        .and_then(|name| name.to_str())
        .unwrap_or("firmware.uf2");
    drive::copy(&drive, name, &checked.bytes).map_err(|error| {
        Failure::Tried(format!(
            "copying {} onto {}: {error}; the board is still in its boot loader: copy the file by hand, or try again with --by-hand",
            checked.file.display(),
            drive.display()
        ))
    })?;
    output.print(&Flashed {
        file: checked.file.display().to_string(),
        board: checked.board().map(board),
        version: checked.info.version,
        drive: drive.display().to_string(),
        bytes: checked.bytes.len(),
    });
    Ok(())
}

fn is_a_drive(folder: &Path) -> Outcome {
    if drive::is_the_drive(folder) {
        return Ok(());
    }
    Err(Failure::BadInput(format!(
        "{} is no drive of an RP2040's boot loader: it has no INFO_UF2.TXT that says so; was the board brought there (BOOTSEL, or REC to GND, while it is plugged in)?",
        folder.display()
    )))
}

impl Checked {
    fn read(file: &Path) -> Outcome<Self> {
        let bytes = std::fs::read(file).map_err(|error| {
            Failure::BadInput(format!(
                "reading {}: {error}; `cargo xtask firmware` builds the images into {IMAGES}",
                file.display()
            ))
        })?;
        let info = FlashMemory::from_uf2(&bytes)
            .map_err(|problem| Failure::BadInput(format!("{}: {problem}", file.display())))?
            .binary_info();
        if info.program.as_deref() != Some("swimmer") {
            return Err(Failure::BadInput(format!(
                "{} is no firmware of this robot ({info}); `cargo xtask firmware` builds it into {IMAGES}",
                file.display()
            )));
        }
        Ok(Self {
            file: file.to_owned(),
            bytes,
            info,
        })
    }

    /// Returns the board that it was built for, or `None` if it names none that this robot may have.
    fn board(&self) -> Option<Board> {
        match self.info.board.as_deref()? {
            "pico" => Some(Board::Pico),
            "arduino_nano_rp2040_connect" => Some(Board::NanoRp2040Connect),
            _ => None,
        }
    }
}

/// Asks the robot into its boot loader, with an image for its board at hand.
fn into_the_boot_loader(access: &Access, named: Option<Checked>) -> Outcome<Checked> {
    let mut line = access.connect("swimmer robot flash", Pace::AsFastAsPossible)?;
    let of_robot = line.robot.info().board;
    let checked = match named {
        Some(checked) => checked,
        None => Checked::read(&built_for(of_robot)?)?,
    };
    if checked.board() != Some(of_robot) {
        return Err(Failure::BadInput(format!(
            "{} is for another board ({}) than this robot's, a {}; its pins would not fit",
            checked.file.display(),
            checked.info,
            board(of_robot)
        )));
    }
    let status = line.robot.status()?;
    if status.state != StateName::Stopped {
        return Err(Failure::Tried(format!(
            "the robot is {}, and keeps its firmware: stop it first (`swimmer robot stop`)",
            state(status.state)
        )));
    }
    line.robot.enter_boot_loader()?;
    aside("The robot has left for its boot loader.");
    // Its port is gone with it.
    let _ = line.close();
    Ok(checked)
}

/// The image of this checkout for a board.
fn built_for(robot: Board) -> Outcome<PathBuf> {
    let name = match robot {
        Board::Pico => "pico",
        Board::NanoRp2040Connect => "nano-connect",
        Board::Twin => {
            return Err(Failure::BadInput(
                "a twin has no board to flash; `--port` names the robot's USB cable or Bluetooth port"
                    .to_owned(),
            ));
        }
    };
    let here = std::env::current_dir().unwrap_or_default();
    let file = format!("swimmer-{name}.uf2");
    here.ancestors()
        .map(|folder| folder.join(IMAGES).join(&file))
        .find(|file| file.is_file())
        .ok_or_else(|| {
            Failure::BadInput(format!(
                "there is no {IMAGES}/{file} here; build it with `cargo xtask firmware`, or name an image"
            ))
        })
}
