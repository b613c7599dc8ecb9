//! What the brain is told at the start: who it is, what this robot allows, and how it came up.

use embassy_rp::clocks::RoscRng;
use embassy_rp::pac::VREG_AND_CHIP_RESET;
use embassy_rp::watchdog::ResetReason as WatchdogReset;
use gait_player::servo::ServoMap;
use gait_player::{Boot, BrainConfig, Identity, Limits};
use link_protocol::{
    Board, Configuration, FirmwareVersion, ResetReason, ServoSettings, TangentialDrag,
};
use swimmer_model::Swimmer;

use crate::uart::RECEIVE_BUFFER;
use crate::watchdog::Watchdog;

/// Everything [`gait_player::Brain::new`] asks for.
pub(crate) fn brain_config(watchdog: &mut Watchdog) -> BrainConfig {
    BrainConfig {
        identity: Identity {
            firmware: VERSION,
            board: if cfg!(feature = "pico") {
                Board::Pico
            } else {
                Board::NanoRp2040Connect
            },
        },
        limits: Limits::ROBOT,
        configuration: configuration(),
        servos: [SERVO; 2],
        buffer: RECEIVE_BUFFER as u16,
        boot: boot(watchdog),
    }
}

const VERSION: FirmwareVersion = FirmwareVersion {
    major: digits(env!("CARGO_PKG_VERSION_MAJOR")),
    minor: digits(env!("CARGO_PKG_VERSION_MINOR")),
    patch: digits(env!("CARGO_PKG_VERSION_PATCH")),
    commit: commit(env!("SWIMMER_COMMIT")),
};

/// The servos as built, until others are set.
const SERVO: ServoSettings = ServoSettings {
    centre_ns: ServoMap::ROBOT.centre_ns,
    slope_rad_per_us: ServoMap::ROBOT.slope_rad_per_us,
    reversed: ServoMap::ROBOT.reversed,
    trim: 0,
};

/// The swimmer as built, until another is set.
fn configuration() -> Configuration {
    let swimmer: Swimmer<f32> = Swimmer::robot();
    Configuration {
        middle_m: swimmer.links.middle,
        front_m: swimmer.links.front,
        back_m: swimmer.links.back,
        chi: swimmer.chi,
        tangential_drag: match swimmer.tangential_drag {
            swimmer_model::TangentialDrag::LogAspect(value) => TangentialDrag::LogAspect(value),
            swimmer_model::TangentialDrag::HalfThickness(value) => {
                TangentialDrag::HalfThickness(value)
            }
            swimmer_model::TangentialDrag::OverViscosity(value) => {
                TangentialDrag::OverViscosity(value)
            }
        },
        sphere_radius_m: swimmer.sphere_radius,
        max_angle: Limits::ROBOT.max_angle,
        max_rate: Limits::ROBOT.max_rate,
    }
}

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
        kept: watchdog.kept(),
        crash_message: heapless::String::new(),
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
