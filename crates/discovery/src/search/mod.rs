//! Which effect is missing: tried, refitted, accepted.

pub(crate) mod accept;
pub(crate) mod inconclusive;
pub(crate) mod off;
pub(crate) mod proof;
pub(crate) mod refit;
pub(crate) mod screen;
