//! The very firmware that is flashed, booted on an emulated RP2040 and driven over its UART by the shipped session.
//!
//! Needs the ELF of `cargo xtask firmware` and the emulator of `cargo xtask emulator` (`npm ci` in `emulator/board`); where one
//! is missing every test here says so and does nothing. `cargo xtask test` provides both.

mod ahead;
mod battery;
mod boot;
mod chance;
mod crash;
mod endurance;
mod failsafes;
mod flash;
mod frames;
mod load;
mod log;
mod noise;
mod promise;
mod radio;
mod resets;
mod rig;
mod scenario;
mod session;
mod settings;
