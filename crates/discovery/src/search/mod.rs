//! Which effect is missing: tried, refitted, accepted.

pub(crate) mod inconclusive;
pub(crate) mod refit;
pub(crate) mod screen;
