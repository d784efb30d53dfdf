//! What instruments make of true outputs.

mod current_gain;
mod current_offset;
mod phase_current_gain;
mod speed_ripple;
mod speed_scale;

pub use current_gain::CurrentGain;
pub use current_offset::CurrentOffset;
pub use phase_current_gain::PhaseCurrentGain;
pub use speed_ripple::SpeedRipple;
pub use speed_scale::SpeedScale;
