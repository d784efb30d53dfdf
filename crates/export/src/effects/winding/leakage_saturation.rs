//! Leakage saturation: both leakages times `1 - k x^2/(1 + x^2)`, `x = abs(i_s)/i_ref`.

use crate::algebra::{Body, Expr, Vector};
use crate::effects::flow::linear_currents;
use crate::effects::{At, Equations, Now, Own};

/// Leakage saturation.
pub struct LeakageSaturation;

/// Scales both leakages by a factor that depends on the squared stator current, which depends on them: three rounds.
pub fn iterated(
    body: &mut Body,
    at: &At,
    i_s: &Vector,
    now: &mut Now,
    factor: impl Fn(Expr) -> Expr,
) {
    let (l_ls, l_lr) = (now.motor.l_ls.clone(), now.motor.l_lr.clone());
    let mut i_s = i_s.clone();
    for _ in 0..3 {
        let f = body.name("leakage_factor", factor(i_s.squared()));
        now.motor.l_ls = body.name("l_ls_now", &l_ls * &f);
        now.motor.l_lr = body.name("l_lr_now", &l_lr * &f);
        let (current, _) = linear_currents(body, &now.motor, &at.psi_s, &at.psi_r);
        i_s = body.vector("i_s_round", &current);
    }
}

impl Equations for LeakageSaturation {
    fn parameters(&self, own: &Own, body: &mut Body, at: &At, i_s: &Vector, now: &mut Now) {
        let (drop, reference) = (&own.p[0], own.p[1].squared());
        iterated(body, at, i_s, now, |i2| {
            (1.0 - drop * &i2 / (&reference + &i2)).at_least(0.05)
        });
    }
}
