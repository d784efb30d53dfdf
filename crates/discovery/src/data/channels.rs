//! The values of a residual row.

/// Number of output channels: values of a residual row.
pub(crate) const N_CHANNELS: usize = 5;
/// The speed among the channels of a recording.
pub(crate) const SPEED: usize = 3;
