//! The equivalent circuit of a squirrel-cage motor with two rotor cages, per unit of rated voltage and rated current.
//!
//! ```text
//!  o--[R_s]--[j X g]--+--------+--------[j X g]--+-------[R_1/s]--[j X_1 g]--+
//!                     |        |                 |                           |
//!                  [1/G_c]   [j X_m]             +-------[R_2/s]-------------+
//!                     |        |                                             |
//!  o------------------+--------+---------------------------------------------+
//! ```
//!
//! Stator leakage and the leakage common to both cages are equal: their split cannot be seen at the terminals. `g(I)` is the
//! library's leakage saturation, 1 at rated current. Torque at the shaft is the air gap's less windage and stray-load loss.
//! Source of the double-cage T circuit: Pedra and Sainz, IEE Proc. Electr. Power Appl. 153(2), 2006,
//! doi:10.1049/ip-epa:20045155.

mod breakdown;
mod cages;
mod parameters;
mod point;

pub use breakdown::breakdown_slip;
pub use cages::Cages;
pub use parameters::{Circuit, Logs, PARAMETERS, Place};
pub(crate) use point::REFERENCE_CURRENT;
pub use point::{Point, Winding};

/// The rated point on which a circuit in per unit stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rating {
    /// Shaft power over rated apparent power: efficiency times power factor.
    pub power: f64,
    /// Rated slip as printed, above 0.
    pub slip: f64,
}

impl Rating {
    /// Rated shaft torque in per unit of rated apparent power over synchronous speed.
    pub fn torque(&self) -> f64 {
        self.power / (1.0 - self.slip)
    }
}
