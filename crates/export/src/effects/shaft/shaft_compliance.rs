//! Two masses on an elastic shaft: torsional frequency, damping ratio and the motor's share of the inertia.

use crate::algebra::Body;
use crate::effects::{At, Equations, Flow, Own, Rates, StateNote};
use std::f64::consts::TAU;

/// Two masses on an elastic shaft.
pub struct ShaftCompliance;

impl Equations for ShaftCompliance {
    fn states(&self) -> &'static [StateNote] {
        &[
            (
                "shaft_slip_speed",
                "rad/s",
                "speed of the load relative to the motor",
            ),
            ("shaft_twist", "rad", "twist of the shaft"),
        ]
    }

    fn finish(&self, own: &Own, body: &mut Body, _at: &At, flow: &Flow, rates: &mut Rates) {
        let [share, frequency, damping] = [0, 1, 2].map(|k| own.p[k].clone());
        let (slip_speed, twist) = (&own.extra[0], &own.extra[1]);
        let j_motor = body.name("j_motor", &share * &flow.inertia);
        let j_load = body.name("j_load", (1.0 - share) * &flow.inertia);
        let reduced = &j_motor * &j_load / &flow.inertia;
        let omega = body.name("omega_torsion", TAU * frequency);
        let spring = &omega * twist - 2.0 * damping * slip_speed;
        let shaft = body.name("tau_shaft", reduced * omega * spring);
        let on_motor = &flow.inertia * &rates.omega_mech + &flow.tau_load;
        rates.omega_mech = body.name("omega_motor_rate", (on_motor - &shaft) / j_motor);
        let load_rate = (shaft - &flow.tau_load) / j_load;
        rates.extra = vec![load_rate - &rates.omega_mech, -slip_speed];
    }
}
