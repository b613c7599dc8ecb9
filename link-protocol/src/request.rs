//! Requests of a host. Variants are only appended.

use crate::{Configuration, Joint, Key, MAX_CHUNK, PulseRange, RequestClass, ServoSettings};
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Request of a host; the sequence number of its frame matches the [`crate::Reply`] to it. All except [`Request::Chunk`] act in
/// increasing order of sequence number (modulo 2¹⁶, half range), each at most once. [`Request::Stop`] and [`Request::EStop`]
/// always act.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[allow(clippy::large_enum_variant)] // a chunk is a message like others, and there is no heap to box it
pub enum Request {
    /// Reads the status. Reply: [`crate::Reply::Status`].
    Status,
    /// Reads the counts of received, refused and dropped frames. Reply: [`crate::Reply::Counters`].
    Counters,
    /// Reads the configuration in force. Reply: [`crate::Reply::Configuration`].
    Configuration,
    /// Sets the configuration. Lengths more than a tenth from those as built, and limits beyond those as built, require
    /// presence.
    Configure(Configuration),
    /// Reads the settings of a servo. Reply: [`crate::Reply::Servo`].
    Servo(Joint),
    /// Sets the map of a servo. A change of `reversed`, and a map that moves a joint by more than 1° from where it was last set
    /// with presence, require presence.
    SetServo {
        /// Joint of the servo.
        joint: Joint,
        /// New map.
        settings: ServoSettings,
    },
    /// Sets a servo's trim, an angle in units of 1e-4 rad that is added to every set-point. Refused during a motion; saved when
    /// Stopped. More than 1° from where the joint was last set with presence requires presence.
    Trim {
        /// Joint of the servo.
        joint: Joint,
        /// Total trim (not a step), 1e-4 rad.
        trim: i16,
    },
    /// Opens an upload, or resumes the one of the same length and checksum. Reply: [`crate::Reply::Wanted`].
    Begin(Begin),
    /// Chunk of the table, accepted in any order of sequence numbers. Reply: [`crate::Reply::Wanted`].
    Chunk(Chunk),
    /// Checks the uploaded table and makes it active. The upload's number is that of its [`Request::Begin`].
    Commit {
        /// Sequence number of the upload's [`Request::Begin`].
        upload: u16,
    },
    /// Switches pulses on at the last commanded set-point (after a reset: neutral); the servo may jump to it. Clears no latch.
    Arm,
    /// Plays the active table, after a soft start.
    Play(Play),
    /// Pauses the play at its pose. Detached: also without a link, for at most 60 s in total; then the robot stops.
    Pause {
        /// Continue to hold without a link.
        detached: bool,
    },
    /// Resumes a play after [`Request::Pause`].
    Resume,
    /// Ramps to neutral, then switches the pulses off. Acts in every state, for any session and sequence number, in frames of
    /// any version.
    Stop,
    /// Switches the pulses off within one tick, latched. Acts under the same conditions as [`Request::Stop`].
    EStop,
    /// Clears the lock after three resets in 60 s, or three short starts, once the robot has been up for 60 s.
    ClearResets,
    /// Reads the message of the crash before the last start. Reply: [`crate::Reply::CrashMessage`].
    CrashMessage,
    /// Reads the identity of the active table. Reply: [`crate::Reply::Table`].
    Table,
    /// Sets, changes or removes the shared key and closes the session; greet again, with the new key. A robot with a key
    /// accepts it only if it is signed with that key; the first key requires presence. The new key crosses the wire
    /// unencrypted, so use a cable.
    SetKey(Option<Key>),
    /// Reads presence, short starts and the configuration as built. Reply: [`crate::Reply::Bench`].
    Bench,
    /// Reads the pulse range of a servo's end stops. Reply: [`crate::Reply::PulseRange`].
    PulseRange(Joint),
    /// Sets the pulse range of a servo. A range that is wider at either end than the one in force requires presence.
    SetPulseRange {
        /// Joint of the servo.
        joint: Joint,
        /// New range.
        range: PulseRange,
    },
    /// Clears a latched e-stop to Stopped, without arming.
    ClearEStop {
        /// [`crate::Status::estops`] as last read by the host; later e-stops are not cleared.
        count: u32,
    },
    /// Enters the chip's boot loader, which accepts new firmware over USB. The reply is sent first.
    EnterBootLoader,
    /// Checks an upload as [`Request::Commit`] does, and plays it without a pause after the last cycle of the present play (if
    /// that is endless: after the present cycle). Both tables start at the same knot. Reply: [`crate::Reply::Table`] once it is
    /// scheduled.
    Follow(Follow),
    /// Declares the joint that a spring holds in place of a servo: its output stays low from then on, whatever plays. `None`:
    /// both joints have servos. To drive a passive joint again requires presence. [`crate::Flags::passive`] reports the joint.
    SetPassive(Option<Joint>),
}

impl Request {
    /// Returns true for a request that ends motion and always acts.
    pub fn is_stop(&self) -> bool {
        self.class(|| true) == RequestClass::Stop
    }

    /// Returns true for a request that switches pulses on or changes the motion of a powered robot.
    pub fn is_powering(&self) -> bool {
        self.class(|| true) == RequestClass::Powering
    }
}

/// Announcement of an upload.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Begin {
    /// Slot of the gait; only 0 exists.
    pub slot: u8,
    /// Length of the table, bytes: four per knot.
    pub len: u16,
    /// CRC-32C of the table's bytes.
    pub crc32: u32,
}

/// Chunk of a table. Accepted if it starts at or before the next expected offset.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Chunk {
    /// Sequence number of the upload's [`Request::Begin`]; distinguishes late chunks of an earlier upload.
    pub upload: u16,
    /// Offset of the chunk, bytes.
    pub offset: u16,
    /// Bytes of the chunk; at most [`crate::MAX_SIGNED_CHUNK`] in a signed frame.
    pub data: Vec<u8, MAX_CHUNK>,
}

/// Table and settings for which the host has checked a play. The robot refuses the play if it holds others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Checked {
    /// CRC-32C of the table's bytes, as [`Begin::crc32`].
    pub table_crc32: u32,
    /// [`crate::settings_crc32`] of the settings in force.
    pub settings_crc32: u32,
}

/// Play of the active table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Play {
    /// Number of cycles; 0 plays until stopped.
    pub cycles: u32,
    /// Duration of a cycle, µs.
    pub period_us: u32,
    /// Continues to the end without a link; requires a finite number of cycles, and at most [`crate::MAX_DETACHED_US`].
    pub detached: bool,
    /// Table and settings that the host checked.
    pub checked: Checked,
}

/// Play that follows the present one, detached if that one is. Both together then last at most [`crate::MAX_DETACHED_US`] from
/// now.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Follow {
    /// Sequence number of the upload's [`Request::Begin`].
    pub upload: u16,
    /// Number of cycles; 0 plays until stopped.
    pub cycles: u32,
    /// Duration of a cycle, µs.
    pub period_us: u32,
    /// Uploaded table and settings that the host checked.
    pub checked: Checked,
}
