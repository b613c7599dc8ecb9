//! Optimal control of the three-link swimmer.
