//! What is believed about the motor, and what it predicts.

pub(crate) mod free_scale;
pub(crate) mod prediction;
pub(crate) mod prior;
pub(crate) mod speed_gain;
