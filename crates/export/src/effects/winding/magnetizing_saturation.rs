//! Magnetizing saturation: `i_m = psi/L_m (1 + k((psi/psi_rated)^n - 1))`.

use crate::algebra::{Body, Expr};
use crate::effects::{Equations, Motor, Own};

/// Magnetizing saturation.
pub struct MagnetizingSaturation;

impl Equations for MagnetizingSaturation {
    /// Moves part of the stator leakage behind the magnetizing branch: the linear motor stays the same at its terminals.
    fn motor(&self, own: &Own, body: &mut Body, motor: &mut Motor) {
        let l_ls = body.name("l_ls_moved", (1.0 - &own.p[2]) * &motor.l_ls);
        let l_m = body.name("l_m_moved", motor.l_s() - &l_ls);
        let k = body.name("moved", (&l_m / &motor.l_m).squared());
        motor.r_r = body.name("r_r_moved", &k * &motor.r_r);
        motor.l_lr = body.name("l_lr_moved", k * motor.l_r() - &l_m);
        (motor.l_ls, motor.l_m) = (l_ls, l_m);
    }

    fn magnetizing(&self, own: &Own, body: &mut Body, x: &Expr) -> (Expr, Expr) {
        let (k, n) = (&own.p[0], &own.p[1]);
        let power = body.name("saturating", x.power(n - 1.0));
        (1.0 + k * (x * &power - 1.0), k * n * power)
    }
}
