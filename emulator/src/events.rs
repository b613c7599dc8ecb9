//! Events of the emulated board, stamped with emulated time.

use std::collections::BTreeMap;
use std::time::Duration;

use serde::Deserialize;

use crate::log::{Chunk, LogLine};

/// One period of the servos' PWM slice, from its registers at the wrap of the counter. Exact, unlike the pin edges, which the
/// emulator rounds.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Period {
    /// Start \[emulated ns\].
    at: f64,
    /// Compare values of front and back servo.
    front: u32,
    back: u32,
    /// Highest count.
    top: u32,
    /// Clock divider.
    divider: f64,
    /// System clock \[Hz\].
    clock: f64,
    /// Cycles for which the core was awake in the previous period; the next field counts those in the control task.
    busy: u64,
    control: u64,
    /// Cycles of the control task that were spent in the tick.
    tick: u64,
    /// Number of flash cache misses; see [`Board::put_flash_behind_cache`](crate::Board::put_flash_behind_cache).
    pub misses: u64,
}

impl Period {
    /// Start of the period.
    pub fn at(&self) -> Duration {
        nanos(self.at)
    }

    /// Compare values of front and back servo: pulses in steps of the counter.
    pub fn compares(&self) -> [u32; 2] {
        [self.front, self.back]
    }

    /// Pulses of front and back servo \[µs\]; 0 if they are off.
    pub fn pulses_us(&self) -> [f64; 2] {
        [self.front, self.back].map(|compare| f64::from(compare) * self.step_us())
    }

    /// Length of the period \[µs\].
    pub fn length_us(&self) -> f64 {
        f64::from(self.top + 1) * self.step_us()
    }

    /// Time for which the core was awake in the previous period \[ms at 125 MHz\].
    pub fn busy_ms(&self) -> f64 {
        self.busy as f64 / 125e3
    }

    /// Part of it that the control task took, for its tick and for received bytes \[ms at 125 MHz\].
    pub fn control_ms(&self) -> f64 {
        self.control as f64 / 125e3
    }

    /// Part of it that the tick took which ended in the period \[ms at 125 MHz\].
    pub fn tick_ms(&self) -> f64 {
        self.tick as f64 / 125e3
    }

    /// Returns `true` if a servo receives pulses.
    pub fn powered(&self) -> bool {
        self.front > 0 || self.back > 0
    }

    fn step_us(&self) -> f64 {
        self.divider / self.clock * 1e6
    }
}

/// Edge of a servo pin.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Edge {
    at: f64,
    /// Servo of the pin.
    pub pin: Servo,
    /// `true` for a rising edge.
    pub high: bool,
}

impl Edge {
    /// Emulated time of the event.
    pub fn at(&self) -> Duration {
        nanos(self.at)
    }
}

/// Servo of the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Servo {
    /// φ₁.
    Front,
    /// φ₂.
    Back,
}

/// Change of the LED.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Led {
    at: f64,
    /// `true` if the LED is lit.
    pub on: bool,
}

impl Led {
    /// Emulated time of the event.
    pub fn at(&self) -> Duration {
        nanos(self.at)
    }
}

/// Reset of the chip by the watchdog.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Reset {
    at: f64,
    /// REASON register of the watchdog: 1 if its timer ran out, 2 if the firmware requested the reset.
    pub reason: u32,
}

impl Reset {
    /// Emulated time of the event.
    pub fn at(&self) -> Duration {
        nanos(self.at)
    }
}

/// First execution of code that [`Board::patch`](crate::Board::patch) changed.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct PatchReached {
    at: f64,
}

impl PatchReached {
    /// Emulated time of the event.
    pub fn at(&self) -> Duration {
        nanos(self.at)
    }
}

/// Loss of power.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct PowerCut {
    at: f64,
}

impl PowerCut {
    /// Emulated time of the event.
    pub fn at(&self) -> Duration {
        nanos(self.at)
    }
}

/// Entry into the loader of the boot ROM, which ends with [`Board::boot_rom_reset`](crate::Board::boot_rom_reset).
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Loader {
    at: f64,
    /// Pins that show its activity, one bit per pin.
    pub activity_pins: u32,
    /// Disabled interfaces: bit 0 the drive, bit 1 picotool's.
    pub disabled_interfaces: u32,
}

impl Loader {
    /// Emulated time of the event.
    pub fn at(&self) -> Duration {
        nanos(self.at)
    }
}

/// All events since the last call of `take_events`.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
pub struct Events {
    /// Periods of the servos.
    pub periods: Vec<Period>,
    /// Edges of the servo pins.
    pub edges: Vec<Edge>,
    /// Changes of the LED.
    pub led: Vec<Led>,
    /// Resets by the watchdog.
    pub resets: Vec<Reset>,
    /// Losses of power requested by [`Board::cut_power_after`](crate::Board::cut_power_after).
    pub power_cuts: Vec<PowerCut>,
    /// Entries into the loader.
    pub loader: Vec<Loader>,
    /// First executions of patched code.
    pub patch_reached: Vec<PatchReached>,
    /// Number of erased flash sectors.
    pub erased: u32,
    /// Number of programmed flash pages.
    pub programmed: u32,
    /// Bytes lost because the board did not read its UART in time, since power-on.
    pub lost: u64,
    /// Warnings of the emulator, with their counts.
    pub warnings: BTreeMap<String, u32>,
    /// Log of the firmware.
    #[serde(skip)]
    pub log: Vec<LogLine>,
}

impl Events {
    /// Appends later events.
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

/// Stack use of the firmware.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub struct Stack {
    /// Bytes never written since power-on.
    pub left: u32,
    /// Size of the stack in bytes.
    pub size: u32,
}

impl Stack {
    /// Greatest number of bytes in use. Reserved bytes that were never written do not count.
    pub fn used(&self) -> u32 {
        self.size - self.left
    }
}

/// Reply of the emulator process to a command.
#[derive(Debug, Deserialize)]
pub(crate) struct EmulatorReply {
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

/// Converts emulated nanoseconds to a duration, rounded to whole nanoseconds and clamped at zero.
pub(crate) fn nanos(at: f64) -> Duration {
    Duration::from_secs_f64(at.max(0.0) * 1e-9)
}
