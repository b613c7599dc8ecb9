//! Builds the firmware of a board: the ELF file for a probe, the UF2 file for the USB boot drive.

use std::process::Command;

use firmware_image::{BinaryInfo, Flash};

use crate::disk::{make_folder, read_bytes, write};
use crate::failure::{Failure, Outcome};
use crate::image::Image;
use crate::run::{command, run, target_folder, works};
use crate::toolchain::{Target, Toolchain};

/// Read by `firmware/src/battery.rs`.
const DIVIDER: &str = "SWIMMER_BATTERY_DIVIDER_MILLI";

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
}

/// One image that can be built.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Variant {
    pub(crate) board: Board,
    /// How many times the pack's voltage is above the pin's, in thousandths; none: no divider is soldered.
    pub(crate) battery_divider_milli: Option<u32>,
}

impl Variant {
    /// What the tests boot: both boards as they are, and the Nano with a divider, so that its battery can be low.
    pub(crate) const TESTED: [Self; 3] = [
        Self {
            board: Board::NanoConnect,
            battery_divider_milli: Some(4700),
        },
        Self::plain(Board::NanoConnect),
        Self::plain(Board::Pico),
    ];

    pub(crate) const fn plain(board: Board) -> Self {
        Self {
            board,
            battery_divider_milli: None,
        }
    }

    /// Chooses it on a cargo command line.
    fn select(self, cargo: &mut Command) -> &mut Command {
        cargo.args(["-p", "firmware", "--no-default-features"]);
        cargo.args(["--features", self.board.feature()]);
        match self.battery_divider_milli {
            Some(milli) => cargo.env(DIVIDER, milli.to_string()),
            None => cargo.env_remove(DIVIDER),
        }
    }

    fn name(self) -> String {
        let board = self.board.feature();
        match self.battery_divider_milli {
            Some(milli) => format!("{board}-divider-{milli}"),
            None => board.to_owned(),
        }
    }
}

/// Builds one image, weighs it, and leaves `swimmer-NAME.elf` and `.uf2` in `target/firmware-images`.
///
/// # Errors
/// When the build fails or the image takes more flash or RAM than promised.
pub(crate) fn build(toolchain: &Toolchain, variant: Variant) -> Outcome {
    run(
        variant.select(&mut toolchain.cargo("build")),
        "mend what the compiler names above",
    )?;
    let target = target_folder()?;
    let elf = target.join(Target::Chip.triple()).join("firmware/firmware");
    let bytes = read_bytes(&elf)?;
    let image = Image::from_elf(&bytes)?;
    let flash = Flash::from_segments(image.flash);
    let info = complete(flash.binary_info())?;
    let images = target.join("firmware-images");
    make_folder(&images)?;
    let name = format!("swimmer-{}", variant.name());
    for (ending, content) in [("elf", &bytes), ("uf2", &flash.to_uf2())] {
        let path = images.join(&name).with_extension(ending);
        write(&path, content)?;
        println!("{}", path.display());
    }
    println!("{}: {info}", variant.name());
    println!("{}: {}", variant.name(), image.footprint);
    image.footprint.check()
}

/// Refuses binary information that lacks a string, as an image has if the linker script drops the section.
fn complete(info: BinaryInfo) -> Outcome<BinaryInfo> {
    if info.program.is_some() && info.version.is_some() && info.board.is_some() {
        return Ok(info);
    }
    Err(Failure::new(
        "reading the firmware's binary info",
        format!("it is not complete where picotool looks: {info}"),
        "see that memory.x keeps .boot_info and .bi_entries, which firmware/src/binary_info.rs fills",
    ))
}

/// Builds and flashes one board through a debug probe, then shows its log.
///
/// # Errors
/// When probe-rs is missing, finds no probe, or the build fails.
pub(crate) fn flash(toolchain: &Toolchain, variant: Variant) -> Outcome {
    if !works(command("probe-rs").arg("--version")) {
        return Err(Failure::new(
            "looking for `probe-rs`",
            "it is not there",
            format!(
                "install it as https://probe.rs/docs/getting-started/installation says; or flash without a probe: \
                 `cargo xtask firmware --board {0}`, plug the board in with its BOOTSEL button held (Nano: REC \
                 joined to GND), and copy the .uf2 file that it names onto the drive RPI-RP2",
                variant.board.feature()
            ),
        ));
    }
    run(
        variant.select(&mut toolchain.cargo("run")),
        "check the probe's cable and `probe-rs list`",
    )
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    /// The pins are written in code, in the README's table and in the picture: all three say the same.
    #[test]
    fn the_picture_and_the_table_name_the_pins_of_the_code() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../firmware");
        let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
        let (code, table, picture) = (read("src/board.rs"), read("README.md"), read("wiring.svg"));
        // Field, the Nano's header pin, the GPIO that both boards take.
        for (field, header, gpio) in [
            ("link_tx", "D1", 0),
            ("link_rx", "D0", 1),
            ("servo_front", "D4", 16),
            ("servo_back", "D5", 17),
            ("presence", "D10", 5),
            ("battery", "A0", 26),
        ] {
            let declared = format!("{field}: Peri<'static, PIN_{gpio}>");
            assert!(code.contains(&declared), "{declared}");
            let row = format!("| {header} = GPIO{gpio} | GP{gpio} |");
            assert!(table.contains(&row), "{row}");
            assert!(picture.contains(&format!("= GPIO{gpio}</text>")), "{gpio}");
            assert!(picture.contains(&format!(">GP{gpio}, pin ")), "{gpio}");
        }
        // STATE and LED differ.
        assert!(code.contains("(p.PIN_25.into(), p.PIN_6.into())"));
        assert!(code.contains("(p.PIN_22.into(), p.PIN_25.into())"));
        assert!(table.contains("| D2 = GPIO25 | GP22 |") && table.contains("| GPIO6 | GP25 |"));
        assert!(picture.contains("D2 = GPIO25</text>") && picture.contains(">GP22, pin "));
    }
}
