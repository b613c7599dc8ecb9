//! Robot player, free of any HAL: time and bytes in, pulses and bytes out. The same code runs on the chip, in the emulator, in
//! the digital twin and in unit tests.
//!
//! A shell owns the hardware and drives a [`Brain`]:
//!
//! 1. at start: [`Brain::new`], then [`Brain::load`] with its [`storage::Storage`];
//! 2. whenever bytes arrive: [`Brain::receive`], with their [`Transport`];
//! 3. every [`TICK_US`], in step with the servo period: [`Brain::tick`], whose [`Output`] is the only path to the hardware;
//! 4. whenever a transmitter is free: [`Brain::transmit`];
//! 5. if [`Output::storage_wanted`] is set: [`Brain::serve_storage`], one bounded step per call.
//!
//! Hosts share three modules with the robot: [`servo::ServoMap`], [`servo::plant`] (response of a servo to its pulses) and
//! [`playback`] (joint angles that a table produces).
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
// Knots, ticks, microseconds and pulses are checked on entry. `as` from a float saturates, and NaN becomes 0.
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
