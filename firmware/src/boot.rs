//! What the brain is told at the start: who it is and how it came up.

use embassy_rp::clocks::RoscRng;
use embassy_rp::pac::VREG_AND_CHIP_RESET;
use embassy_rp::watchdog::ResetReason as WatchdogReset;
use gait_player::{Boot, BrainConfig, Identity};
use link_protocol::{Board, FirmwareVersion, ResetReason};

use crate::survivors;
use crate::uart::RECEIVE_BUFFER;
use crate::watchdog::Watchdog;

/// Everything [`gait_player::Brain::new`] asks for.
pub(crate) fn brain_config(watchdog: &mut Watchdog) -> BrainConfig {
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
        ..BrainConfig::robot(identity, boot(watchdog))
    }
}

const VERSION: FirmwareVersion = FirmwareVersion {
    major: digits(env!("CARGO_PKG_VERSION_MAJOR")),
    minor: digits(env!("CARGO_PKG_VERSION_MINOR")),
    patch: digits(env!("CARGO_PKG_VERSION_PATCH")),
    commit: commit(env!("SWIMMER_COMMIT")),
};

fn boot(watchdog: &mut Watchdog) -> Boot {
    let reset_reason = match watchdog.reset_reason() {
        Some(WatchdogReset::TimedOut) => ResetReason::Watchdog,
        Some(WatchdogReset::Forced) => ResetReason::Crash,
        None if VREG_AND_CHIP_RESET.chip_reset().read().had_run() => ResetReason::Pin,
        None => ResetReason::PowerOn,
    };
    let mut random = RoscRng;
    // The count tells starts apart even where the random bits do not. 256 sessions lie between two starts.
    let starts = watchdog.count_start();
    Boot {
        reset_reason,
        nonce: random.next_u32() ^ starts,
        session_seed: random.next_u32() as u16 ^ (starts as u16).rotate_left(8),
        // The scratch register is empty after the reset pin: an e-stop must outlive that too.
        kept: match watchdog.kept() {
            0 => survivors::kept(),
            word => word,
        },
        crash_message: survivors::take_note().message(),
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
