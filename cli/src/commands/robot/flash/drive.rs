//! Drive of the chip's boot loader: its location, its detection, and the copy of an image onto it.

use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;

/// File on the drive of every UF2 boot loader.
const NOTE: &str = "INFO_UF2.TXT";
/// The RP2040's says this.
const CHIP: &str = "Board-ID: RPI-RP2";
const LOOK_AGAIN: Duration = Duration::from_millis(200);

/// `true` if a folder is the drive of an RP2040 in its boot loader.
pub(super) fn is_the_drive(folder: &Path) -> bool {
    fs::read_to_string(folder.join(NOTE)).is_ok_and(|note| note.contains(CHIP))
}

/// The drives that there are now.
pub(super) fn drives() -> Vec<PathBuf> {
    let mut drives: Vec<PathBuf> = candidates()
        .into_iter()
        .filter(|folder| is_the_drive(folder))
        .collect();
    drives.sort();
    drives.dedup();
    drives
}

/// Folders where a system may have put it.
#[cfg(windows)]
fn candidates() -> Vec<PathBuf> {
    (b'A'..=b'Z')
        .map(|letter| PathBuf::from(format!("{}:\\", char::from(letter))))
        .collect()
}

/// Folders where a system may have put it.
#[cfg(not(windows))]
fn candidates() -> Vec<PathBuf> {
    // Linux names every mounted drive; a blank in its name is written as a number.
    let mounts = fs::read_to_string("/proc/mounts").unwrap_or_default();
    let mounted = mounts.lines().filter_map(|line| {
        let place = line.split(' ').nth(1)?;
        Some(PathBuf::from(place.replace("\\040", " ")))
    });
    let volumes = fs::read_dir("/Volumes").into_iter().flatten().flatten();
    mounted
        .chain(volumes.map(|volume| volume.path()))
        .filter(|place| {
            place.starts_with("/media")
                || place.starts_with("/run/media")
                || place.starts_with("/mnt")
                || place.starts_with("/Volumes")
        })
        .collect()
}

/// The one drive, waited for until `patience` is over.
///
/// # Errors
/// [`Failure::Tried`] where none comes or there are several.
pub(super) fn wait(patience: Duration, interrupt: &Interrupt) -> Outcome<PathBuf> {
    let begun = Instant::now();
    loop {
        let mut drives = drives();
        if drives.len() > 1 {
            let names: Vec<String> = drives
                .iter()
                .map(|drive| format!("\n  {}", drive.display()))
                .collect();
            return Err(Failure::Tried(format!(
                "{} boards are in their boot loader; say which with --drive:{}",
                drives.len(),
                names.concat()
            )));
        }
        if let Some(drive) = drives.pop() {
            return Ok(drive);
        }
        if begun.elapsed() >= patience || interrupt.requested() {
            return Err(Failure::Tried(
                "no drive RPI-RP2 with an INFO_UF2.TXT came up: is the board's USB cable in, one that carries data? Where the system mounts no drives by itself, mount it and name it with --drive"
                    .to_owned(),
            ));
        }
        std::thread::sleep(LOOK_AGAIN);
    }
}

/// Copies an image onto the drive. A board that restarts the moment it has everything takes its drive away; that is no
/// failure.
///
/// # Errors
/// The system's, before the last byte was handed over.
pub(super) fn copy(drive: &Path, name: &str, bytes: &[u8]) -> io::Result<()> {
    let mut file = File::create(drive.join(name))?;
    file.write_all(bytes)?;
    // From here on everything has been handed over, and the drive may be gone.
    let _ = file.sync_all();
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_is_known_by_its_note() {
        let folder = tempfile::tempdir().unwrap();
        assert!(!is_the_drive(folder.path()));
        for (note, is) in [
            (
                "UF2 Bootloader v3.0\r\nModel: Raspberry Pi RP2\r\nBoard-ID: RPI-RP2\r\n",
                true,
            ),
            (
                "UF2 Bootloader v1.0\r\nModel: Raspberry Pi RP2350\r\nBoard-ID: RP2350\r\n",
                false,
            ),
        ] {
            fs::write(folder.path().join(NOTE), note).unwrap();
            assert_eq!(is_the_drive(folder.path()), is, "{note}");
        }
    }

    #[test]
    fn a_copy_is_the_whole_file() {
        let folder = tempfile::tempdir().unwrap();
        copy(folder.path(), "a.uf2", b"image").unwrap();
        assert_eq!(fs::read(folder.path().join("a.uf2")).unwrap(), b"image");
        assert!(copy(&folder.path().join("gone"), "a.uf2", b"image").is_err());
    }
}
