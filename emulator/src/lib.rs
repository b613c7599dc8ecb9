//! Runs the firmware image on an emulated RP2040 ([rp2040js]) as a [`Device`](host_link::port::Device) in virtual time. The ELF
//! file is the one that is flashed; UART, PWM, flash, ADC and watchdog are included. The twin runs only the player.
//!
//! The emulator is a Node.js program (folder `board/`). Emulated time advances only during a run command, so sessions over a
//! [`VirtualPort`](host_link::port::VirtualPort) are as deterministic as with the twin.
//!
//! [rp2040js]: https://github.com/wokwi/rp2040js
//!
//! ```
//! use emulator::{Board, BoardConfig, BoardKind};
//!
//! let elsewhere = BoardConfig::of_checkout("no/such/checkout".as_ref(), None, BoardKind::Pico);
//! assert!(elsewhere.missing().is_some());
//! assert!(Board::start(&elsewhere).err().unwrap().to_string().contains("cargo xtask"));
//! ```
//!
//! ```no_run
//! use emulator::{Board, BoardConfig, BoardKind, EmulatedRobot, commission};
//! use host_link::Robot;
//! use twin::{TwinConfig, World};
//!
//! /// Version of this checkout's firmware.
//! fn version(tank: &TwinConfig) -> Result<String, Box<dyn std::error::Error>> {
//!     let board = Board::start(&BoardConfig::of_checkout(".".as_ref(), None, BoardKind::NanoConnect))?;
//!     let robot = EmulatedRobot::new(board, World::new(tank)?)?;
//!     Ok(Robot::connect(commission(robot, tank)?, 1)?.firmware())
//! }
//! ```

mod board;
mod checkout;
mod commission;
mod events;
mod log;
mod robot;

pub use board::{Board, BoardConfig, BoardKind, BoardLine, EmulatorError};
pub use commission::commission;
pub use events::{Edge, Events, Led, Loader, PatchReached, Period, PowerCut, Reset, Servo, Stack};
pub use log::{LogLevel, LogLine};
pub use robot::EmulatedRobot;
