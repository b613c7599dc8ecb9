//! The model against its numbers, against independent formulations, and against the symmetries of the physics.
// Formulas in comments read like the paper's; what must be equal to the last bit is compared so.
#![allow(clippy::doc_markdown, clippy::float_cmp)]

mod balance;
mod crossing;
mod derivatives;
mod gaits;
mod hyper_dual;
mod media;
mod numbers;
mod precision;
mod random;
mod resistive_force;
mod stroke;
mod swimmer;
mod symmetry;

/// Fails unless `value` is `expected` within `tolerance`, and says by how much.
#[track_caller]
fn near(what: &str, value: f64, expected: f64, tolerance: f64) {
    let error = (value - expected).abs();
    assert!(
        error <= tolerance,
        "{what}: {value:.15e} is {error:.2e} off {expected:.15e}, allowed {tolerance:.1e}"
    );
}
