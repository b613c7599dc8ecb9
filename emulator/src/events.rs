//! What the emulated board tells of itself, in emulated time.

use std::collections::BTreeMap;
use std::time::Duration;

use serde::Deserialize;

use crate::log::{Chunk, LogLine};

/// One period of the servos' PWM slice, as its registers stood when the counter wrapped: exact, without the emulator's
/// rounding of edges.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Period {
    /// When it began, emulated ns.
    at: f64,
    /// Compare values of front and back servo.
    front: u32,
    back: u32,
    /// The counter runs from 0 to this.
    top: u32,
    /// Clock divider.
    divider: f64,
    /// System clock \[Hz\].
    clock: f64,
    /// Cycles that the core was awake since the period before, and of these in the control task.
    busy: u64,
    control: u64,
    /// And of these in the tick itself.
    tick: u64,
    /// Lines of flash that were not in its cache meanwhile; see [`Board::put_flash_behind_cache`](crate::Board::put_flash_behind_cache).
    pub misses: u64,
}

impl Period {
    /// When it began.
    pub fn at(&self) -> Duration {
        nanos(self.at)
    }

    /// Compare values of front and back servo: pulses in steps of the counter.
    pub fn compares(&self) -> [u32; 2] {
        [self.front, self.back]
    }

    /// Pulses of front and back servo \[µs\]; 0 for none.
    pub fn pulses_us(&self) -> [f64; 2] {
        [self.front, self.back].map(|compare| f64::from(compare) * self.step_us())
    }

    /// How long it is \[µs\].
    pub fn length_us(&self) -> f64 {
        f64::from(self.top + 1) * self.step_us()
    }

    /// How long the core was awake in the period before it \[ms at 125 MHz\].
    pub fn busy_ms(&self) -> f64 {
        self.busy as f64 / 125e3
    }

    /// How much of that the control task took: its tick and the bytes that came \[ms at 125 MHz\].
    pub fn control_ms(&self) -> f64 {
        self.control as f64 / 125e3
    }

    /// How much of that the tick took that ended in the period \[ms at 125 MHz\].
    pub fn tick_ms(&self) -> f64 {
        self.tick as f64 / 125e3
    }

    /// Whether both servos get pulses.
    pub fn powered(&self) -> bool {
        self.front > 0 && self.back > 0
    }

    fn step_us(&self) -> f64 {
        self.divider / self.clock * 1e6
    }
}

/// A servo pin went up or down.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Edge {
    at: f64,
    /// Which servo.
    pub pin: Servo,
    /// Up or down.
    pub high: bool,
}

impl Edge {
    /// When.
    pub fn at(&self) -> Duration {
        nanos(self.at)
    }
}

/// Which servo.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Servo {
    /// φ₁.
    Front,
    /// φ₂.
    Back,
}

/// The LED was switched.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Led {
    at: f64,
    /// On or off.
    pub on: bool,
}

impl Led {
    /// When.
    pub fn at(&self) -> Duration {
        nanos(self.at)
    }
}

/// The watchdog reset the chip.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Reset {
    at: f64,
    /// The watchdog's REASON register: 1 its timer ran out, 2 the firmware asked for it.
    pub reason: u32,
}

impl Reset {
    /// When.
    pub fn at(&self) -> Duration {
        nanos(self.at)
    }
}

/// Code changed by [`Board::patch`](crate::Board::patch) ran for the first time.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct PatchReached {
    at: f64,
}

impl PatchReached {
    /// When.
    pub fn at(&self) -> Duration {
        nanos(self.at)
    }
}

/// The power went.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct PowerCut {
    at: f64,
}

impl PowerCut {
    /// When.
    pub fn at(&self) -> Duration {
        nanos(self.at)
    }
}

/// The firmware handed the chip over to the loader in its boot ROM, which ends with
/// [`Board::boot_rom_reset`](crate::Board::boot_rom_reset).
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Loader {
    at: f64,
    /// Pins that show its activity, a bit each.
    pub activity_pins: u32,
    /// Interfaces it shall not have: 1 the drive, 2 picotool's.
    pub disabled_interfaces: u32,
}

impl Loader {
    /// When.
    pub fn at(&self) -> Duration {
        nanos(self.at)
    }
}

/// Everything since the last time it was taken.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
pub struct Events {
    /// The servos' periods.
    pub periods: Vec<Period>,
    /// Edges of the servos' pins.
    pub edges: Vec<Edge>,
    /// The LED.
    pub led: Vec<Led>,
    /// Resets by the watchdog.
    pub resets: Vec<Reset>,
    /// When the power was cut, as [`Board::cut_power_after`](crate::Board::cut_power_after) asked.
    pub power_cuts: Vec<PowerCut>,
    /// When the chip was handed over to its loader.
    pub loader: Vec<Loader>,
    /// When patched code first ran.
    pub patch_reached: Vec<PatchReached>,
    /// Sectors of flash erased.
    pub erased: u32,
    /// Pages of flash programmed.
    pub programmed: u32,
    /// Bytes that the board was too busy to take from its UART, since it was switched on.
    pub lost: u64,
    /// What the emulator had to say, and how often.
    pub warnings: BTreeMap<String, u32>,
    /// The firmware's log.
    #[serde(skip)]
    pub log: Vec<LogLine>,
}

impl Events {
    /// Adds those of a later time.
    pub fn append(&mut self, later: Self) {
        self.periods.extend(later.periods);
        self.edges.extend(later.edges);
        self.led.extend(later.led);
        self.resets.extend(later.resets);
        self.power_cuts.extend(later.power_cuts);
        self.loader.extend(later.loader);
        self.patch_reached.extend(later.patch_reached);
        self.erased += later.erased;
        self.programmed += later.programmed;
        self.lost = later.lost;
        self.log.extend(later.log);
        for (warning, count) in later.warnings {
            *self.warnings.entry(warning).or_default() += count;
        }
    }
}

/// The firmware's stack.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub struct Stack {
    /// Bytes never written since the power came on.
    pub left: u32,
    /// Bytes there are.
    pub size: u32,
}

impl Stack {
    /// Most bytes that were in use, but for what was reserved and never written.
    pub fn used(&self) -> u32 {
        self.size - self.left
    }
}

/// The board's answer to a command.
#[derive(Debug, Deserialize)]
pub(crate) struct Answer {
    pub(crate) now: f64,
    pub(crate) powered: bool,
    pub(crate) uart: Vec<u8>,
    pub(crate) uart_at: Vec<f64>,
    pub(crate) usb: Vec<u8>,
    pub(crate) usb_at: Vec<f64>,
    pub(crate) log: Vec<Chunk>,
    #[serde(flatten)]
    pub(crate) events: Events,
    #[serde(default)]
    pub(crate) bytes: Vec<u8>,
    #[serde(default)]
    pub(crate) stack: Stack,
    #[serde(default)]
    pub(crate) symbols: BTreeMap<String, u32>,
}

/// Emulated time of a whole number of nanoseconds or nearly so, never negative.
pub(crate) fn nanos(at: f64) -> Duration {
    Duration::from_secs_f64(at.max(0.0) * 1e-9)
}
