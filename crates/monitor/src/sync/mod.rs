//! From samples to phasors of whole supply cycles, and to the speed.

pub(crate) mod encoder;
pub(crate) mod phasor;
pub(crate) mod pll;
pub(crate) mod rotation;
