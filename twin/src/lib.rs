//! A robot without a robot: the very `gait-player` brain that runs on the chip, behind a port; servos with a rate limit and
//! a dead band; a virtual tank in which it swims by `swimmer-model`; virtual cameras that write tracking files.
//!
//! Time is an argument: [`Twin::advance`]. Over a [`TwinPort`] reading advances it, so a play of an hour takes a second and
//! the same seed gives the same bytes; [`serve`] feeds the real clock to any [`VirtualRobot`] behind a pseudo-terminal or TCP.
//!
//! ```text
//!  bytes ─► Brain ─► pulses ─► Servos ─► joint angles ─► Tank ─► pose ─► Camera ─► tracking file
//! ```

mod camera;
mod config;
mod replay;
mod service;
mod servos;
mod tank;
mod twin;
mod virtual_robot;
mod world;

pub use camera::{Camera, CameraConfig, Frame, MotiveFile, Point, TrackError};
pub use config::{TwinConfig, configuration};
pub use host_link::port::{VirtualPort, WireSpeed};
pub use replay::{Difference, ReplayError, Replayed, replay};
pub use service::serve;
pub use servos::Servos;
pub use tank::Tank;
pub use twin::Twin;
pub use virtual_robot::VirtualRobot;
pub use world::{CycleStart, Recording, World};

/// The host's end of a serial line to a twin, in virtual time.
pub type TwinPort = VirtualPort<Twin>;
