//! The paper, computed, as a person reads it: `figures` and `page` show what the crate `validation` computes and compares.

mod figures;
mod page;

pub(crate) use figures::{Figure, figures};
pub(crate) use page::{deviation, number, open, page, printed};
