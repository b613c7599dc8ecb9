//! Tracking files to poses, cycles and fitted parameters.
