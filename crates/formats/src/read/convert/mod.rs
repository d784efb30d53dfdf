//! From raw columns to channels in SI: clock, units, delays, encoders, spikes.

mod clock;
mod encoder;
pub(super) mod finish;
mod spikes;
