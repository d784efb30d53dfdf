//! Checks of the clock: gaps, jitter, two clocks, channels sampled in turn, no supply to lock to.

pub(in crate::audit) mod clock;
pub(in crate::audit) mod drift;
pub(in crate::audit) mod gap;
pub(in crate::audit) mod not_locked;
pub(in crate::audit) mod skew;
