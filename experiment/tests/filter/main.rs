//! The pose filter under cameras that are worse than a laboratory's.

mod cameras;
mod faults;
mod seeds;
