//! A new firmware onto a board, with a folder that stands for the boot loader's drive. Most images here are put together by the
//! formats' own descriptions.

use std::path::{Path, PathBuf};

use emulator::{BoardConfig, BoardKind};

use crate::binary::{Ran, swimmer_in};

const NOTE: &str = "UF2 Bootloader v3.0\r\nModel: Raspberry Pi RP2\r\nBoard-ID: RPI-RP2\r\n";

fn flash(folder: &Path, words: &[&str]) -> Ran {
    swimmer_in(folder, &[&["robot", "flash"], words].concat())
}

/// Blocks of one page, of a program that names a board.
fn image(board: &str) -> Vec<u8> {
    const FLASH: u32 = 0x1000_0000;
    let mut page = vec![0_u8; 256];
    let mut put = |at: usize, words: &[u32]| {
        for (place, word) in words.iter().enumerate() {
            page[at + 4 * place..][..4].copy_from_slice(&word.to_le_bytes());
        }
    };
    // Head, two addresses of entries, two entries: a text under the number of the program's name, and of its board.
    put(0, &[0x7188_EBF2, FLASH + 20, FLASH + 28, 0, 0xE71A_A390]);
    put(20, &[FLASH + 32, FLASH + 48]);
    put(32, &[0x5052_0006, 0x0203_1C86, FLASH + 64]);
    put(48, &[0x5052_0006, 0xB63C_FFBB, FLASH + 96]);
    page[64..71].copy_from_slice(b"swimmer");
    page[96..96 + board.len()].copy_from_slice(board.as_bytes());
    let mut block = vec![0; 512];
    let head = [
        0x0A32_4655,
        0x9E5D_5157,
        0x2000,
        FLASH,
        256,
        0,
        1,
        0xE48B_FF56_u32,
    ];
    for (place, word) in head.iter().enumerate() {
        block[4 * place..][..4].copy_from_slice(&word.to_le_bytes());
    }
    block[32..288].copy_from_slice(&page);
    block[508..].copy_from_slice(&0x0AB1_6F30_u32.to_le_bytes());
    block
}

#[test]
fn an_image_is_copied_onto_the_drive_of_the_boot_loader_and_nothing_else_is() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let drive = folder.join("RPI-RP2");
    std::fs::create_dir(&drive).unwrap();
    std::fs::write(folder.join("pico.uf2"), image("pico")).unwrap();
    let by_hand = ["pico.uf2", "--by-hand", "--drive", "RPI-RP2"];
    // A drive of something else is left alone.
    let refused = flash(folder, &by_hand).with_status(2);
    assert!(refused.stderr.contains("INFO_UF2.TXT"), "{refused}");
    assert_eq!(std::fs::read_dir(&drive).unwrap().count(), 0);

    std::fs::write(drive.join("INFO_UF2.TXT"), NOTE).unwrap();
    let flashed = flash(folder, &[&by_hand[..], &["--json"]].concat()).with_status(0);
    assert_eq!(flashed.json()["board"], "Raspberry Pi Pico", "{flashed}");
    let copied = std::fs::read(drive.join("pico.uf2")).unwrap();
    assert_eq!(copied, image("pico"));

    for (content, words) in [
        (b"no image".to_vec(), "no UF2 file"),
        (image("pico")[..256].to_vec(), "no UF2 file"),
    ] {
        std::fs::write(folder.join("pico.uf2"), content).unwrap();
        let refused = flash(folder, &by_hand).with_status(2);
        assert!(refused.stderr.contains(words), "{refused}");
    }
}

#[test]
fn a_robot_is_flashed_with_an_image_for_its_own_board_only() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let none = flash(folder, &["--port", "twin"]).with_status(2);
    assert!(none.stderr.contains("a twin has no board"), "{none}");
    std::fs::write(folder.join("pico.uf2"), image("pico")).unwrap();
    let refused = flash(folder, &["pico.uf2", "--port", "twin"]).with_status(2);
    assert!(refused.stderr.contains("for another board"), "{refused}");
}

/// The images that `cargo xtask firmware` built: each names its board, its version and its commit.
#[test]
fn the_images_of_this_checkout_name_their_boards() {
    let target = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    let drive = tempfile::tempdir().unwrap();
    std::fs::write(drive.path().join("INFO_UF2.TXT"), NOTE).unwrap();
    for (kind, board) in [
        (BoardKind::Pico, "Raspberry Pi Pico"),
        (BoardKind::NanoConnect, "Arduino Nano RP2040 Connect"),
    ] {
        let here = Path::new(env!("CARGO_MANIFEST_DIR"));
        let config = BoardConfig::of_checkout(here, target.as_deref(), kind);
        let file = config.firmware.with_extension("uf2");
        assert!(
            file.is_file(),
            "{} is not there: build it with `cargo xtask firmware`",
            file.display()
        );
        let words = [
            file.to_str().unwrap(),
            "--by-hand",
            "--drive",
            drive.path().to_str().unwrap(),
            "--json",
        ];
        let flashed = flash(drive.path(), &words).with_status(0).json();
        assert_eq!(flashed["board"], board, "{flashed:#}");
        let version = flashed["version"].as_str().unwrap();
        assert!(version.contains("commit"), "{flashed:#}");
    }
}
