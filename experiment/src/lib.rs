//! The live loop: the robot is tracked while it swims, and what is seen decides what it plays next.
//!
//! Sans-IO: poses, events and times in, reports and requests out. Nothing here opens a socket, reads a clock or starts a thread.
//!
//! ```text
//!  frames ──► filter ──► poses ──► clock match ──► monitor ──► reports and departures
//!                          │                          │
//!                          └──────► controller ◄──────┘ ──► requests: play one cycle, stop
//! ```
//!
//! - [`PoseFilter`]: poses of the middle link from frames of the cameras, through swaps, ghosts and blanks, extrapolated over the
//!   latency ([`FilterEvent`]: found, lost, jumped).
//! - [`Pose`]: tracked pose of the middle link, with its time and its standard deviations.
//! - [`Course`]: predicted shapes and poses of a play or of a cycle over time.
//! - [`match_clocks`]: offset between the clocks of robot and cameras, from arrival times ([`Delays`]) and the oscillation within
//!   a cycle; [`CameraDelay`] does so play by play, and dates the poses.
//! - [`Monitor`]: one [`CycleReport`] a cycle: displacement and net turn with intervals against the prediction, and a
//!   [`Departure`] if the robot does not follow it. Its [`Evaluation`] may take seconds, so it is a request of its own.
//! - [`TrackedPlay`]: a play of one gait under the monitor, with the motion over all its cycles.
//! - [`Controller`]: drives to poses or holds a heading ([`Goal`]). After each cycle it chooses the next ([`Request`]) and learns
//!   the robot's gains and drift; it ends with a named reason ([`Ending`]).
//! - [`adaptive`]: the next gait of a campaign that calibrates χ and r_s, by the information per second of tank time.
//! - [`unattended`]: an experiment of many trials without an operator: plan, run, journal, comparison.
//!
//! All times of one loop are on one clock: that of the poses, which the caller maps to the host's clock.

// Formulas in the docs read like the paper's: r_s.
#![allow(clippy::doc_markdown)]

pub mod adaptive;
mod clock;
mod controller;
mod course;
mod delays;
mod event;
mod filter;
mod fit;
mod learning;
mod monitor;
mod pose;
mod tracked_play;
pub mod unattended;

pub use clock::{CameraDelay, ClockMatch, match_clocks};
pub use controller::{Controller, Ending, Goal, Options, Request, Target};
pub use course::Course;
pub use delays::Delays;
pub use event::{Event, Interruption};
pub use filter::{FilterCounts, FilterEvent, FilterOptions, JointAngle, PoseFilter};
pub use monitor::{
    CycleReport, Departure, Evaluated, Evaluation, Likeness, MeasuredMotion, Monitor,
};
pub use pose::Pose;
pub use tracked_play::{GaitOnRobot, NearWalls, TankWalls, TrackedPlay};
