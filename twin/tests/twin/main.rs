//! Digital twin over its link: displacements, recordings, and replay of its link logs.

mod play;
mod recording;
mod replay;
#[cfg(unix)]
mod service;
mod swim;
