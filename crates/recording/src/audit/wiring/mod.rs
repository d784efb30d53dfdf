//! Checks of what hangs where: phases, polarity, sums, supply, speed against slip, second probes.

pub(in crate::audit) mod phases;
pub(in crate::audit) mod probes;
pub(in crate::audit) mod speed;
pub(in crate::audit) mod supply;
pub(in crate::audit) mod zero_sequence;
