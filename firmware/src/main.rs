//! The thin RP2040 shell around gait-player.

fn main() {}
