//! Every number, table and figure of the paper, computed: `study` does the computing, `rows` holds each printed number against
//! it, `figures` and `page` show it.

mod figures;
mod page;
mod rows;
mod study;

pub(crate) use figures::{Figure, figures};
pub(crate) use page::{deviation, number, page, printed};
pub(crate) use rows::{Printed, Row, rows};
pub(crate) use study::Study;
