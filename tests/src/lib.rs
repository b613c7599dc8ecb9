//! Whole-system tests: properties of several crates together, in virtual time and without a process. The tests themselves lie in
//! `tests/`; those that run the shipped binary are in `cli/tests/`, because only there does Cargo build it first and pass its
//! path.
