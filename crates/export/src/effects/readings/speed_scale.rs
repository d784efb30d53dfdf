//! The speed channel shows `scale` times the truth.

use crate::effects::{Equations, Own, Shown};

/// Scale of the speed channel.
pub struct SpeedScale;

impl Equations for SpeedScale {
    fn outputs(&self, own: &Own, shown: &mut Shown) {
        shown.omega_mech = &shown.omega_mech * (1.0 + &own.p[0]);
    }
}
