//! Torques on the shaft.

mod coulomb_friction;
mod load_pulsation;
mod shaft_compliance;
mod stray_load_loss;
mod windage;

pub use coulomb_friction::CoulombFriction;
pub use load_pulsation::LoadPulsation;
pub use shaft_compliance::ShaftCompliance;
pub use stray_load_loss::StrayLoadLoss;
pub use windage::Windage;
