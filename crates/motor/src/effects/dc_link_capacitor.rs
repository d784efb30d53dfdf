//! DC link of an inverter that a diode bridge charges.
//!
//! DC link of a six-pulse diode bridge, an inductance and a capacitor, the motor's voltage in proportion to it:
//! `L di/dt = u6(t, phi) - u` (`i >= 0`), `C du/dt = i - P/U`, motor voltage `v u/U`, `U` the bridge's mean voltage.
//!
//! The phase counts within a sixth of the grid's period: it and pi/3 more are the same.

use crate::effect::steady::{steady_effect, unchanged};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "dc-link",
    form: "capacitor",
    kind: Kind::Physics,
    applies: Applies::Inverter,
    parameters: &[
        Parameter::shape(
            "dc_capacitance_farad",
            "F",
            Scale::Capacitance,
            [0.3, 200.0],
            7.0,
            &[3.5, 10.0, 30.0],
        ),
        Parameter::shape(
            "dc_inductance_henry",
            "H",
            Scale::Inductance,
            [0.0007, 0.5],
            0.014,
            &[0.008, 0.03],
        ),
        Parameter::shape(
            "grid_phase_rad",
            "rad",
            Scale::Own,
            [0.8, 2.4],
            1.5,
            &[1.22, 1.57, 1.92],
        ),
        Parameter {
            unit: "Hz",
            ..Parameter::form("grid_frequency_hz", [40.0, 70.0], &[50.0, 60.0])
        },
    ],
    symptom: "amplitude error that grows with load, rings after load steps and ripples at six times the grid frequency",
    look_alikes: &["voltage-gain"],
    separating_test: "measure the DC link",
};

steady_effect!(DcLinkCapacitor, DESCRIPTOR, unchanged);

#[cfg(feature = "std")]
mod dynamic {
    use super::DcLinkCapacitor;
    use crate::dynamic::{Flow, Terminal, Winding};
    use crate::effect::{At, Effect, Hook, Rates};
    use core::f64::consts::{FRAC_PI_3, FRAC_PI_6, PI, TAU};

    /// Rectified voltage over its mean: cosine crests of 60 degrees.
    fn six_pulse(angle: f64) -> f64 {
        FRAC_PI_3 * (angle.rem_euclid(FRAC_PI_3) - FRAC_PI_6).cos()
    }

    impl Effect for DcLinkCapacitor {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Terminal, Hook::Finish]
        }

        fn extra_states(&self) -> usize {
            2
        }

        /// Extra states: deviation of the link voltage from its mean (relative) and link current (A).
        fn terminal(&self, _p: &[f64], at: &At<'_>, _winding: &Winding, terminal: &mut Terminal) {
            terminal.u *= 1.0 + at.extra[0];
        }

        fn finish(&self, p: &[f64], at: &At<'_>, flow: &Flow, rates: &mut Rates<'_>) {
            let [capacitance, inductance, phase, frequency] = [p[0], p[1], p[2], p[3]];
            // Mean output of a three-phase bridge: 3/pi of the line voltage's crest.
            let mean = 3.0 / PI * 3f64.sqrt() * at.rated.voltage;
            let rectified = six_pulse(TAU * frequency * at.t + phase);
            let (u, i) = (1.0 + at.extra[0], at.extra[1]);
            let power = 1.5 * (flow.terminal.supply * flow.terminal.i.conj()).re;
            let blocked = i <= 0.0 && rectified < u;
            rates.extra[0] = (i.max(0.0) - power / mean) / (capacitance * mean);
            rates.extra[1] = if blocked {
                // What an integration step left below zero dies out in a millisecond.
                -1e3 * i
            } else {
                (rectified - u) * mean / inductance
            };
        }
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn the_bridge_has_the_mean_and_crest_of_six_pulses() {
            let n = 6000;
            let samples = (0..n).map(|k| six_pulse(TAU * f64::from(k) / f64::from(n)));
            let mean = samples.clone().sum::<f64>() / f64::from(n);
            // The rectangle rule over a period is exact to the square of its step.
            assert!((mean - 1.0).abs() < 1e-5);
            let crest = samples.fold(0.0, f64::max);
            assert!((crest - FRAC_PI_3).abs() < 1e-6);
        }
    }
}
