//! The values of a residual row.

/// Number of output channels: values of a residual row.
pub const N_CHANNELS: usize = 5;
/// The speed among the channels of a recording.
pub const SPEED: usize = 3;
