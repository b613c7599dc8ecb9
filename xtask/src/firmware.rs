//! Build of the firmware of a board: the ELF file for a debug probe and the UF2 file for the USB boot drive.

use std::process::Command;

use firmware_image::{BinaryInfo, Flash};

use crate::disk::{make_folder, read_bytes, write};
use crate::failure::{Failure, Outcome};
use crate::image::Image;
use crate::run::{command, run, target_folder, works};
use crate::toolchain::{Target, Toolchain};

/// Variable that `firmware/src/battery.rs` reads.
const DIVIDER: &str = "SWIMMER_BATTERY_DIVIDER_MILLI";

/// Board of `firmware/src/board.rs`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Board {
    /// Arduino Nano RP2040 Connect.
    NanoConnect,
    /// Raspberry Pi Pico.
    Pico,
}

impl Board {
    /// All boards.
    pub(crate) const ALL: [Self; 2] = [Self::NanoConnect, Self::Pico];

    /// Cargo feature of the firmware.
    fn feature(self) -> &'static str {
        match self {
            Self::NanoConnect => "nano-connect",
            Self::Pico => "pico",
        }
    }
}

/// Variant of the firmware image.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Variant {
    pub(crate) board: Board,
    /// Ratio of the pack's voltage to the pin's in thousandths; `None` if no divider is soldered.
    pub(crate) battery_divider_milli: Option<u32>,
}

impl Variant {
    /// Images that the tests boot: both boards, and the Nano with a divider for tests of a low battery.
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

    /// Adds the arguments and variables of the variant to a cargo command.
    fn select(self, cargo: &mut Command) -> &mut Command {
        cargo.args(["-p", "firmware", "--no-default-features"]);
        cargo.args(["--features", self.board.feature()]);
        match self.battery_divider_milli {
            Some(milli) => cargo.env(DIVIDER, milli.to_string()),
            None => cargo.env_remove(DIVIDER),
        }
    }

    pub(crate) fn name(self) -> String {
        let board = self.board.feature();
        match self.battery_divider_milli {
            Some(milli) => format!("{board}-divider-{milli}"),
            None => board.to_owned(),
        }
    }
}

/// Builds an image, checks its size, and writes `swimmer-NAME.elf` and `.uf2` to `target/firmware-images`.
///
/// # Errors
/// The build fails, or the image exceeds its limits of flash or RAM.
pub(crate) fn build(toolchain: &Toolchain, variant: Variant) -> Outcome {
    run(
        variant.select(&mut toolchain.cargo("build")),
        "fix what the compiler reports above",
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

/// Refuses incomplete binary information, which results if the linker script drops its section.
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

/// Builds the firmware, flashes a board through a debug probe, and shows its log.
///
/// # Errors
/// probe-rs is missing or finds no probe, or the build fails.
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

    /// The pins in the code, in the README's table and in the picture agree.
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
