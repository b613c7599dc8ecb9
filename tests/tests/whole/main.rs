//! Tests of the whole system: from a gait to the fit of its tracks.

mod link_log;
mod optimised_gait;
mod passive;
mod playlist;
mod real_anchors;
mod real_recordings;
mod robot_clock;
mod traced;
mod unequal;
mod whole_loop;
