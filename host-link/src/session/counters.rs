//! What happened on the link so far, as an error shows it and a dashboard draws it.

use std::fmt;
use std::time::Duration;

use link_protocol::DecodeCounters;
use serde::{Deserialize, Serialize};

/// Counts of everything that crossed the link, or should have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LinkCounters {
    /// Frames sent, of any kind.
    pub frames_sent: u64,
    /// Bytes sent.
    pub bytes_sent: u64,
    /// Bytes received, broken ones too.
    pub bytes_received: u64,
    /// What became of the frames received.
    pub received: DecodeCounters,
    /// Frames sent again because no answer came in time.
    pub retransmissions: u64,
    /// Keep-alives sent.
    pub keep_alives: u64,
    /// Frames that only hosts send: the line gives back what it is given.
    #[serde(default)]
    pub echoed: u64,
    /// Answers without the signature that the key asks for, from a robot that has not shown yet that it has the key.
    #[serde(default)]
    pub unsigned: u64,
    /// Answers that were not signed, or not with the key, or played back, from one that had; dropped.
    #[serde(default)]
    pub forged: u64,
    /// Frames of another session, dropped.
    pub foreign: u64,
    /// Replies to nothing that still waits, dropped.
    pub unmatched: u64,
    /// Telemetry delivered.
    pub telemetry: u64,
    /// Telemetry older than what was delivered before, dropped.
    pub late_telemetry: u64,
    /// Sessions opened.
    pub sessions: u64,
    /// Requests given up.
    pub given_up: u64,
    /// Smoothed round trip; `None` before the first answer.
    pub round_trip: Option<Duration>,
}

impl fmt::Display for LinkCounters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} frames ({} bytes) sent, {} of them again; {} frames ({} bytes) received, {} broken, {} foreign",
            self.frames_sent,
            self.bytes_sent,
            self.retransmissions,
            self.received.ok,
            self.bytes_received,
            self.received.bad(),
            self.foreign,
        )?;
        match self.round_trip {
            Some(trip) => write!(f, "; round trip {} ms", trip.as_millis()),
            None => Ok(()),
        }
    }
}
