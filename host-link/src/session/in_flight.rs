//! Pending greeting, request and upload.

use std::time::Duration;

use link_protocol::{Begin, Checked, Follow, HelloReply, Request};

use super::Ticket;
use super::upload::{UploadPhase, Window};

#[derive(Debug)]
pub(super) struct Greeting {
    /// `None` if the session greets by itself for an upload.
    pub(super) ticket: Option<Ticket>,
    pub(super) nonce: u32,
    pub(super) sequence: u16,
    pub(super) tries: u32,
    pub(super) first_sent: Duration,
    pub(super) next_try: Duration,
}

#[derive(Debug)]
#[allow(clippy::large_enum_variant)] // there is only one instance
pub(super) enum Link {
    Closed,
    Greeting(Greeting),
    Open(HelloReply),
}

/// Owner of a pending request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Owner {
    Ticket(Ticket),
    Upload,
}

/// Request that was sent at least once.
#[derive(Debug)]
pub(super) struct Pending {
    pub(super) owner: Owner,
    pub(super) request: Request,
    pub(super) sequence: u16,
    /// Attempts since the robot last reported that it is working.
    pub(super) tries: u32,
    pub(super) first_sent: Duration,
    pub(super) last_sent: Duration,
    pub(super) next_try: Duration,
    /// A reply came without the required signature.
    pub(super) unsigned: bool,
}

/// Play of a table that follows the present one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Follower {
    /// Number of cycles; 0 plays until stopped.
    pub cycles: u32,
    /// Duration of a cycle, µs.
    pub period_us: u32,
    /// [`link_protocol::settings_crc32`] of the settings for which the table was checked.
    pub settings_crc32: u32,
}

#[derive(Debug)]
pub(super) struct Upload {
    pub(super) ticket: Ticket,
    pub(super) begin: Begin,
    /// Play that the table follows; `None` if the table becomes active.
    pub(super) follows: Option<Follower>,
    pub(super) table: Vec<u8>,
    pub(super) started: Duration,
    pub(super) deadline: Duration,
    pub(super) phase: UploadPhase,
    /// Begin or Commit must be sent.
    pub(super) due: bool,
    /// Sequence number of the Begin request.
    pub(super) number: u16,
    pub(super) window: Window,
    /// Number of restarts.
    pub(super) renewed: u32,
}

impl Upload {
    /// Request that starts the check after all chunks.
    pub(super) fn last_request(&self) -> Request {
        let upload = self.number;
        match self.follows {
            None => Request::Commit { upload },
            Some(follower) => Request::Follow(Follow {
                upload,
                cycles: follower.cycles,
                period_us: follower.period_us,
                checked: Checked {
                    table_crc32: self.begin.crc32,
                    settings_crc32: follower.settings_crc32,
                },
            }),
        }
    }
}

/// Description of a request, to complete "while …".
pub(super) fn describe(request: &Request) -> &'static str {
    match request {
        Request::Status => "asking for the status",
        Request::Counters => "asking for the robot's counters",
        Request::Configuration => "asking for the configuration",
        Request::Configure(_) => "configuring the robot",
        Request::Servo(_) => "asking for a servo's settings",
        Request::SetServo { .. } => "setting up a servo",
        Request::Trim { .. } => "trimming a servo",
        Request::Begin(_) | Request::Chunk(_) | Request::Commit { .. } | Request::Follow(_) => {
            "uploading the gait"
        }
        Request::Arm => "arming",
        Request::Play(_) => "starting to play",
        Request::Pause { .. } => "pausing",
        Request::Resume => "resuming",
        Request::Stop => "stopping",
        Request::EStop => "e-stopping",
        Request::ClearResets => "clearing the latch of resets",
        Request::CrashMessage => "asking for the crash message",
        Request::Table => "asking for the table",
        Request::SetKey(_) => "setting the key",
        Request::Bench => "asking for presence and short starts",
        Request::PulseRange(_) => "asking for a servo's pulse range",
        Request::SetPulseRange { .. } => "setting a servo's pulse range",
        Request::SetPassive(_) => "setting the passive joint",
        Request::ClearEStop { .. } => "clearing the e-stop",
        Request::EnterBootLoader => "asking for the boot loader",
    }
}
