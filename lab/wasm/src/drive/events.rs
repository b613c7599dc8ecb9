//! Events of the session as JSON, with the names of the link's types.

use host_link::session::{Event, UploadPhase};
use link_protocol::{HelloReply, Telemetry};
use serde_json::{Value, json};

/// Event as JSON; a connection includes the description of the robot.
pub(super) fn event_json(event: &Event, hello: Option<&HelloReply>) -> Value {
    match event {
        Event::Connected { ticket, restarted } => {
            json!({ "event": "connected", "ticket": ticket.number(), "restarted": restarted, "hello": hello })
        }
        Event::Answered { ticket, reply } => {
            json!({ "event": "answered", "ticket": ticket.number(), "reply": reply })
        }
        Event::StoppedByItself { ticket, cause } => {
            json!({ "event": "stopped_by_itself", "ticket": ticket.number(), "cause": cause })
        }
        Event::Uploaded { ticket, table } => {
            json!({ "event": "uploaded", "ticket": ticket.number(), "table": table })
        }
        Event::Progress { ticket, progress } => {
            let phase = match progress.phase {
                UploadPhase::Begin => "begin",
                UploadPhase::Chunks => "chunks",
                UploadPhase::Commit => "commit",
            };
            json!({ "event": "progress", "ticket": ticket.number(), "phase": phase, "done": progress.done, "total": progress.total })
        }
        Event::Failed { ticket, error } => {
            json!({ "event": "failed", "ticket": ticket.number(), "reason": error.to_string() })
        }
        Event::Telemetry { telemetry, at } => {
            let mut value = telemetry_json(telemetry);
            value["at_s"] = json!(at.as_secs_f64());
            value
        }
    }
}

/// Telemetry as JSON, with state and flags in words.
pub(super) fn telemetry_json(telemetry: &Telemetry) -> Value {
    json!({ "event": "telemetry", "telemetry": telemetry })
}
