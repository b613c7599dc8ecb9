//! The shipped binary as its users run it. These tests are in this package because only here does Cargo build the binary and pass
//! its path (`CARGO_BIN_EXE_swimmer`), so that no stale binary is ever tested.

mod attack;
mod binary;
mod certify;
mod contract_keys;
mod demo;
#[cfg(target_os = "linux")]
mod departures;
mod emulated;
mod experiment;
mod figures;
mod flash;
#[cfg(target_os = "linux")]
mod go;
#[cfg(unix)]
mod hc05;
#[cfg(unix)]
mod hung_holder;
mod json_goldens;
mod lab;
#[cfg(unix)]
mod laboratory;
mod left_behind;
#[cfg(unix)]
mod natnet_stream;
mod numbers;
mod output_discipline;
mod paper;
mod pictures;
mod playable;
mod playlist;
#[cfg(unix)]
mod port_errors;
#[cfg(unix)]
mod port_in_use;
#[cfg(unix)]
mod progress;
#[cfg(unix)]
mod pseudo_terminal;
#[cfg(unix)]
mod recordings;
#[cfg(unix)]
mod secret;
#[cfg(unix)]
mod setup;
#[cfg(unix)]
mod sweep;
#[cfg(target_os = "linux")]
mod sweep_slurm;
#[cfg(unix)]
mod table;
mod track;
#[cfg(unix)]
mod tracked_play;
mod tracks;
