//! The robot's brain, free of any HAL.
#![cfg_attr(not(test), no_std)]
