//! Interface between the lab page and the workspace: each call of [`calls`] has the name, the keys and the functions of a command
//! of `swimmer`. It contains no logic of its own.
//!
//! It is built twice, once for each kind of worker: `explore` with the optimiser, `drive` with the session and the robot's control
//! code. The lease of a robot therefore never waits for a search, and each module has only the code that its worker calls.
//!
//! The module needs nothing from the page but memory: no clock, no randomness (seeds are arguments), no imports.

pub mod abi;
#[cfg(feature = "calibrate")]
pub mod calibration;
pub mod calls;
#[cfg(feature = "drive")]
pub mod drive;
#[cfg(feature = "explore")]
pub mod explore;
#[cfg(any(feature = "explore", feature = "drive"))]
mod input;
