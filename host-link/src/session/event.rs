//! Events of a session.

use std::time::Duration;

use link_protocol::{Reply, StopCause, TableInfo, Telemetry};

use super::error::LinkError;
use super::upload::UploadProgress;

/// Identifier of a request until the event that ends it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Ticket(pub(super) u64);

impl Ticket {
    /// The identifier as a number, for callers outside Rust.
    pub fn number(self) -> u64 {
        self.0
    }
}

/// Event of a session.
#[derive(Debug)]
pub enum Event {
    /// A session is open.
    Connected {
        /// The ticket of [`super::Session::connect`].
        ticket: Ticket,
        /// The robot has restarted since the last session.
        restarted: bool,
    },
    /// The robot replied to a request.
    Answered {
        /// The ticket of [`super::Session::request`].
        ticket: Ticket,
        /// The reply; never a refusal.
        reply: Reply,
    },
    /// The robot reports that it has stopped by itself, before a reply to the stop: the stop waits on the line behind other
    /// bytes, and the lease ran out first.
    StoppedByItself {
        /// The ticket of [`super::Session::request`].
        ticket: Ticket,
        /// Cause of the stop.
        cause: StopCause,
    },
    /// An upload is the active table, or will be at the end of the cycle.
    Uploaded {
        /// The ticket of [`super::Session::upload`].
        ticket: Ticket,
        /// Table that the robot now holds.
        table: TableInfo,
    },
    /// Progress of an upload.
    Progress {
        /// The ticket of [`super::Session::upload`].
        ticket: Ticket,
        /// Transferred and total bytes.
        progress: UploadProgress,
    },
    /// A request, greeting or upload failed.
    Failed {
        /// Ticket of the failed operation.
        ticket: Ticket,
        /// Reason of the failure.
        error: LinkError,
    },
    /// Telemetry arrived.
    Telemetry {
        /// The telemetry.
        telemetry: Telemetry,
        /// Time of arrival, on the host's clock.
        at: Duration,
    },
}

impl Event {
    /// Ticket that ends with this event. `None` for progress and telemetry.
    pub fn ended(&self) -> Option<Ticket> {
        match self {
            Self::Connected { ticket, .. }
            | Self::Answered { ticket, .. }
            | Self::StoppedByItself { ticket, .. }
            | Self::Uploaded { ticket, .. }
            | Self::Failed { ticket, .. } => Some(*ticket),
            Self::Progress { .. } | Self::Telemetry { .. } => None,
        }
    }
}
