//! Tests of the host's side of the link.

mod brain;
mod fake_module;
mod haste;
mod hc05;
mod key;
mod matrix;
#[cfg(unix)]
mod pty;
mod replies;
mod scripted;
mod session;
mod sessions;
mod silence;
mod slow_uplink;
mod tank_less;
mod uploads;
