//! The paper as a test: [`Study`] computes what it shows, and [`rows`] holds each number that it prints against that.
//!
//! ```
//! use validation::{Study, rows};
//!
//! let rows = rows(&Study::new(&|_| ())?);
//! assert!(rows.len() == 52 && rows.iter().all(|row| row.pass != Some(false)));
//! # Ok::<(), validation::StudyError>(())
//! ```

mod rows;
mod study;

pub use rows::{Printed, Row, rows};
pub use study::{LARGEST, Lighthill, Simple, Study, StudyError, UPPER};
