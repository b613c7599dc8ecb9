//! Errors of a session: messages with numbers and advice.

use std::io;
use std::time::Duration;

use link_protocol::{Flags, Refusal, StateName, StopCause, VersionName};

use super::counters::LinkCounters;

/// Reason why a request or an upload failed. `doing` completes "while …".
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// The port failed.
    #[error("while {doing}: the port failed: {source}; check cable or pairing and connect again")]
    Port {
        /// Operation in progress.
        doing: &'static str,
        /// The system's error.
        source: io::Error,
    },
    /// No reply.
    #[error(
        "while {doing}: no answer after {tries} tries in {} ms ({counters}){}",
        waited.as_millis(),
        no_answer_advice(counters)
    )]
    NoAnswer {
        /// Operation in progress.
        doing: &'static str,
        /// Number of attempts.
        tries: u32,
        /// Time from the first attempt to the failure.
        waited: Duration,
        /// Counts of the link.
        counters: Box<LinkCounters>,
    },
    /// The link became silent during an operation without a limit on attempts.
    #[error(
        "while {doing}: no valid frame for {} ms ({counters}); move the robot nearer or reconnect, then try again: an upload continues at its last offset",
        silent.as_millis()
    )]
    Silent {
        /// Operation in progress.
        doing: &'static str,
        /// Duration of the silence.
        silent: Duration,
        /// Counts of the link.
        counters: Box<LinkCounters>,
    },
    /// The robot keeps replying that it is working, and does not finish.
    #[error(
        "while {doing}: the robot has answered for {} s that it is still working at it, which no request takes; look at its status, and restart it if it says nothing else",
        waited.as_secs()
    )]
    StillWorking {
        /// Operation in progress.
        doing: &'static str,
        /// Time since the first attempt.
        waited: Duration,
    },
    /// The deadline passed although the link works.
    #[error("while {doing}: not done after {} ms ({done} of {total} bytes arrived; {counters}); try again: it goes on where it was", waited.as_millis())]
    Deadline {
        /// Operation in progress.
        doing: &'static str,
        /// Time limit.
        waited: Duration,
        /// Transferred bytes.
        done: usize,
        /// Total bytes.
        total: usize,
        /// Counts of the link.
        counters: Box<LinkCounters>,
    },
    /// The robot refused the request.
    #[error("while {doing}: the robot refuses: {refusal}")]
    Refused {
        /// Operation in progress.
        doing: &'static str,
        /// The robot's reason.
        refusal: Refusal,
    },
    /// The protocol versions are incompatible.
    #[error(
        "the robot's firmware {firmware} speaks versions {} to {} of the protocol, this program {} to {}: {}",
        VersionName(*robot_min),
        VersionName(*robot_current),
        VersionName(*host_min),
        VersionName(*host_current),
        if robot_current < host_min { "update the robot's firmware" } else { "update this program" }
    )]
    Version {
        /// Lowest version that the robot supports.
        robot_min: u8,
        /// Version of the robot.
        robot_current: u8,
        /// Lowest version that this program supports.
        host_min: u8,
        /// Version of this program.
        host_current: u8,
        /// Firmware of the robot.
        firmware: String,
    },
    /// Equal versions with different messages: one end is a build between two releases.
    #[error(
        "the robot's firmware {firmware} and this program both speak version {} of the protocol but disagree on its messages (keys {robot_key:016x} and {host_key:016x}): build both from the same commit",
        VersionName(*version)
    )]
    Schema {
        /// Common version.
        version: u8,
        /// Schema key of the robot.
        robot_key: u64,
        /// Schema key of this program.
        host_key: u64,
        /// Firmware of the robot.
        firmware: String,
    },
    /// The robot's greeting has a board or a reset reason that is newer than this program.
    #[error(
        "the robot's firmware {firmware} is newer than this program and reports a board or a reset cause that it does not know: update this program"
    )]
    UnknownGreeting {
        /// Firmware of the robot.
        firmware: String,
    },
    /// The robot's reply is newer than this program.
    #[error(
        "while {doing}: the robot gave an answer that this program does not know, so its firmware is newer: update this program; the robot's status shows if it acted"
    )]
    UnknownAnswer {
        /// Operation in progress.
        doing: &'static str,
    },
    /// The session no longer exists on the robot.
    #[error(
        "while {doing}: the robot has opened another session: it restarted (do the servos pull its supply down?), or another program took it over; look at its status and connect again"
    )]
    SessionLost {
        /// Operation in progress.
        doing: &'static str,
    },
    /// A stop was sent before the reply.
    #[error("while {doing}: dropped because a stop was sent; the robot's status shows if it acted")]
    Dropped {
        /// Operation in progress.
        doing: &'static str,
    },
    /// There is no connection, or it failed.
    #[error("while {doing}: no session with the robot; connect first")]
    NotConnected {
        /// Operation in progress.
        doing: &'static str,
    },
    /// The robot's replies lack the signature that they had before.
    #[error(
        "while {doing}: answers came, but not signed with the key: the robot restarted meanwhile (then it is at rest), or something else answers in its place; look at the robot, then connect again"
    )]
    NotSigned {
        /// Operation in progress.
        doing: &'static str,
    },
    /// The kind of the reply does not match the request.
    #[error(
        "while {doing}: the robot's reply does not belong to this request ({reply}); match firmware and program"
    )]
    WrongReply {
        /// Operation in progress.
        doing: &'static str,
        /// Received reply.
        reply: String,
    },
    /// A value exceeds the range of the wire format.
    #[error("while {doing}: {quantity} of {value} is outside {low} … {high}")]
    OutOfRange {
        /// Operation in progress.
        doing: &'static str,
        /// Quantity with its unit.
        quantity: &'static str,
        /// Value of the quantity.
        value: f64,
        /// Smallest possible value.
        low: f64,
        /// Largest possible value.
        high: f64,
    },
    /// The robot stopped before the end of the play.
    #[error(
        "the robot stopped after {}: {}{}",
        cycles_in_words(*cycle, *cycles),
        cause_in_words(*cause),
        if flags.contains(Flags::BATTERY_LOW) { " (battery low)" } else { "" }
    )]
    StoppedEarly {
        /// Cause of the stop.
        cause: StopCause,
        /// Present state of the robot.
        state: StateName,
        /// Finished cycles.
        cycle: u32,
        /// Requested cycles.
        cycles: u32,
        /// Flags of the status.
        flags: Flags,
    },
    /// The next table of a sequence was late.
    #[error(
        "the robot came to rest after {played} of {legs} gaits of the playlist: the table of the next was not there when the last \
         cycle ended; the link is too slow for so short a step, so give it more cycles, or bring the robot nearer"
    )]
    OutOfStep {
        /// Number of legs that were played.
        played: usize,
        /// Number of legs of the sequence.
        legs: usize,
    },
    /// The robot applied the request but could not store it.
    #[error(
        "while {doing}: done, but the robot could not store it, so it is gone when the power is cut: look at its status and try again"
    )]
    NotStored {
        /// Operation in progress.
        doing: &'static str,
    },
    /// The caller cancelled the operation.
    #[error("while {doing}: broken off by the operator")]
    Interrupted {
        /// Operation in progress.
        doing: &'static str,
    },
}

fn no_answer_advice(counters: &LinkCounters) -> &'static str {
    let received = &counters.received;
    let unknown = received.not_understood > 0 || received.trailing_bytes > 0;
    if counters.echoed > 0 && u64::from(received.ok) == counters.echoed {
        return "; what is sent comes back unchanged, and nothing else: the line echoes (its two wires joined, a module that waits for AT commands, or a terminal's echo), so there is no robot at its other end";
    }
    match (counters.bytes_received, received.ok) {
        (0, _) => {
            "; is the robot on and paired, and is this its port? Without its Bluetooth module's STATE wire it hears and never answers"
        }
        (_, 0) if unknown => {
            "; whole frames come, but none that this program knows: the robot's firmware is newer, update this program"
        }
        (_, 0) => {
            "; bytes come but none make sense: is this the robot's port, is its Bluetooth module set to 115200 baud (AT+UART=115200,0,0; a robot built for another speed wants --baud), and are all grounds joined?"
        }
        _ => {
            "; the link is bad: bring the robot nearer, over a cable look at its ground wire, and try again"
        }
    }
}

/// Progress of a play in words.
pub fn cycles_in_words(cycle: u32, cycles: u32) -> String {
    match cycles {
        0 => format!("{cycle} cycles of a play without end"),
        cycles => format!("{cycle} of {cycles} cycles"),
    }
}

/// Cause of a stop as a clause.
pub fn cause_in_words(cause: StopCause) -> &'static str {
    match cause {
        StopCause::Boot => {
            "it restarted (where the servos pull its supply down, they need their own)"
        }
        StopCause::Finished => "the play ended",
        StopCause::Requested => "a stop was requested",
        StopCause::PauseExpired => "the pause reached its limit",
        StopCause::LinkLost => "it lost the link",
        StopCause::BatteryLow => "its battery is low: charge it",
        StopCause::EStop => "an e-stop was requested",
    }
}
