//! Checks of the clock: gaps, jitter, lost samples, two clocks, channels sampled in turn, no supply to lock to.

pub(crate) mod clock;
pub(crate) mod drift;
pub(crate) mod gap;
pub(crate) mod lost;
pub(crate) mod not_locked;
pub(crate) mod skew;
