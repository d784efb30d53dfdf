//! Resistances and inductances of the windings.

mod deep_bar;
mod double_cage;
mod heating;
mod leakage_saturation;
mod magnetizing_saturation;
mod rotor_asymmetry;
mod series_inductance;

pub use deep_bar::DeepBar;
pub use double_cage::DoubleCage;
pub use heating::{RotorHeating, StatorHeating};
pub use leakage_saturation::{LeakageSaturation, iterated};
pub use magnetizing_saturation::MagnetizingSaturation;
pub use rotor_asymmetry::RotorAsymmetry;
pub use series_inductance::SeriesInductance;
