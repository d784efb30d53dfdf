//! Dead time and device drop of an inverter: `-V tanh(i_k/I_0)` per phase, decided once per hold period.

use crate::algebra::{Body, Expr, Function, Vector, clarke, phases};
use crate::effects::{Equations, Own};

/// Dead time of an inverter.
pub struct InverterDeadTime;

impl Equations for InverterDeadTime {
    fn held_voltage(&self, own: &Own, body: &mut Body, i_s: &Vector) -> Vector {
        let drop = |i: Expr| -&own.p[0] * (i / &own.p[1]).of(Function::Tanh);
        let [a, b, c] = phases(i_s).map(drop);
        let drops = [
            body.name("dead_time_a", a),
            body.name("dead_time_b", b),
            body.name("dead_time_c", c),
        ];
        clarke(&drops)
    }
}
