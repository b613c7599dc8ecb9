//! Frames of named points and rigid bodies, as cameras see them: live from a motion-capture system or a script, from a recording,
//! or from the digital twin.
//!
//! | source | [`SourceName`] | parser |
//! |---|---|---|
//! | Motive, by NatNet over UDP, unicast or multicast | `natnet[:HOST[,LOCAL]]` | [`natnet::Client`] |
//! | JSON lines over TCP | `tcp:HOST:PORT` | [`JsonLines`] |
//! | JSON lines on standard input | `-` | [`JsonLines`] |
//! | a recording: every format that [`calibrate`] reads, or an MCAP file | `FILE` | [`recording_frames`] |
//! | the cameras of the digital twin | `twin` | [`twin_frame`] |
//!
//! Parsers are sans-IO: bytes and times in, [`Frame`]s out. [`Stream`] runs one of them in a thread of its own, with a bounded
//! queue and a stop flag. [`Survey`] counts rate, latency, blanks and jumps, and [`Recorder`] writes frames to a file.
//!
//! Frames are in the tank's axes: [`Mapping`] converts from those of the source.

// Names of products: NatNet, OptiTrack.
#![allow(clippy::doc_markdown)]

mod error;
mod frame;
mod json_lines;
mod mapping;
pub mod natnet;
mod recorder;
mod recording;
mod source;
mod stream;
mod survey;
mod twin_cameras;

pub use error::{RecordError, SourceError};
pub use frame::{Frame, Marker, RigidBody};
pub use json_lines::{JsonLines, LONGEST_LINE, Malformed};
pub use mapping::Mapping;
pub use recorder::Recorder;
pub use recording::{RecordedFrames, recording_frames};
pub use source::{NatNetAddress, SourceName};
pub use stream::{Outlet, Pace, Reading, Received, Settings, Stream, Tallies};
pub use survey::{BodyCount, PointCount, Summary, Survey};
pub use twin_cameras::{TWIN_BODY, TWIN_REFLECTORS, twin_frame, watch_twin};
