//! NatNet, the protocol in which Motive streams: [`Client`] reads it, [`Server`] speaks it for the digital twin. Both are sans-IO.
//!
//! The client requests bitstream 4.1, which Motive honours for unicast. A multicast stream has Motive's own version: 3.0, 3.1, 4.0 and
//! 4.1 are read, and others are refused by name.

mod client;
mod description;
mod names;
mod server;
mod socket;

use natnet::Version;

pub use client::Client;
pub use server::{Datagram, Scene, Server};
pub(crate) use socket::receive;
pub use socket::{NatNetSocket, SocketFailure};

/// UDP port of commands.
pub const COMMAND_PORT: u16 = 1510;
/// UDP port of multicast frames.
pub const DATA_PORT: u16 = 1511;
/// Motive's multicast group.
pub const GROUP: [u8; 4] = [239, 255, 42, 99];
/// The bitstream that is requested.
const REQUESTED: Version = Version::V4_1;
/// Bits of a labeled marker's parameters.
const OCCLUDED: u16 = 0x01;
const POINT_CLOUD_SOLVED: u16 = 0x02;
const HAS_MODEL: u16 = 0x08;
const UNLABELED: u16 = 0x10;

/// Error of a NatNet stream.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NatNetError {
    /// The stream has a version that is not read.
    #[error(
        "{application} {server} streams NatNet {stream}, which is not read; read are 3.0, 3.1, 4.0 and 4.1. {}",
        advice(*multicast)
    )]
    RefusedVersion {
        /// The server's application.
        application: String,
        /// Its version.
        server: String,
        /// The bitstream's version, as `4.4`.
        stream: String,
        /// It streams by multicast.
        multicast: bool,
    },
    /// Frames do not have the layout of the announced version.
    #[error(
        "{count} frames in a row are not NatNet {stream} ({reason}); the server announced NatNet {own}: if Motive's version is newer \
         than 3.1, set its bitstream to 4.1"
    )]
    Undecodable {
        /// Number of undecodable frames.
        count: u32,
        /// The bitstream's version.
        stream: String,
        /// The version that the server announced.
        own: String,
        /// The decoder's words for the last one.
        reason: String,
    },
    /// Nothing came from the server's command port.
    #[error(
        "{server} does not reply to NatNet requests; is Motive running there with streaming enabled, and does the firewall let UDP \
         1510 and 1511 pass?"
    )]
    NoReply {
        /// The address.
        server: String,
    },
    /// No multicast frame came, so the server is unknown.
    #[error(
        "no NatNet stream at {group}; enable streaming in Motive, or name its computer and the local interface: natnet:HOST,LOCAL"
    )]
    NoStream {
        /// Group and port.
        group: String,
    },
}

fn advice(multicast: bool) -> &'static str {
    if multicast {
        "Set Motive to unicast (Streaming pane, Transmission Type): then 4.1 is requested and streamed"
    } else {
        "Set Motive's bitstream to 4.1 (Streaming pane), or use a version of Motive that can"
    }
}

/// A version as people write it.
fn short(version: Version) -> String {
    format!("{}.{}", version.major, version.minor)
}
