//! The pose filter under cameras that are worse than a laboratory's.

#[path = "../cameras/mod.rs"]
mod cameras;
mod faults;
mod seeds;
mod swum;
