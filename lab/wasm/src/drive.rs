//! What the drive room calls: the host's session, the twin in the page, and an ear for pages that only watch.
//!
//! A session has no port here: the page carries its bytes, over Web Serial, a WebSocket, or to the twin beside it. What a call
//! takes in bytes begins with the number of the thing and the page's time, `[u32][f64 s]`, little-endian.

mod host;
mod memory_port;
mod overheard;
mod preflight;
mod robot;
mod told;

use std::time::Duration;

use crate::calls::{Call, Lab, Outcome, json, parsed};

/// The calls, by name.
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
    ("overhear open", overheard::open),
    ("overhear step", overheard::step),
    ("overhear close", close),
    ("twin open", robot::open),
    ("twin step", robot::step),
    ("twin stands", robot::stands),
    ("twin close", close),
    ("preflight", preflight::preflight),
];

/// A number, a time and the bytes behind them.
fn step_of(bytes: &[u8]) -> Result<(u32, Duration, &[u8]), String> {
    let short = || "stepping: the page sent less than a number and a time".to_owned();
    let (number, bytes) = bytes.split_first_chunk().ok_or_else(short)?;
    let (seconds, bytes) = bytes.split_first_chunk().ok_or_else(short)?;
    let now = seconds_of(f64::from_le_bytes(*seconds))?;
    Ok((u32::from_le_bytes(*number), now, bytes))
}

/// A time that the page tells.
fn seconds_of(seconds: f64) -> Result<Duration, String> {
    Duration::try_from_secs_f64(seconds)
        .map_err(|why| format!("reading the page's time {seconds} s: {why}"))
}

/// Lets go of a session, a robot or an ear.
fn close(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Numbered { number } = parsed(bytes)?;
    lab.kept.drop(number);
    json(&serde_json::json!({}))
}

/// What names a thing and nothing else.
#[derive(serde::Deserialize)]
struct Numbered {
    number: u32,
}

/// What was opened.
#[derive(serde::Serialize)]
struct Opened {
    number: u32,
}
