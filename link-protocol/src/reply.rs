//! Replies of the robot to requests. Variants are only appended.

use crate::{
    Checked, Configuration, DecodeCounters, Flags, PulseRange, Refusal, ServoSettings, StateName,
    StopCause,
};
use heapless::String;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// The answer to a [`crate::Request`], under the same sequence number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[allow(clippy::large_enum_variant)] // no heap to box it
pub enum Reply {
    /// Done.
    Done,
    /// Not done, and why. Nothing changed.
    Refused(Refusal),
    /// Still at it (checking a table takes some seconds while pulses are on): this is no end. Keep waiting, or ask again with the same
    /// number; the last word comes under that number too.
    Working,
    /// Answer to [`crate::Request::Status`].
    Status(Status),
    /// Answer to [`crate::Request::Counters`].
    Counters(Counters),
    /// Answer to [`crate::Request::Configuration`].
    Configuration(Configuration),
    /// Answer to [`crate::Request::Servo`].
    Servo(ServoSettings),
    /// Answer to [`crate::Request::Begin`] and [`crate::Request::Chunk`].
    Wanted {
        /// Number of the upload: the sequence number of its Begin.
        upload: u16,
        /// The next offset the robot wants; the length of the table once all has come.
        offset: u16,
    },
    /// Answer to [`crate::Request::CrashMessage`]; empty where there is none.
    CrashMessage(String<96>),
    /// Answer to [`crate::Request::Table`] and, once the table has passed every check, to [`crate::Request::Commit`].
    Table(Option<TableInfo>),
    /// Answer to [`crate::Request::Bench`].
    Bench(BenchStatus),
    /// Answer to [`crate::Request::PulseRange`].
    PulseRange(PulseRange),
}

/// Presence, short starts and the configuration as built.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct BenchStatus {
    /// Seconds for which the bench window is still open; 0: it is closed.
    pub window_s: u16,
    /// This session came over the USB cable, which is presence for as long as it lasts.
    pub usb: bool,
    /// Starts in a row that each followed a run of under 60 s, this one included; 0 once this run has lasted for 60 s.
    pub short_starts: u8,
    /// The configuration as built: what presence is measured by.
    pub built: Configuration,
}

/// State of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Status {
    /// The robot's clock: µs since its start.
    pub robot_us: u64,
    /// State of the brain.
    pub state: StateName,
    /// Why it last stopped.
    pub cause: StopCause,
    /// What else holds.
    pub flags: Flags,
    /// Cycles done of the last play.
    pub cycle: u32,
    /// Cycles requested; 0 is without end.
    pub cycles: u32,
    /// Duration of a cycle, µs; 0 before the first play.
    pub period_us: u32,
    /// Fraction of the cycle done, in 2⁻¹⁶.
    pub phase: u16,
    /// Commanded angles φ₁, φ₂ in 1e-4 rad.
    pub setpoint: [i16; 2],
    /// Battery, mV; `None`: not measured.
    pub battery_mv: Option<u16>,
    /// The active table.
    pub table: Option<TableInfo>,
    /// Bytes held of the upload that is open; `None`: no upload is open.
    pub upload: Option<u16>,
    /// [`crate::settings_crc32`] of the settings in force.
    pub settings_crc32: u32,
    /// E-stops since the start; [`crate::Request::ClearEStop`] names this count.
    pub estops: u32,
}

impl Status {
    /// Table and settings that the robot holds, for a play of them; without a table its checksum is 0.
    pub fn held(&self) -> Checked {
        Checked {
            table_crc32: self.table.map_or(0, |table| table.crc32),
            settings_crc32: self.settings_crc32,
        }
    }
}

/// Names the active table by its evidence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct TableInfo {
    /// Number of knots.
    pub knots: u16,
    /// CRC-32C of its bytes.
    pub crc32: u32,
    /// Kept over a power cut already.
    pub stored: bool,
    /// Shortest period the present limits allow, µs.
    pub min_period_us: u32,
}

/// Counts of frames and requests since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Counters {
    /// The frame decoder's.
    pub frames: DecodeCounters,
    /// Requests that acted.
    pub acted: u32,
    /// Repeats that were answered by the stored reply.
    pub replayed: u32,
    /// Requests older than the last that acted.
    pub superseded: u32,
    /// Frames of another session.
    pub stale: u32,
    /// Requests that were refused.
    pub refused: u32,
    /// Frames that found no room on their way out.
    pub dropped: u32,
    /// Ticks that came more than one and a half periods after the one before.
    pub late_ticks: u32,
    /// Ticks in which the last check before the servos had to cut a pulse.
    pub clamped: u32,
}
