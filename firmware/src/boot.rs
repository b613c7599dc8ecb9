//! Boot data for the brain: identity, cause of the start and retained state.

use embassy_rp::pac::VREG_AND_CHIP_RESET;
use embassy_rp::watchdog::ResetReason as WatchdogReset;
use gait_player::{Boot, BrainConfig, Identity};
use link_protocol::{Board, FirmwareVersion, ResetReason};

use crate::uart::RECEIVE_BUFFER;
use crate::watchdog::Watchdog;
use crate::{random, retained_ram};

/// Configuration for [`gait_player::Brain::new`].
pub(crate) fn brain_config(watchdog: &mut Watchdog, whole_chip: bool) -> BrainConfig {
    let identity = Identity {
        firmware: VERSION,
        board: if cfg!(feature = "pico") {
            Board::Pico
        } else {
            Board::NanoRp2040Connect
        },
    };
    BrainConfig {
        buffer: RECEIVE_BUFFER as u16,
        ..BrainConfig::robot(identity, boot(watchdog, whole_chip))
    }
}

const VERSION: FirmwareVersion = FirmwareVersion {
    major: digits(env!("CARGO_PKG_VERSION_MAJOR")),
    minor: digits(env!("CARGO_PKG_VERSION_MINOR")),
    patch: digits(env!("CARGO_PKG_VERSION_PATCH")),
    commit: commit(env!("SWIMMER_COMMIT")),
};

/// Cause of the start. A watchdog reset that is not ours, or is outdated, counts as the reset pin: no fault, and the RAM is
/// intact.
fn reset_reason(watchdog: &Watchdog, whole_chip: bool) -> ResetReason {
    let had_run = || VREG_AND_CHIP_RESET.chip_reset().read().had_run();
    match watchdog.reset_reason() {
        Some(reason) if whole_chip && watchdog.was_armed_by_us() => match reason {
            WatchdogReset::TimedOut => ResetReason::Watchdog,
            WatchdogReset::Forced => ResetReason::Crash,
        },
        None if whole_chip && !had_run() => ResetReason::PowerOn,
        _ => ResetReason::Pin,
    }
}

fn boot(watchdog: &mut Watchdog, whole_chip: bool) -> Boot {
    let random = random::bits_of_start(watchdog.count_start());
    Boot {
        reset_reason: reset_reason(watchdog, whole_chip),
        nonce: random as u32,
        session_seed: (random >> 32) as u16,
        // The reset pin clears the scratch register, but an e-stop must survive it.
        kept: match watchdog.kept() {
            0 => retained_ram::kept(),
            word => word,
        },
        crash_message: retained_ram::take_note().message(),
        starts: retained_ram::starts(),
    }
}

const fn digits(text: &str) -> u8 {
    match u8::from_str_radix(text, 10) {
        Ok(number) => number,
        Err(_) => panic!("the version has a part above 255"),
    }
}

const fn commit(text: &str) -> [u8; 8] {
    match text.as_bytes().first_chunk() {
        Some(digits) => *digits,
        None => *b"00000000",
    }
}
