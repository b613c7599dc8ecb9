//! Replies of the robot to requests. Variants are only appended.

use crate::{
    Checked, Configuration, DecodeCounters, Flags, PulseRange, Refusal, ServoSettings, StateName,
    StopCause,
};
use heapless::String;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Reply to a [`crate::Request`], with the same sequence number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[allow(clippy::large_enum_variant)] // no heap to box it
pub enum Reply {
    /// The request was executed.
    Done,
    /// The request was refused, with its reason. Nothing changed.
    Refused(Refusal),
    /// Interim reply: the robot is still working (checking a table takes some seconds while pulses are on). Keep waiting, or
    /// repeat the request with the same number; the final reply has that number too.
    Working,
    /// Reply to [`crate::Request::Status`].
    Status(Status),
    /// Reply to [`crate::Request::Counters`].
    Counters(Counters),
    /// Reply to [`crate::Request::Configuration`].
    Configuration(Configuration),
    /// Reply to [`crate::Request::Servo`].
    Servo(ServoSettings),
    /// Reply to [`crate::Request::Begin`] and [`crate::Request::Chunk`].
    Wanted {
        /// Number of the upload: the sequence number of its Begin.
        upload: u16,
        /// Next expected offset; the length of the table if all bytes have arrived.
        offset: u16,
    },
    /// Reply to [`crate::Request::CrashMessage`]; empty if there is no message.
    CrashMessage(String<96>),
    /// Reply to [`crate::Request::Table`] and, after the table has passed every check, to [`crate::Request::Commit`].
    Table(Option<TableInfo>),
    /// Reply to [`crate::Request::Bench`].
    Bench(BenchStatus),
    /// Reply to [`crate::Request::PulseRange`].
    PulseRange(PulseRange),
}

/// Presence, short starts and the configuration as built.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct BenchStatus {
    /// Remaining time of the bench window, s; 0 if it is closed.
    pub window_s: u16,
    /// The session uses the USB cable, which counts as presence.
    pub usb: bool,
    /// Number of consecutive starts after runs of under 60 s, including this one; 0 after this run has lasted 60 s.
    pub short_starts: u8,
    /// Configuration as built: the reference for requests that require presence.
    pub built: Configuration,
}

/// State of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Status {
    /// The robot's clock: µs since its start.
    pub robot_us: u64,
    /// State of the brain.
    pub state: StateName,
    /// Cause of the last stop.
    pub cause: StopCause,
    /// Further facts, as bits.
    pub flags: Flags,
    /// Finished cycles of the last play.
    pub cycle: u32,
    /// Requested cycles; 0 is endless.
    pub cycles: u32,
    /// Duration of a cycle, µs; 0 before the first play.
    pub period_us: u32,
    /// Finished fraction of the cycle, in 2⁻¹⁶.
    pub phase: u16,
    /// Commanded angles φ₁, φ₂ in 1e-4 rad.
    pub setpoint: [i16; 2],
    /// Battery voltage, mV; `None` if it is not measured.
    pub battery_mv: Option<u16>,
    /// Active table.
    pub table: Option<TableInfo>,
    /// Received bytes of the open upload; `None` if no upload is open.
    pub upload: Option<u16>,
    /// [`crate::settings_crc32`] of the settings in force.
    pub settings_crc32: u32,
    /// E-stops since the start; [`crate::Request::ClearEStop`] names this count.
    pub estops: u32,
}

impl Status {
    /// Table and settings that the robot holds, to be named in a play. Without a table its checksum is 0.
    pub fn held(&self) -> Checked {
        Checked {
            table_crc32: self.table.map_or(0, |table| table.crc32),
            settings_crc32: self.settings_crc32,
        }
    }
}

/// Identity of the active table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct TableInfo {
    /// Number of knots.
    pub knots: u16,
    /// CRC-32C of its bytes.
    pub crc32: u32,
    /// The table is stored in flash.
    pub stored: bool,
    /// Shortest period within the present limits, µs.
    pub min_period_us: u32,
}

/// Counts of frames and requests since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Counters {
    /// Counts of the frame decoder.
    pub frames: DecodeCounters,
    /// Requests that acted.
    pub acted: u32,
    /// Repeats that got the stored reply.
    pub replayed: u32,
    /// Requests older than the last that acted.
    pub superseded: u32,
    /// Frames of another session.
    pub stale: u32,
    /// Requests that were refused.
    pub refused: u32,
    /// Frames dropped because the transmit buffer was full.
    pub dropped: u32,
    /// Ticks that came more than one and a half periods after the previous one.
    pub late_ticks: u32,
    /// Ticks in which the clamp changed a pulse.
    pub clamped: u32,
}
