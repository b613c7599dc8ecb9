//! Paths of the emulator's files within a checkout of the sources.

use std::path::{Path, PathBuf};

use crate::{BoardConfig, BoardKind};

/// Folder of the scripts in a checkout.
const SCRIPTS: &str = "emulator/board";
/// Folder of the firmware images in cargo's target folder, written by `cargo xtask firmware`.
const IMAGES: &str = "firmware-images";

impl BoardConfig {
    /// Returns the configuration for the checkout that contains `place`, or for `place` itself if no checkout contains it. The
    /// scripts are in `emulator/board`, the firmware is in `firmware-images` of `target` or of the checkout's `target` folder.
    /// [`missing`](Self::missing) checks that the files exist.
    pub fn of_checkout(place: &Path, target: Option<&Path>, kind: BoardKind) -> Self {
        let root = place
            .ancestors()
            .find(|folder| folder.join(SCRIPTS).join("serve.mjs").is_file())
            .unwrap_or(place);
        let target = target.map_or_else(|| root.join("target"), PathBuf::from);
        Self {
            scripts: root.join(SCRIPTS),
            firmware: target
                .join(IMAGES)
                .join(format!("swimmer-{}.elf", kind.word())),
            kind,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_deep_in_a_checkout_finds_the_scripts() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let deep = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let config = BoardConfig::of_checkout(&deep, None, BoardKind::Pico);
        assert_eq!(config.scripts, root.join("emulator/board"));
        assert_eq!(
            config.firmware,
            root.join("target/firmware-images/swimmer-pico.elf")
        );
    }

    #[test]
    fn outside_a_checkout_the_scripts_are_missing() {
        let place = std::env::temp_dir();
        let config = BoardConfig::of_checkout(&place, Some(&place), BoardKind::NanoConnect);
        assert_eq!(
            config.firmware,
            place.join("firmware-images/swimmer-nano-connect.elf")
        );
        assert!(config.missing().is_some());
    }
}
