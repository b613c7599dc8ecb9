//! What a session waits for: a greeting, a request, an upload.

use std::time::Duration;

use link_protocol::{Begin, Follow, HelloReply, Request};

use super::Ticket;
use super::upload::{UploadPhase, Window};

#[derive(Debug)]
pub(super) struct Greeting {
    /// `None`: the session greets by itself for an upload.
    pub(super) ticket: Option<Ticket>,
    pub(super) nonce: u32,
    pub(super) sequence: u16,
    pub(super) tries: u32,
    pub(super) first_sent: Duration,
    pub(super) next_try: Duration,
}

#[derive(Debug)]
#[allow(clippy::large_enum_variant)] // there is one of it
pub(super) enum Link {
    Closed,
    Greeting(Greeting),
    Open(HelloReply),
}

/// Who waits for a request under way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Owner {
    Ticket(Ticket),
    Upload,
}

/// A request that was sent at least once.
#[derive(Debug)]
pub(super) struct Pending {
    pub(super) owner: Owner,
    pub(super) request: Request,
    pub(super) sequence: u16,
    /// Times it was sent since the robot was last heard to work at it.
    pub(super) tries: u32,
    pub(super) first_sent: Duration,
    pub(super) last_sent: Duration,
    pub(super) next_try: Duration,
    /// It was answered, but not with the signature that the key asks for.
    pub(super) unsigned: bool,
}

#[derive(Debug)]
pub(super) struct Upload {
    pub(super) ticket: Ticket,
    pub(super) begin: Begin,
    /// It is to follow the play under way, for so many cycles of so many µs; else it becomes the active table.
    pub(super) follows: Option<(u32, u32)>,
    pub(super) table: Vec<u8>,
    pub(super) started: Duration,
    pub(super) deadline: Duration,
    pub(super) phase: UploadPhase,
    /// Begin or Commit has yet to be sent.
    pub(super) due: bool,
    /// Sequence number of its Begin.
    pub(super) number: u16,
    pub(super) window: Window,
    /// Times it had to begin anew.
    pub(super) renewed: u32,
}

impl Upload {
    /// What asks for the check once all pieces are there.
    pub(super) fn last_request(&self) -> Request {
        let upload = self.number;
        match self.follows {
            None => Request::Commit { upload },
            Some((cycles, period_us)) => Request::Follow(Follow {
                upload,
                cycles,
                period_us,
            }),
        }
    }
}

/// What a request does, to complete "while …".
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
        Request::Arm(_) => "arming",
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
        Request::ClearEStop => "clearing the e-stop",
        Request::EnterBootLoader => "asking for the boot loader",
    }
}
