//! Whole-system tests: the loop on the mock port, pseudo-terminals and the shipped binary.
