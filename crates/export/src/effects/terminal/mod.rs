//! Between the supply and the winding.

mod core_loss;
mod core_loss_air_gap;
mod dc_link;
mod dc_link_capacitor;
mod lc_filter;
mod stator_asymmetry;

pub use core_loss::CoreLoss;
pub use core_loss_air_gap::CoreLossAirGap;
pub use dc_link::DcLink;
pub use dc_link_capacitor::DcLinkCapacitor;
pub use lc_filter::LcFilter;
pub use stator_asymmetry::StatorAsymmetry;
