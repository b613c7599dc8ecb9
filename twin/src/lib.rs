//! Digital twin of the robot: the `gait-player` brain that runs on the chip, behind a port; servos with rate limit and dead
//! band; a virtual tank that moves the swimmer by `swimmer-model`; and virtual cameras that write tracking files.
//!
//! Time is an argument: [`Twin::advance`]. Reading a [`TwinPort`] advances it, so a play of an hour takes a second, and equal
//! seeds give equal bytes. [`serve`] runs any [`VirtualRobot`] in real time behind a pseudo-terminal or TCP.
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

/// Host end of a serial line to a twin, in virtual time.
pub type TwinPort = VirtualPort<Twin>;
