//! How a session fails, in sentences with numbers and advice.

use std::io;
use std::time::Duration;

use link_protocol::{Flags, Refusal, StateName, StopCause, VersionName};

use super::counters::LinkCounters;

/// Why something asked of the robot did not happen. `doing` completes "while …".
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// The port itself failed.
    #[error("while {doing}: the port failed: {source}; check cable or pairing and connect again")]
    Port {
        /// What was being done.
        doing: &'static str,
        /// The system's words.
        source: io::Error,
    },
    /// Nothing at all came back.
    #[error(
        "while {doing}: no answer after {tries} tries in {} ms ({counters}){}",
        waited.as_millis(),
        no_answer_advice(counters)
    )]
    NoAnswer {
        /// What was being done.
        doing: &'static str,
        /// Times it was sent.
        tries: u32,
        /// Time from the first sending to giving up.
        waited: Duration,
        /// What crossed the link.
        counters: Box<LinkCounters>,
    },
    /// The link fell silent during something that retries for as long as the robot is heard.
    #[error(
        "while {doing}: nothing valid heard for {} ms ({counters}); bring the robot nearer or reconnect, then try again: an upload goes on where it was",
        silent.as_millis()
    )]
    Silent {
        /// What was being done.
        doing: &'static str,
        /// How long nothing was heard.
        silent: Duration,
        /// What crossed the link.
        counters: Box<LinkCounters>,
    },
    /// The robot answers that it is at it, and does not finish.
    #[error(
        "while {doing}: the robot has answered for {} s that it is still working at it, which no request takes; look at its status, and restart it if it says nothing else",
        waited.as_secs()
    )]
    StillWorking {
        /// What was being done.
        doing: &'static str,
        /// Time since the request was first sent.
        waited: Duration,
    },
    /// The deadline passed although the link works.
    #[error("while {doing}: not done after {} ms ({done} of {total} bytes arrived; {counters}); try again: it goes on where it was", waited.as_millis())]
    Deadline {
        /// What was being done.
        doing: &'static str,
        /// The time that was given.
        waited: Duration,
        /// Bytes that arrived.
        done: usize,
        /// Bytes in all.
        total: usize,
        /// What crossed the link.
        counters: Box<LinkCounters>,
    },
    /// The robot said no.
    #[error("while {doing}: the robot refuses: {refusal}")]
    Refused {
        /// What was being done.
        doing: &'static str,
        /// Its reason.
        refusal: Refusal,
    },
    /// The versions of the protocol do not meet.
    #[error(
        "the robot's firmware {firmware} speaks versions {} to {} of the protocol, this program {} to {}: {}",
        VersionName(*robot_min),
        VersionName(*robot_current),
        VersionName(*host_min),
        VersionName(*host_current),
        if robot_current < host_min { "update the robot's firmware" } else { "update this program" }
    )]
    Version {
        /// Lowest version the robot understands.
        robot_min: u8,
        /// Version the robot speaks.
        robot_current: u8,
        /// Lowest version this program understands.
        host_min: u8,
        /// Version this program speaks.
        host_current: u8,
        /// The robot's firmware.
        firmware: String,
    },
    /// Same version, other messages: one end is a build from between two releases.
    #[error(
        "the robot's firmware {firmware} and this program both speak version {} of the protocol but disagree on its messages (keys {robot_key:016x} and {host_key:016x}): build both from the same commit",
        VersionName(*version)
    )]
    Schema {
        /// The version both speak.
        version: u8,
        /// The robot's schema key.
        robot_key: u64,
        /// This program's schema key.
        host_key: u64,
        /// The robot's firmware.
        firmware: String,
    },
    /// The robot's greeting names a board or a reason of its reset that was appended to the protocol since this program.
    #[error(
        "the robot's firmware {firmware} is newer than this program and tells of itself what it does not know (a board, or a reason of its last reset): update this program"
    )]
    UnknownGreeting {
        /// The robot's firmware.
        firmware: String,
    },
    /// The robot's answer is one that was appended to the protocol since this program.
    #[error(
        "while {doing}: the robot gave an answer that this program does not know, so its firmware is newer: update this program; whether the robot did it, its status tells"
    )]
    UnknownAnswer {
        /// What was being done.
        doing: &'static str,
    },
    /// The robot no longer knows this session.
    #[error(
        "while {doing}: the robot has opened another session: it restarted (do the servos pull its supply down?), or another program took it over; look at its status and connect again"
    )]
    SessionLost {
        /// What was being done.
        doing: &'static str,
    },
    /// A stop was sent before this was answered.
    #[error(
        "while {doing}: dropped because a stop was sent; whether the robot did it, its status tells"
    )]
    Dropped {
        /// What was being done.
        doing: &'static str,
    },
    /// Nobody has connected, or the connection failed.
    #[error("while {doing}: no session with the robot; connect first")]
    NotConnected {
        /// What was being done.
        doing: &'static str,
    },
    /// The robot's answers do not carry the tag of the key that it had before.
    #[error(
        "while {doing}: answers came, but not signed with the key: the robot restarted meanwhile (then it is at rest), or something else answers in its place; look at the robot, then connect again"
    )]
    NotSigned {
        /// What was being done.
        doing: &'static str,
    },
    /// The answer is none to the question.
    #[error(
        "while {doing}: the robot's answer is none to this request ({reply}); match firmware and program"
    )]
    WrongReply {
        /// What was being done.
        doing: &'static str,
        /// What came.
        reply: String,
    },
    /// A number that does not fit the wire.
    #[error("while {doing}: {quantity} of {value} is outside {low} … {high}")]
    OutOfRange {
        /// What was being done.
        doing: &'static str,
        /// Which quantity, with its unit.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// Lowest possible.
        low: f64,
        /// Highest possible.
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
        /// Why.
        cause: StopCause,
        /// Its state now.
        state: StateName,
        /// Cycles done.
        cycle: u32,
        /// Cycles asked for.
        cycles: u32,
        /// What else holds.
        flags: Flags,
    },
    /// A table of a sequence was not there when the play before it ended.
    #[error(
        "the robot came to rest after {played} of {legs} gaits of the playlist: the table of the next was not there when the last \
         cycle ended; the link is too slow for so short a step, so give it more cycles, or bring the robot nearer"
    )]
    OutOfStep {
        /// Legs that were played.
        played: usize,
        /// Legs of the sequence.
        legs: usize,
    },
    /// The robot did it, but its storage did not take it.
    #[error(
        "while {doing}: done, but the robot could not store it, so it is gone when the power is cut: look at its status and try again"
    )]
    NotStored {
        /// What was being done.
        doing: &'static str,
    },
    /// The caller broke off.
    #[error("while {doing}: broken off by the operator")]
    Interrupted {
        /// What was being done.
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

/// How far a play came.
pub fn cycles_in_words(cycle: u32, cycles: u32) -> String {
    match cycles {
        0 => format!("{cycle} cycles of a play without end"),
        cycles => format!("{cycle} of {cycles} cycles"),
    }
}

/// A cause of stopping as a clause.
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
