//! Decoder of the telemetry that a robot sends to another host, for spectator pages.

use link_protocol::{Decoder, Message};
use serde_json::{Value, json};

use super::{Opened, events, step_of};
use crate::calls::{Lab, Outcome, json};

/// Opens a decoder.
pub(super) fn open(lab: &mut Lab, _bytes: &[u8]) -> Outcome {
    json(&Opened {
        number: lab.kept.keep(Decoder::new()),
    })
}

/// Returns the telemetry in received bytes. Signatures are skipped, because a spectator has no key.
pub(super) fn step(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let (number, now, received) = step_of(bytes)?;
    let decoder: &mut Decoder = lab.kept.get(number)?;
    let events: Vec<Value> = received
        .iter()
        .filter_map(|byte| match decoder.push(*byte)?.message {
            Ok(Message::Telemetry(telemetry)) => {
                let mut event = events::telemetry_json(&telemetry);
                event["at_s"] = json!(now.as_secs_f64());
                Some(event)
            }
            _ => None,
        })
        .collect();
    json(&json!({ "events": events }))
}
