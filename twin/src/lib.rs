//! A robot without a robot: the brain in a virtual tank, watched by virtual cameras.
