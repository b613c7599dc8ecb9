//! Reproduction of the paper: [`Study`] computes its results, and [`rows`] compares each printed number with them.
//!
//! ```
//! use validation::{Study, rows};
//!
//! let rows = rows(&Study::new(&|_| ())?);
//! assert!(rows.len() == 78 && rows.iter().all(|row| row.pass != Some(false)));
//! # Ok::<(), validation::StudyError>(())
//! ```

mod rows;
mod study;

pub use rows::{Claim, Output, Printed, Row, Tally, rows};
pub use study::{LARGEST, Lighthill, OtherMethods, Simple, Study, StudyError, UPPER};
