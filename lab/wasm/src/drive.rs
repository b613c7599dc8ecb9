//! Calls of the Drive tab: the host's session, the twin in the page, recordings, and a decoder for spectator pages.
//!
//! A session has no port here: the page transports its bytes over Web Serial, over a WebSocket, or to the twin in the page. The
//! binary arguments of a call begin with the number of the object and the page's time, `[u32][f64 s]`, little-endian.

mod events;
mod host;
mod memory_port;
mod overheard;
mod preflight;
mod recordings;
mod robot;

use std::time::Duration;

use crate::calls::{Call, Lab, Outcome, json, parsed};

/// Calls by name.
pub const CALLS: &[(&str, Call)] = &[
    ("session open", host::open),
    ("session step", host::step),
    ("session connect", host::connect),
    ("session request", host::request),
    ("session upload", host::upload),
    ("session cancel upload", host::cancel_upload),
    ("session link", host::link),
    ("session log", host::log),
    ("session close", close),
    ("recordings", recordings::read),
    ("overhear open", overheard::open),
    ("overhear step", overheard::step),
    ("overhear close", close),
    ("twin open", robot::open),
    ("twin step", robot::step),
    ("twin stands", robot::stands),
    ("twin close", close),
    ("preflight", preflight::preflight),
];

/// Splits arguments into number, time and the remaining bytes.
fn step_of(bytes: &[u8]) -> Result<(u32, Duration, &[u8]), String> {
    let short = || "stepping: the page sent less than a number and a time".to_owned();
    let (number, bytes) = bytes.split_first_chunk().ok_or_else(short)?;
    let (seconds, bytes) = bytes.split_first_chunk().ok_or_else(short)?;
    let now = seconds_of(f64::from_le_bytes(*seconds))?;
    Ok((u32::from_le_bytes(*number), now, bytes))
}

/// Converts a time of the page.
fn seconds_of(seconds: f64) -> Result<Duration, String> {
    Duration::try_from_secs_f64(seconds)
        .map_err(|why| format!("reading the page's time {seconds} s: {why}"))
}

/// Releases a session, a robot or a decoder.
fn close(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Numbered { number } = parsed(bytes)?;
    lab.kept.drop(number);
    json(&serde_json::json!({}))
}

/// Arguments with only the number of an object.
#[derive(serde::Deserialize)]
struct Numbered {
    number: u32,
}

/// Number of a new object.
#[derive(serde::Serialize)]
struct Opened {
    number: u32,
}
