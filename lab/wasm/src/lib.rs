//! Interface between the lab page and the workspace: each call of [`calls`] has the name, the keys and the functions of a command
//! of `swimmer`. It contains no logic of its own.
//!
//! It is built twice: `explore` with the optimiser, `robot` with the session, the robot's control code and the fit of campaigns. Each
//! worker has an instance of its own, so that the lease of a robot never waits for a search or a fit.
//!
//! The module needs nothing from the page but memory: no clock, no randomness (seeds are arguments), no imports.

pub mod abi;
#[cfg(feature = "robot")]
pub mod calibration;
pub mod calls;
#[cfg(feature = "robot")]
pub mod drive;
#[cfg(feature = "explore")]
pub mod explore;
#[cfg(any(feature = "explore", feature = "robot"))]
mod input;
