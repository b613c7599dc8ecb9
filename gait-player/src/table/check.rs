//! Checks a table before it may play.
