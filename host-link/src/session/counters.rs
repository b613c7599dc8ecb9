//! Link statistics, for errors and dashboards.

use std::fmt;
use std::time::Duration;

use link_protocol::DecodeCounters;
use serde::{Deserialize, Serialize};

/// Counts of frames and bytes on the link.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LinkCounters {
    /// Frames sent, of any kind.
    pub frames_sent: u64,
    /// Bytes sent.
    pub bytes_sent: u64,
    /// Bytes received, including corrupt ones.
    pub bytes_received: u64,
    /// Decoder counts of received frames.
    pub received: DecodeCounters,
    /// Frames repeated because there was no reply in time.
    pub retransmissions: u64,
    /// Keep-alives sent.
    pub keep_alives: u64,
    /// Frames that only hosts send: an echo of the line.
    #[serde(default)]
    pub echoed: u64,
    /// Replies without the required signature, from a robot that has not yet proved that it has the key.
    #[serde(default)]
    pub unsigned: u64,
    /// Replies with a missing, wrong or replayed signature, from a robot that has proved it; dropped.
    #[serde(default)]
    pub forged: u64,
    /// Frames of another session, dropped.
    pub foreign: u64,
    /// Replies without a pending request, dropped.
    pub unmatched: u64,
    /// Telemetry delivered.
    pub telemetry: u64,
    /// Telemetry that arrived out of order, dropped.
    pub late_telemetry: u64,
    /// Sessions opened.
    pub sessions: u64,
    /// Requests that failed after all attempts.
    pub given_up: u64,
    /// Smoothed round trip; `None` before the first reply.
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
