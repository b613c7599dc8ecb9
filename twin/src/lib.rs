//! A robot without a robot: the very `gait-player` brain that runs on the chip, behind a port; servos with a rate limit and
//! a dead band; a virtual tank in which it swims by `swimmer-model`; virtual cameras that write tracking files.
//!
//! Time is an argument: [`Twin::advance`]. Over a [`TwinPort`] reading advances it, so a play of an hour takes a second and
//! the same seed gives the same bytes; [`serve`] feeds the real clock to any [`VirtualRobot`] behind a pseudo-terminal or TCP.
//!
//! ```text
//!  bytes ─► Brain ─► pulses ─► Servos ─► joint angles ─► Tank ─► pose ─► Camera ─► tracking file
//! ```
//!
//! ```
//! use std::ops::ControlFlow;
//! use std::time::Duration;
//! use gait_player::GaitTable;
//! use host_link::Robot;
//! use swimmer_files::{AnyGait, SwimmerFile};
//! use swimmer_model::{Gait, Model, Tolerance, swim};
//! use twin::{Twin, TwinConfig, TwinPort, WireSpeed};
//!
//! let file = SwimmerFile::preset("robot").unwrap();
//! let twin = Twin::new(TwinConfig::new(&file, 1).with_ideal_servos())?;
//! let mut robot = Robot::connect(TwinPort::new(twin, WireSpeed::robot()), 1).unwrap();
//!
//! let circle = AnyGait::circle(1.2);
//! let table = GaitTable::from_fn(128, |u| circle.at(u).phi.into()).unwrap();
//! robot.upload(table.bytes(), Duration::from_secs(60), |_| ControlFlow::Continue(())).unwrap();
//! robot.arm(false).unwrap();
//! robot.play(1, Duration::from_secs(10), false).unwrap();
//! robot.wait_until_finished(|_| ControlFlow::Continue(())).unwrap();
//!
//! let twin = robot.into_port();
//! let begun = twin.device().cycle_starts()[0].pose;
//! let swum = (begun.inverse() * twin.device().pose()).position().norm();
//! let designed = swim(&Model::new(&file.swimmer)?, &circle, &Tolerance::default()).displacement.norm();
//! assert!(swum > 0.5 * designed, "{swum} of {designed}");
//! # Ok::<(), swimmer_model::InvalidSwimmer>(())
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
pub use config::{TwinConfig, configuration, is_configured_as};
pub use host_link::port::{VirtualPort, WireSpeed};
pub use replay::{Difference, Reason, ReplayError, Replayed, Verdict, replay};
pub use service::serve;
pub use servos::Servos;
pub use tank::Tank;
pub use twin::Twin;
pub use virtual_robot::VirtualRobot;
pub use world::{CycleStart, Recording, World};

/// The host's end of a serial line to a twin, in virtual time.
pub type TwinPort = VirtualPort<Twin>;
