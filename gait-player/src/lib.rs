//! The robot's brain, free of any HAL: time and bytes in, pulses and bytes out. The same code runs on the chip, in the
//! emulator, in the twin and in a unit test.
//!
//! A shell owns the hardware and drives a [`Brain`]:
//!
//! 1. at start: [`Brain::new`], then [`Brain::load`] with its [`storage::Storage`];
//! 2. whenever bytes came: [`Brain::receive`], with the [`Transport`] they came over;
//! 3. every [`TICK_US`], in step with the servo period: [`Brain::tick`], whose [`Output`] is the only door out;
//! 4. whenever a transmitter has room: [`Brain::transmit`];
//! 5. when [`Output::storage_wanted`] says so: [`Brain::serve_storage`], one bounded step a call.
//!
//! Hosts share three truths with the robot: [`servo::ServoMap`], [`servo::plant`] (what a servo makes of pulses) and
//! [`playback`] (which joint angles a table really gives).
//!
//! ```
//! use gait_player::storage::MemoryStorage;
//! use gait_player::{Boot, Brain, BrainConfig, Identity, Inputs, TICK_US};
//! use link_protocol::{Board, FirmwareVersion, StateName};
//!
//! let firmware = FirmwareVersion { major: 0, minor: 1, patch: 0, commit: *b"abcdef01" };
//! let identity = Identity { firmware, board: Board::Pico };
//! let mut brain = Brain::new(BrainConfig::robot(identity, Boot::power_on(1, 2)));
//! brain.load(&mut MemoryStorage::default()).unwrap();
//! for tick in 1..=50 {
//!     let output = brain.tick(tick * u64::from(TICK_US), &Inputs::default());
//!     // Nobody has armed it: no pulses, whatever time it is.
//!     assert_eq!((output.state, output.pulses_ns), (StateName::Stopped, None));
//! }
//! ```
#![cfg_attr(not(test), no_std)]
// Knots, ticks, microseconds and pulses are bounded where they enter; `as` from a float saturates and NaN becomes 0.
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

pub mod brain;
mod clamp;
pub mod clearance;
mod crash;
pub mod limits;
mod odometer;
pub mod playback;
pub mod ramp;
mod route;
pub mod servo;
mod starts;
pub mod storage;
pub mod table;

pub use brain::{Boot, Brain, BrainConfig, Identity, Inputs, Output, Transport};
pub use crash::CrashNote;
pub use limits::Limits;
pub use starts::ShortStarts;
pub use table::GaitTable;

/// Duration of a tick, µs: the servo period.
pub const TICK_US: u32 = 20_000;
