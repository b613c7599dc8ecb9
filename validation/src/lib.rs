//! Reproduction of the paper: [`Study`] computes its results, and [`rows`] compares each printed number with them.
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
