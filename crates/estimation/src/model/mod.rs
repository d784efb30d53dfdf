//! What is believed about the motor, and what it predicts.

pub mod differences;
pub mod free_scale;
pub mod instruments;
pub mod late_speed;
pub mod prediction;
pub mod prior;
pub mod scale_report;
pub mod speed_gain;
pub mod unknown_state;
