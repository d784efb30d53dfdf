//! Checks of what hangs where: phases, polarity, sums, supply, its frequency, speed against slip and at the start, second probes.

pub(crate) mod frequency;
pub(crate) mod phases;
pub(crate) mod probes;
pub(crate) mod speed;
pub(crate) mod start;
pub(crate) mod supply;
pub(crate) mod zero_sequence;
