//! What a tick costs.
fn main() {}
