//! The physics of the three-link swimmer and nothing else.
#![cfg_attr(not(test), no_std)]
