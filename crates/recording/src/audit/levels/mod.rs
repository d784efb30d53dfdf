//! Checks of levels: clipped, offset, effective values, units, scales, spikes.

pub(in crate::audit) mod clipped;
pub(in crate::audit) mod clipping;
pub(in crate::audit) mod offset;
pub(in crate::audit) mod rms_values;
pub(in crate::audit) mod scale;
pub(in crate::audit) mod sensor;
pub(in crate::audit) mod spikes;
pub(in crate::audit) mod unit;
