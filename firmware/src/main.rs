//! Firmware for the RP2040: the hardware shell of `gait-player`. It moves bytes and time between the chip and
//! `gait_player::Brain`; all decisions are made there.
//!
//! ```text
//!  thread executor                        interrupt executor (SWI_IRQ_1), above the thread and USB, below the UART
//!  ┌────────────────┐ LinkBuffers ┌──────────────────────────────────────────────┐
//!  │ uart::receive  │ ──────────► │ control, at every 20 ms tick and when bytes  │ ──► servos (PWM slice)
//!  │ uart::send     │ ◄────────── │ came: Brain::receive, tick, transmit         │ ──► LED, watchdog
//!  │ usb::receive   │   another   │ only while stopped: Brain::serve_storage,    │ ◄─► storage (flash)
//!  │ usb::send, run │ ◄─────────► │ and the way to the boot loader               │ ──► boot ROM
//!  │ battery::sample│             └──────────────────────────────────────────────┘
//!  │ watchdog::beat │                                  ▲ presence (jumper)
//!  │ button::watch  │ ─────────────────────────────────┘ on the Pico: BOOTSEL, while pulses are off
//!  └────────────────┘
//! ```
//!
//! There is one file per peripheral; `board.rs` has the pins, `control.rs` the main loop.

#![cfg_attr(target_os = "none", no_std, no_main)]
// `usize` is 32 bits wide on the chip.
#![allow(clippy::cast_possible_truncation)]

#[cfg(target_os = "none")]
mod battery;
#[cfg(target_os = "none")]
mod binary_info;
#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod boot;
#[cfg(target_os = "none")]
mod build_setting;
#[cfg(target_os = "none")]
mod control;
#[cfg(target_os = "none")]
mod crash;
#[cfg(target_os = "none")]
mod led;
#[cfg(target_os = "none")]
mod link_buffers;
#[cfg(target_os = "none")]
mod presence;
#[cfg(target_os = "none")]
mod random;
#[cfg(target_os = "none")]
mod retained_ram;
#[cfg(target_os = "none")]
mod servos;
#[cfg(target_os = "none")]
mod stack_guard;
#[cfg(target_os = "none")]
mod start;
#[cfg(target_os = "none")]
mod storage;
#[cfg(target_os = "none")]
mod uart;
#[cfg(target_os = "none")]
mod usb;
#[cfg(target_os = "none")]
mod watchdog;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!(
        "The firmware runs on the RP2040 only: `cargo xtask firmware` builds it, `cargo xtask flash` flashes it."
    );
}
