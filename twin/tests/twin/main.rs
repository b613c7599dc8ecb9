//! The twin over its link: how it swims, what it records, and whether a log of its frames replays the same set-points.

mod play;
mod recording;
mod replay;
#[cfg(unix)]
mod service;
mod swim;
