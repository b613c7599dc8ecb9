//! Events of a session.

use std::time::Duration;

use link_protocol::{Reply, StopCause, TableInfo, Telemetry};

use super::error::LinkError;
use super::upload::UploadProgress;

/// Names a request until the event that ends it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Ticket(pub(super) u64);

impl Ticket {
    /// The same as a number, for who keeps it outside of Rust.
    pub fn number(self) -> u64 {
        self.0
    }
}

/// Something that happened in a session.
#[derive(Debug)]
pub enum Event {
    /// A session is open. `restarted`: the robot has booted since the session before.
    Connected {
        /// The ticket of [`super::Session::connect`].
        ticket: Ticket,
        /// The robot has restarted since the last session.
        restarted: bool,
    },
    /// The robot answered a request.
    Answered {
        /// The ticket of [`super::Session::request`].
        ticket: Ticket,
        /// Its answer; never a refusal.
        reply: Reply,
    },
    /// A stop was not answered yet, but the robot says that it has stopped by itself: the stop waits on the line behind other
    /// bytes, and the lease was quicker.
    StoppedByItself {
        /// The ticket of [`super::Session::request`].
        ticket: Ticket,
        /// Why it stopped.
        cause: StopCause,
    },
    /// An upload is the active table, or will be at the next cycle boundary.
    Uploaded {
        /// The ticket of [`super::Session::upload`].
        ticket: Ticket,
        /// What the robot holds now.
        table: TableInfo,
    },
    /// More of an upload has arrived.
    Progress {
        /// The ticket of [`super::Session::upload`].
        ticket: Ticket,
        /// How much.
        progress: UploadProgress,
    },
    /// Something asked did not happen.
    Failed {
        /// Its ticket.
        ticket: Ticket,
        /// Why.
        error: LinkError,
    },
    /// The robot told about itself.
    Telemetry {
        /// What it said.
        telemetry: Telemetry,
        /// When it arrived, on the host's clock.
        at: Duration,
    },
}

impl Event {
    /// Ticket that ends with this event; `None` for progress and telemetry, which end nothing.
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
