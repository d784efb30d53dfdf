//! What is believed about the motor, and what it predicts.

pub(crate) mod prediction;
pub(crate) mod prior;
pub(crate) mod speed_gain;
pub(crate) mod speed_scale;
