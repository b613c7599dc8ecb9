//! Tests of the calibration: recordings of every format, and campaigns of an independent simulated laboratory.

// Formulas read like the paper's: r_s, χ. Seeds and counts are small.
#![allow(
    clippy::doc_markdown,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss
)]

mod advice;
mod coverage;
mod dropouts;
mod faults;
mod fits;
mod judged;
mod kinds_of_error;
mod lab;
mod lab_check;
mod lab_runs;
mod measured_joints;
mod messages;
mod mutilated;
mod nuisance;
mod oracle;
mod poses_and_cycles;
mod reported_results;
mod rigid_bodies;
mod systematics;
mod tank;
mod tracks_any_bytes;
mod tracks_formats;
mod tracks_mutations;
mod tracks_mutilated;
mod tracks_poses;
mod tracks_rates;
mod tracks_tables;
mod twin_campaigns;
mod unequal;
mod unusual_campaigns;
mod walls;
mod writers;
