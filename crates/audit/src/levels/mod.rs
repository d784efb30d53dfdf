//! Checks of levels: clipped, offset, effective values, units, scales, spikes.

pub(crate) mod clipped;
pub(crate) mod clipping;
pub(crate) mod offset;
pub(crate) mod rms_values;
pub(crate) mod scale;
pub(crate) mod sensor;
pub(crate) mod spikes;
pub(crate) mod unit;
