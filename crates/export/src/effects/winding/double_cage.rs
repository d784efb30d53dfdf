//! A second rotor cage, equal to the single cage at low slip: `R_1 = R_r/(1-a)`, `R_2 = R_r/a`, `L_2 = lambda L_lr`.

use crate::algebra::{Body, Expr, Vector};
use crate::effects::{At, Cage, Equations, Flow, Motor, Now, Own, Rates, StateNote};

/// A second rotor cage.
pub struct DoubleCage;

/// Both cages: resistances and leakages `(r_1, l_1, r_2, l_2)`.
fn cages(own: &Own, body: &mut Body, motor: &Motor) -> [Expr; 4] {
    // Below this share the second cage's time constant is too short for the integration step.
    let a = body.name("second_cage_share", own.p[0].at_least(0.03));
    let rest = body.name("first_cage_share", 1.0 - &a);
    let l_2 = body.name("l_lr_second", &own.p[1] * &motor.l_lr);
    let l_1 = (&motor.l_lr - a.squared() * &l_2) / rest.squared();
    let l_1 = body.name("l_lr_first", l_1.at_least(&motor.l_lr * 0.05));
    [
        body.name("r_r_first", &motor.r_r / rest),
        l_1,
        body.name("r_r_second", &motor.r_r / a),
        l_2,
    ]
}

impl Equations for DoubleCage {
    fn states(&self) -> &'static [StateNote] {
        &[
            ("psi_cage_alpha", "V s", "flux linkage of the second cage"),
            ("psi_cage_beta", "V s", "flux linkage of the second cage"),
        ]
    }

    fn parameters(&self, own: &Own, body: &mut Body, _at: &At, _i_s: &Vector, now: &mut Now) {
        let [r_1, l_1, _, l] = cages(own, body, &now.motor);
        (now.motor.r_r, now.motor.l_lr) = (r_1, l_1);
        let psi = Vector::new(&own.extra[0], &own.extra[1]);
        now.cage = Some(Cage { l, psi });
    }

    fn finish(&self, own: &Own, body: &mut Body, at: &At, flow: &Flow, rates: &mut Rates) {
        let [_, _, r_2, l_2] = cages(own, body, &at.motor);
        let psi = Vector::new(&own.extra[0], &own.extra[1]);
        let psi_m = &at.psi_s - &(&flow.winding.i_s * &at.motor.l_ls);
        let spin = psi.quarter(&flow.n_p * &at.omega_mech);
        let rate = &spin - &(&(&psi - &psi_m) * &(r_2 / l_2));
        rates.extra = vec![rate.re, rate.im];
    }
}
