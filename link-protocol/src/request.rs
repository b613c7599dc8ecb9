//! What a host may ask of the robot. Variants are only appended.

use crate::{Configuration, Joint, Key, MAX_CHUNK, PulseRange, ServoSettings};
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
    /// Sets the configuration; only while Stopped. Lengths more than a tenth from those as built, and limits beyond those as
    /// built, need presence.
    Configure(Configuration),
    /// The settings of a servo. Answered by [`crate::Reply::Servo`].
    Servo(Joint),
    /// Sets the map of a servo; only while Stopped.
    SetServo {
        /// Which joint.
        joint: Joint,
        /// Its map.
        settings: ServoSettings,
    },
    /// Sets a servo's trim: angle in units of 1e-4 rad added to every set-point. Not while moving; saved when Stopped.
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
    /// Turns pulses on at the last commanded set-point (after a reset: neutral); the servo may jump to it.
    Arm(Arm),
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
    /// Sets, changes or removes the shared key; only while Stopped; in force from the next session on. A robot with a key
    /// takes it only signed with that key; the first key needs presence. The new key crosses the wire in the clear: send it
    /// over a cable.
    SetKey(Option<Key>),
    /// What only the bench asks for: presence, short starts. Answered by [`crate::Reply::Bench`].
    Bench,
    /// The pulses that a servo's end stops allow. Answered by [`crate::Reply::PulseRange`].
    PulseRange(Joint),
    /// Sets them; only while Stopped.
    SetPulseRange {
        /// Which joint.
        joint: Joint,
        /// Its range.
        range: PulseRange,
    },
    /// Clears a latched e-stop to Stopped, without arming.
    ClearEStop,
    /// Leaves the firmware for the chip's boot loader, which takes a new one over USB; only while Stopped, with presence. The
    /// answer comes before.
    EnterBootLoader,
    /// Checks an upload as [`Request::Commit`] does, and plays it once the last cycle of the play under way is done (of a play
    /// without end: the present one), without a pause. Both tables start at the same knot. Answered by
    /// [`crate::Reply::Table`] when it waits.
    Follow(Follow),
}

impl Request {
    /// It ends motion: it acts in any session and under any number, and the more often the safer.
    pub fn is_stop(&self) -> bool {
        matches!(self, Self::Stop | Self::EStop)
    }

    /// It turns pulses on or sets joints in motion: it takes a host whose keep-alives are fresh.
    pub fn is_powering(&self) -> bool {
        matches!(
            self,
            Self::Arm(_) | Self::Play(_) | Self::Resume | Self::Follow(_)
        )
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

/// Turns pulses on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Arm {
    /// Clears a latched e-stop too; without it arming is refused then.
    pub clear_estop: bool,
}

/// Plays the active table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Play {
    /// Number of cycles; 0 plays until told otherwise.
    pub cycles: u32,
    /// Duration of a cycle, µs.
    pub period_us: u32,
    /// Plays on to its end when the link falls silent; needs a number of cycles.
    pub detached: bool,
}

/// What follows the play under way; it plays on detached where that one does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Follow {
    /// Sequence number of the upload's [`Request::Begin`].
    pub upload: u16,
    /// Number of cycles; 0 plays until told otherwise.
    pub cycles: u32,
    /// Duration of a cycle, µs.
    pub period_us: u32,
}
