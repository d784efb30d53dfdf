//! What an instrument of unknown make may be off by: class 0.5, whose gain errors spread over a band of 0.5 % to both sides.

/// Standard deviation of the gain of a voltage or current channel.
pub const CHANNEL_GAIN: f64 = 0.003;
/// Standard deviation of the offset of a voltage or current channel, a share of the rated amplitude.
pub const CHANNEL_OFFSET: f64 = 0.003;
/// Standard deviation of the gain of a torque transducer.
pub const TORQUE_GAIN: f64 = 0.005;
/// Standard deviation of the gain of a speed: an encoder against the clock of the recorder.
pub const SPEED_GAIN: f64 = 1e-4;
