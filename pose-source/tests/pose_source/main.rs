//! Sources from end to end: bytes of a protocol or a file in, frames out.

// Names of products: NatNet.
#![allow(clippy::doc_markdown)]

mod frames;
mod natnet_stream;
mod natnet_udp;
mod recordings;
mod tcp;
