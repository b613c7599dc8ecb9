//! The very firmware that is flashed, booted on an emulated RP2040 and driven over its UART by the shipped session.
//!
//! Needs the images of `cargo xtask firmware` and `cargo xtask firmware --board nano-connect --battery-divider 4700`, and the
//! emulator of `cargo xtask emulator` (`npm ci` in `emulator/board`). Where one is missing every test here fails and says which
//! command makes it: a test that is skipped would pass for one that has passed. `cargo xtask test` provides all.

mod ahead;
mod battery;
mod boot;
mod chance;
mod crash;
mod endurance;
mod failsafes;
mod flash;
mod frames;
#[path = "../../../host-link/tests/link/haste.rs"]
mod haste;
mod load;
mod log;
mod noise;
mod passive;
mod presence;
mod promise;
mod radio;
mod resets;
mod rig;
mod scenario;
mod session;
mod settings;
mod slow_uplink;
mod supply;
mod usb;
