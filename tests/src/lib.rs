//! Whole-system tests: what no room can promise alone, in virtual time and without a process. The tests themselves lie in
//! `tests/`; those that run the shipped binary lie beside it, in `cli/tests/`, because only there does Cargo build it first
//! and say where it is.
