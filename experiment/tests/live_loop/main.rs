//! The live loop in virtual time, in a simulated laboratory: clocks, monitor, controller.

mod clock;
mod go;
mod monitor;
mod unattended;
mod virtual_lab;
