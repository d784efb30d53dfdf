//! Skin effect in the rotor bars: `R_r (1 + k_R abs(s)^n)`, `L_lr (1 - k_L abs(s)^n)`.

use crate::algebra::{Body, Function, Vector};
use crate::effects::{At, Equations, Now, Own};

/// Skin effect in the rotor bars.
pub struct DeepBar;

impl Equations for DeepBar {
    fn parameters(&self, own: &Own, body: &mut Body, at: &At, _i_s: &Vector, now: &mut Now) {
        // Skin depth saturates beyond supply frequency (plugging).
        let slip = at.slip().of(Function::Abs).with(Function::Min, 2.0);
        let f = body.name("skin", slip.power(&own.p[2]));
        let rise = (1.0 + &own.p[0] * &f).at_least(0.05);
        let drop = (1.0 - &own.p[1] * &f).at_least(0.05);
        now.motor.r_r = body.name("r_r_bar", &now.motor.r_r * rise);
        now.motor.l_lr = body.name("l_lr_bar", &now.motor.l_lr * drop);
    }
}
