//! Builds the firmware of a board: the ELF file for a probe, the UF2 file for the USB boot drive.

use std::process::Command;

use crate::disk::{make_folder, read_bytes, write};
use crate::failure::{Failure, Outcome};
use crate::image::Image;
use crate::run::{command, run, target_folder, works};
use crate::toolchain::{ChipToolchain, TARGET};
use crate::uf2;

/// The boards of `firmware/src/board.rs`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Board {
    /// Arduino Nano RP2040 Connect.
    NanoConnect,
    /// Raspberry Pi Pico.
    Pico,
}

impl Board {
    /// Every board.
    pub(crate) const ALL: [Self; 2] = [Self::NanoConnect, Self::Pico];

    /// The firmware's cargo feature.
    fn feature(self) -> &'static str {
        match self {
            Self::NanoConnect => "nano-connect",
            Self::Pico => "pico",
        }
    }

    /// Chooses the board on a cargo command line.
    pub(crate) fn select(self, cargo: &mut Command) -> &mut Command {
        cargo.args([
            "-p",
            "firmware",
            "--no-default-features",
            "--features",
            self.feature(),
        ])
    }
}

/// Builds one board's image, weighs it, and leaves `firmware-BOARD.elf` and `.uf2` in `target/firmware-images`.
///
/// # Errors
/// When the build fails or the image takes more flash or RAM than promised.
pub(crate) fn build(toolchain: &ChipToolchain, board: Board) -> Outcome {
    run(
        board.select(&mut toolchain.cargo("build")),
        "mend what the compiler names above",
    )?;
    let target = target_folder()?;
    let elf = target.join(TARGET).join("firmware/firmware");
    let bytes = read_bytes(&elf)?;
    let image = Image::from_elf(&bytes)?;
    let images = target.join("firmware-images");
    make_folder(&images)?;
    let name = format!("firmware-{}", board.feature());
    for (ending, content) in [("elf", &bytes), ("uf2", &uf2::from_segments(image.flash))] {
        let path = images.join(&name).with_extension(ending);
        write(&path, content)?;
        println!("{}", path.display());
    }
    println!("{}: {}", board.feature(), image.footprint);
    image.footprint.check()
}

/// Builds and flashes one board through a debug probe, then shows its log.
///
/// # Errors
/// When probe-rs is missing, finds no probe, or the build fails.
pub(crate) fn flash(toolchain: &ChipToolchain, board: Board) -> Outcome {
    if !works(command("probe-rs").arg("--version")) {
        return Err(Failure::new(
            "looking for `probe-rs`",
            "it is not there",
            format!(
                "install it as https://probe.rs/docs/getting-started/installation says; or flash without a probe: \
                 `cargo xtask firmware --board {0}`, plug the board in with its BOOTSEL button held (Nano: press reset \
                 twice), and copy target/firmware-images/firmware-{0}.uf2 onto the drive RPI-RP2",
                board.feature()
            ),
        ));
    }
    run(
        board.select(&mut toolchain.cargo("run")),
        "check the probe's cable and `probe-rs list`",
    )
}
