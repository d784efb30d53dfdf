//! The speed channel ripples once per turn.

use crate::algebra::Function;
use crate::effects::{Equations, Own, Shown};

/// Ripple of the speed channel.
pub struct SpeedRipple;

impl Equations for SpeedRipple {
    fn outputs(&self, own: &Own, shown: &mut Shown) {
        let theta = &shown.theta_mech;
        let cos = &own.p[0] * theta.of(Function::Cos);
        let sin = &own.p[1] * theta.of(Function::Sin);
        shown.omega_mech = &shown.omega_mech + (cos + sin);
    }
}
