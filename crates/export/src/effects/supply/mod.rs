//! What lies between the measured inputs and the true ones, and what an inverter decides once a step.

mod frame_rotation;
mod inverter_dead_time;
mod load_gain;
mod phase_voltage_gain;
mod voltage_asymmetry;
mod voltage_gain;
mod voltage_offset;

pub use frame_rotation::FrameRotation;
pub use inverter_dead_time::InverterDeadTime;
pub use load_gain::LoadGain;
pub use phase_voltage_gain::PhaseVoltageGain;
pub use voltage_asymmetry::VoltageAsymmetry;
pub use voltage_gain::VoltageGain;
pub use voltage_offset::VoltageOffset;
