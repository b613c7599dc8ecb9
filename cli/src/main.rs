//! The swimmer command: parses, calls, prints, draws.

fn main() {}
