//! The project's own chores: toolchain set-up, firmware build, tests, benches.

fn main() {}
