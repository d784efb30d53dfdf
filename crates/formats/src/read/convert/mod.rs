//! From raw columns to channels in SI: clock, units, delays, encoders, spikes.

mod clock;
mod delay;
mod encoder;
pub(super) mod finish;
mod spikes;
