//! Direct collocation against the optimiser's own methods, free and within bounds.

mod bounded;
mod efficiency;
