//! LC filter: `L_f di/dt = v - u`, `du/dt = (2 pi f_r)^2 L_f (i - i_m)`.

use crate::effect::steady::{steady_effect, unchanged};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "series-inductance",
    form: "lc-filter",
    kind: Kind::Physics,
    applies: Applies::Inverter,
    parameters: &[
        Parameter::shape(
            "series_inductance_henry",
            "H",
            Scale::Inductance,
            [0.001, 0.3],
            0.02,
            &[0.02],
        ),
        Parameter::shape(
            "filter_resonance_hz",
            "Hz",
            Scale::Own,
            [200.0, 2500.0],
            1000.0,
            &[400.0, 700.0, 1000.0, 1400.0, 2000.0],
        )
        .resonance(),
    ],
    symptom: "leakage seems larger than it is, ringing at the filter resonance",
    look_alikes: &["stator_leakage_henry"],
    separating_test: "two operating frequencies, or a known filter",
};

steady_effect!(LcFilter, DESCRIPTOR, unchanged);

#[cfg(feature = "std")]
mod dynamic {
    use super::LcFilter;
    use crate::dynamic::{Flow, Terminal, Winding};
    use crate::effect::{At, Effect, Hook, Rates};
    use num_complex::Complex64;

    impl Effect for LcFilter {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Terminal, Hook::Finish]
        }

        fn extra_states(&self) -> usize {
            4
        }

        /// Extra states: filter current (A) and capacitor voltage (V), both vectors.
        fn terminal(&self, _p: &[f64], at: &At<'_>, _winding: &Winding, terminal: &mut Terminal) {
            terminal.u = Complex64::new(at.extra[2], at.extra[3]);
        }

        fn finish(&self, p: &[f64], at: &At<'_>, flow: &Flow, rates: &mut Rates<'_>) {
            let i = Complex64::new(at.extra[0], at.extra[1]);
            let u = Complex64::new(at.extra[2], at.extra[3]);
            let omega = core::f64::consts::TAU * p[1];
            let i_rate = (flow.terminal.supply - u) / p[0];
            let u_rate = (i - flow.terminal.i) * (omega * omega * p[0]);
            rates
                .extra
                .copy_from_slice(&[i_rate.re, i_rate.im, u_rate.re, u_rate.im]);
        }
    }
}
