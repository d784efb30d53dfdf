//! Stray-load loss: a braking torque `T_s (I/I_N)^2`, smoothed at standstill.

use crate::algebra::{Body, Function};
use crate::effects::{At, Equations, Flow, Own, Rates};

/// Stray-load loss.
pub struct StrayLoadLoss;

impl Equations for StrayLoadLoss {
    fn finish(&self, own: &Own, body: &mut Body, at: &At, flow: &Flow, rates: &mut Rates) {
        let turning = (&at.omega_mech / (at.rated.speed() * 0.005)).of(Function::Tanh);
        let share = flow.winding.i_s.squared() / at.rated.current.squared();
        let tau = body.name("tau_stray_load", &own.p[0] * share * turning);
        rates.omega_mech = &rates.omega_mech - tau / &flow.inertia;
    }
}
