//! The contract of the wire: messages, frames, protocol version.
#![cfg_attr(not(test), no_std)]
