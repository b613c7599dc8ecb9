//! The live loop in virtual time, in a simulated laboratory: clocks, monitor, controller.

#[path = "../cameras/mod.rs"]
mod cameras;
mod clock;
mod go;
mod monitor;
mod unattended;
mod virtual_lab;
