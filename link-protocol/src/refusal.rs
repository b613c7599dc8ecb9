//! Refusals of the robot, with the numbers that an operator needs. Variants are only appended.

use crate::{Joint, StateName, VersionName};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Reason for a refusal. Angles are in 1e-4 rad, rates in 1e-4 rad/s.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Refusal {
    /// The frame's session is not the open one: greet again.
    StaleSession,
    /// A later request has acted already.
    Superseded {
        /// Sequence number of the last request that acted.
        last: u16,
    },
    /// The frame's protocol version is not supported.
    Version {
        /// Lowest supported version.
        min: u8,
        /// Present version.
        current: u8,
    },
    /// The frame was complete, but its body is no request of this version.
    NotUnderstood,
    /// The robot is not armed.
    NotArmed,
    /// An e-stop is latched and must be cleared first.
    EStopped,
    /// The request is not allowed in this state.
    WrongState(StateName),
    /// The battery is low, or was within the last 5 s.
    BatteryLow {
        /// Last measurement, mV.
        measured_mv: u16,
        /// Limit, mV.
        limit_mv: u16,
    },
    /// Arming is locked after three resets in 60 s, or three starts in a row after runs of under 60 s.
    ResetLoop {
        /// Seconds until the lock may be cleared.
        wait_s: u16,
    },
    /// There is no table to play.
    NoTable,
    /// The slot does not exist; there is one slot, number 0.
    NoSuchSlot(u8),
    /// The length is invalid: a table has 4 bytes per knot, 2 to 512 knots.
    BadLength(u16),
    /// No upload of that number is open.
    NoUpload,
    /// The chunk starts after the expected offset, or exceeds the table.
    ChunkOutOfRange {
        /// Next expected offset.
        wanted: u16,
    },
    /// Bytes are missing.
    Incomplete {
        /// Next expected offset.
        wanted: u16,
    },
    /// The uploaded bytes do not match the checksum of Begin.
    CrcMismatch {
        /// Announced checksum.
        expected: u32,
        /// Checksum of the received bytes.
        received: u32,
    },
    /// The gait exceeds the largest angle, at or between its knots.
    AngleLimit {
        /// Joint of the angle.
        joint: Joint,
        /// Index of the knot before the position.
        knot: u16,
        /// Angle there, 1e-4 rad (saturated).
        angle: i32,
        /// Limit, 1e-4 rad.
        limit: i32,
    },
    /// The gait exceeds the servos' rate limit at this period.
    RateLimit {
        /// Joint of the rate.
        joint: Joint,
        /// Index of the knot before the position.
        knot: u16,
        /// Shortest allowed period, µs.
        min_period_us: u32,
    },
    /// The table does not return to its first knot, so it is no cycle.
    NotClosed {
        /// Joint of the step.
        joint: Joint,
        /// Step from the last knot to the first, 1e-4 rad.
        step: i32,
        /// Largest other step, 1e-4 rad.
        largest: i32,
    },
    /// The side links come too close to each other.
    LinksCross {
        /// Position in the motion.
        place: CrossingPlace,
        /// φ₁ at the position, 1e-4 rad.
        phi1: i16,
        /// φ₂ at the position, 1e-4 rad.
        phi2: i16,
    },
    /// A detached play, with its follower, would last for more than an hour, or endlessly.
    DetachedTooLong,
    /// A committed table still waits for the end of a cycle.
    SwapPending,
    /// A value is invalid for a length, drag, limit or pulse, or exceeds the firmware's limits.
    BadValue {
        /// Index of the invalid field, counted from 0 in the order of its structure.
        field: u8,
    },
    /// A ramp to neutral at these limits takes longer than 1 s.
    SlowToNeutral {
        /// Duration, ms.
        needs_ms: u32,
    },
    /// The robot is busy with an earlier unanswered request, or a stop cancelled the check of a table: repeat the request.
    Busy,
    /// The robot has a key, and the frame is unsigned. A stop needs no signature.
    KeyNeeded,
    /// The frame is signed with another key, or for another session.
    WrongKey,
    /// The request requires presence: a setting that gives the servos more freedom, a first key, the boot loader.
    NeedsPresence,
    /// No keep-alive was fresh: the request was late, or the link has just been opened. Repeat the request.
    NotFresh,
    /// The table does not start at the first knot of the table that it is to follow.
    NotJoined {
        /// Joint of the step.
        joint: Joint,
        /// Step from the playing table's first knot to this one's, 1e-4 rad.
        step: i32,
    },
    /// The table is not the one that the host checked.
    OtherTable {
        /// CRC-32C of the robot's table.
        held: u32,
    },
    /// The settings are not those that the host checked.
    OtherSettings {
        /// Hash of the robot's settings.
        held: u32,
    },
    /// The count of e-stops differs from the one to be cleared.
    EStopCount {
        /// E-stops since the start.
        count: u32,
    },
}

impl Refusal {
    /// Permanent number of each reason: its position in this list.
    pub fn number(&self) -> u8 {
        match self {
            Self::StaleSession => 0,
            Self::Superseded { .. } => 1,
            Self::Version { .. } => 2,
            Self::NotUnderstood => 3,
            Self::NotArmed => 4,
            Self::EStopped => 5,
            Self::WrongState(_) => 6,
            Self::BatteryLow { .. } => 7,
            Self::ResetLoop { .. } => 8,
            Self::NoTable => 9,
            Self::NoSuchSlot(_) => 10,
            Self::BadLength(_) => 11,
            Self::NoUpload => 12,
            Self::ChunkOutOfRange { .. } => 13,
            Self::Incomplete { .. } => 14,
            Self::CrcMismatch { .. } => 15,
            Self::AngleLimit { .. } => 16,
            Self::RateLimit { .. } => 17,
            Self::NotClosed { .. } => 18,
            Self::LinksCross { .. } => 19,
            Self::DetachedTooLong => 20,
            Self::SwapPending => 21,
            Self::BadValue { .. } => 22,
            Self::SlowToNeutral { .. } => 23,
            Self::Busy => 24,
            Self::KeyNeeded => 25,
            Self::WrongKey => 26,
            Self::NeedsPresence => 27,
            Self::NotFresh => 28,
            Self::NotJoined { .. } => 29,
            Self::OtherTable { .. } => 30,
            Self::OtherSettings { .. } => 31,
            Self::EStopCount { .. } => 32,
        }
    }
}

/// Position at which the side links come too close.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum CrossingPlace {
    /// In the gait, after this knot.
    Gait(u16),
    /// On the ramp to the gait's first knot, also through neutral.
    Ramp,
}

impl core::fmt::Display for Refusal {
    #[allow(clippy::too_many_lines)] // one sentence per reason
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let rad = |units: i32| f64::from(units) * 1e-4;
        match *self {
            Self::StaleSession => {
                write!(f, "the robot's open session is not this one: connect again")
            }
            Self::Superseded { last } => write!(
                f,
                "request {last} acted later than this one; this one did nothing"
            ),
            Self::Version { min, current } => write!(
                f,
                "the robot speaks protocol {} to {}: match firmware and program",
                VersionName(min),
                VersionName(current)
            ),
            Self::NotUnderstood => write!(
                f,
                "the robot does not know this request: match firmware and program"
            ),
            Self::NotArmed => write!(f, "the robot is not armed: arm it first"),
            Self::EStopped => write!(
                f,
                "an e-stop is latched: end it with `estop --clear` when it is safe, or arm with --clear-estop"
            ),
            Self::WrongState(state) => {
                write!(f, "the robot is {state:?} and does not do this then")
            }
            Self::BatteryLow {
                measured_mv,
                limit_mv,
            } => {
                write!(
                    f,
                    "battery at {measured_mv} mV, needs 5 s above {limit_mv} mV: charge it"
                )
            }
            Self::ResetLoop { wait_s } => write!(
                f,
                "three resets within 60 s, or three starts in a row after less than 60 s each (a supply that breaks down under the servos does that; so do three quick plug-ins): wait {wait_s} s, look for the cause, then clear"
            ),
            Self::NoTable => write!(f, "the robot holds no gait: upload one"),
            Self::NoSuchSlot(slot) => write!(f, "there is no gait slot {slot}, only 0"),
            Self::BadLength(len) => write!(
                f,
                "a table of {len} bytes: it takes 4 a knot, 2 to 512 knots"
            ),
            Self::NoUpload => write!(f, "no such upload is open: begin again"),
            Self::ChunkOutOfRange { wanted } => {
                write!(f, "chunk out of range; byte {wanted} is wanted next")
            }
            Self::Incomplete { wanted } => {
                write!(f, "the table is not complete: byte {wanted} is wanted next")
            }
            Self::CrcMismatch { expected, received } => {
                write!(
                    f,
                    "table checksum {received:08x}, announced {expected:08x}: upload again"
                )
            }
            Self::AngleLimit {
                joint,
                knot,
                angle,
                limit,
            } => write!(
                f,
                "{joint:?} joint goes to {:.4} rad after knot {knot}, limit {:.4} rad: use a smaller gait",
                rad(angle),
                rad(limit)
            ),
            Self::RateLimit {
                joint,
                knot,
                min_period_us,
            } => write!(
                f,
                "{joint:?} joint is too fast after knot {knot}: the shortest period allowed is {:.3} s",
                f64::from(min_period_us) * 1e-6
            ),
            Self::NotClosed {
                joint,
                step,
                largest,
            } => write!(
                f,
                "{joint:?} joint jumps {:.4} rad from the last knot to the first, {:.4} rad at most elsewhere: close the gait",
                rad(step),
                rad(largest)
            ),
            Self::LinksCross { place, phi1, phi2 } => {
                let (phi1, phi2) = (rad(phi1.into()), rad(phi2.into()));
                match place {
                    CrossingPlace::Gait(knot) => {
                        write!(
                            f,
                            "side links touch at ({phi1:.4}, {phi2:.4}) rad after knot {knot}: use another gait"
                        )
                    }
                    CrossingPlace::Ramp => {
                        write!(
                            f,
                            "side links would touch at ({phi1:.4}, {phi2:.4}) rad on the way to the gait: stop first"
                        )
                    }
                }
            }
            Self::DetachedTooLong => write!(
                f,
                "a detached play lasts at most an hour, with what follows it: give fewer cycles, or stay connected"
            ),
            Self::SwapPending => write!(
                f,
                "an earlier table still waits for its cycle boundary: try again later"
            ),
            Self::BadValue { field } => {
                write!(f, "value number {field} of the request is out of range")
            }
            Self::SlowToNeutral { needs_ms } => {
                write!(
                    f,
                    "ramping to neutral would take {needs_ms} ms, 1000 allowed: raise max_rate or lower max_angle"
                )
            }
            Self::Busy => write!(
                f,
                "the robot is still busy with an earlier request: try again"
            ),
            Self::KeyNeeded => write!(
                f,
                "the robot has a key, and this was not signed: give it with --key FILE (stop and estop need none)"
            ),
            Self::WrongKey => write!(
                f,
                "this was signed with another key than the robot's: give the right one with --key FILE (stop and estop need none)"
            ),
            Self::NeedsPresence => write!(
                f,
                "a first key, the boot loader and settings that let the servos do more (another direction, a wider pulse range, centre, slope and trim beyond 1 degree in sum, limits beyond those as built, lengths more than a tenth from them) are for somebody at the robot: connect over its USB cable, or close its bench jumper (on a Pico press BOOTSEL) and try again within two minutes"
            ),
            Self::NotFresh => write!(
                f,
                "it has heard nothing fresh from here: the link is slower than a second, or was only just opened; try again, nearer to it"
            ),
            Self::NotJoined { joint, step } => write!(
                f,
                "{joint:?} joint would jump {:.4} rad to the gait that follows: gaits that follow each other start at one shape",
                rad(step)
            ),
            Self::OtherTable { held } => write!(
                f,
                "the robot holds another gait ({held:08x}) than the one you checked: upload it again"
            ),
            Self::OtherSettings { held } => write!(
                f,
                "the robot's settings ({held:08x}) are not those that the gait was checked for (geometry, limits, servo maps): check it again"
            ),
            Self::EStopCount { count } => write!(
                f,
                "another e-stop came since ({count} in all): look at the robot, then clear it again"
            ),
        }
    }
}

impl core::error::Error for Refusal {}
