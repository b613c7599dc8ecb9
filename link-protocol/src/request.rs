//! Requests of a host. Variants are only appended.

use crate::{Configuration, Joint, Key, MAX_CHUNK, PulseRange, RequestClass, ServoSettings};
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// A request; its frame's sequence number ties the [`crate::Reply`] to it. All but [`Request::Chunk`] act in
/// increasing order of sequence number (modulo 2¹⁶, half range), each at most once; [`Request::Stop`] and
/// [`Request::EStop`] act always.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[allow(clippy::large_enum_variant)] // a chunk is a message like others, and there is no heap to box it
pub enum Request {
    /// What the robot is doing. Answered by [`crate::Reply::Status`].
    Status,
    /// What was received, refused and dropped so far. Answered by [`crate::Reply::Counters`].
    Counters,
    /// The configuration in force. Answered by [`crate::Reply::Configuration`].
    Configuration,
    /// Sets the configuration. Lengths more than a tenth from those as built, and limits beyond those as built, need presence.
    Configure(Configuration),
    /// The settings of a servo. Answered by [`crate::Reply::Servo`].
    Servo(Joint),
    /// Sets the map of a servo. `reversed`, and a map that moves a joint by more than 1° from where it was last set with
    /// presence, need presence.
    SetServo {
        /// Which joint.
        joint: Joint,
        /// Its map.
        settings: ServoSettings,
    },
    /// Sets a servo's trim: angle in units of 1e-4 rad added to every set-point. Not while moving; saved when Stopped. Beyond
    /// 1° from where the joint was last set with presence it needs presence.
    Trim {
        /// Which joint.
        joint: Joint,
        /// The whole trim, not a step, 1e-4 rad.
        trim: i16,
    },
    /// Opens an upload, or resumes the one of the same length and checksum. Answered by [`crate::Reply::Wanted`].
    Begin(Begin),
    /// A piece of the table, acting whatever the order. Answered by [`crate::Reply::Wanted`].
    Chunk(Chunk),
    /// Checks the uploaded table and makes it the active one. The upload's number is that of its [`Request::Begin`].
    Commit {
        /// Sequence number of the upload's [`Request::Begin`].
        upload: u16,
    },
    /// Turns pulses on at the last commanded set-point (after a reset: neutral); the servo may jump to it. Clears no latch.
    Arm,
    /// Plays the active table, after a soft start.
    Play(Play),
    /// Holds the pose. Detached: holds it without a link too, for at most 60 s in all, then stops.
    Pause {
        /// Hold without the link.
        detached: bool,
    },
    /// Goes on from where [`Request::Pause`] held.
    Resume,
    /// Ramps to neutral, then drops the pulses. Acts in every state, whatever session and sequence number, in frames of any
    /// version.
    Stop,
    /// Drops the pulses within one tick, latched. Acts as [`Request::Stop`] does.
    EStop,
    /// Clears the latch of three resets in 60 s, or of three short starts, once the robot has been up for 60 s.
    ClearResets,
    /// The message of the crash before the last start. Answered by [`crate::Reply::CrashMessage`].
    CrashMessage,
    /// Names the table that is active. Answered by [`crate::Reply::Table`].
    Table,
    /// Sets, changes or removes the shared key, and closes the session: greet again, with the new key. A robot with a key
    /// takes it only signed with that key; the first key needs presence. The new key crosses the wire in the clear: send it
    /// over a cable.
    SetKey(Option<Key>),
    /// Presence, short starts and the configuration as built. Answered by [`crate::Reply::Bench`].
    Bench,
    /// The pulses that a servo's end stops allow. Answered by [`crate::Reply::PulseRange`].
    PulseRange(Joint),
    /// Sets them. A range that is wider at either end than the one in force needs presence.
    SetPulseRange {
        /// Which joint.
        joint: Joint,
        /// Its range.
        range: PulseRange,
    },
    /// Clears a latched e-stop to Stopped, without arming.
    ClearEStop {
        /// [`crate::Status::estops`] as the host last read it: an e-stop that came since is not cleared.
        count: u32,
    },
    /// Leaves the firmware for the chip's boot loader, which takes a new one over USB. The answer comes before.
    EnterBootLoader,
    /// Checks an upload as [`Request::Commit`] does, and plays it once the last cycle of the play under way is done (of a play
    /// without end: the present one), without a pause. Both tables start at the same knot. Answered by
    /// [`crate::Reply::Table`] when it waits.
    Follow(Follow),
}

impl Request {
    /// Ends motion: acts in any session and under any number.
    pub fn is_stop(&self) -> bool {
        self.class(|| true) == RequestClass::Stop
    }

    /// Turns pulses on, or changes the motion of a powered robot.
    pub fn is_powering(&self) -> bool {
        self.class(|| true) == RequestClass::Powering
    }
}

/// Opens an upload.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Begin {
    /// Which gait: 0 is the one there is.
    pub slot: u8,
    /// Bytes of the table: four for each knot.
    pub len: u16,
    /// CRC-32C of the table's bytes.
    pub crc32: u32,
}

/// A piece of a table. Taken where it starts at or before the next wanted offset, whatever came before.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Chunk {
    /// Sequence number of the upload's [`Request::Begin`]: a late chunk of an earlier upload is told apart by it.
    pub upload: u16,
    /// Where the piece starts, bytes.
    pub offset: u16,
    /// The piece. Frames that carry a signature leave room for [`crate::MAX_SIGNED_CHUNK`] bytes.
    pub data: Vec<u8, MAX_CHUNK>,
}

/// Table and settings for which the host has checked a play. A robot that holds others refuses it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Checked {
    /// CRC-32C of the table's bytes, as [`Begin::crc32`].
    pub table_crc32: u32,
    /// [`crate::settings_crc32`] of the settings in force.
    pub settings_crc32: u32,
}

/// Plays the active table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Play {
    /// Number of cycles; 0 plays until stopped.
    pub cycles: u32,
    /// Duration of a cycle, µs.
    pub period_us: u32,
    /// Plays on to its end when the link falls silent; needs a number of cycles, and at most [`crate::MAX_DETACHED_US`].
    pub detached: bool,
    /// Table and settings that the host checked.
    pub checked: Checked,
}

/// Successor of the play under way; detached if that play is. The two together then last at most
/// [`crate::MAX_DETACHED_US`] from now.
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
