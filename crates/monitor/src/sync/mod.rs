//! From samples to phasors of whole supply cycles, whose turns `pll` follows, and to the speed.

pub(crate) mod encoder;
pub(crate) mod phasor;
