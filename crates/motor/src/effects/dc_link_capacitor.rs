//! DC link of an inductance, a diode bridge and a capacitor: `L di/dt = U - u` (`i >= 0`), `C du/dt = i - P/U`.

use super::steady::{steady_effect, unchanged};
use super::{Applies, Descriptor, Kind, Parameter, Scale};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "dc-link",
    form: "capacitor",
    kind: Kind::Physics,
    applies: Applies::Inverter,
    parameters: &[
        Parameter::shape(
            "dc_inductance_henry",
            "H",
            Scale::Inductance,
            [0.002, 1.0],
            0.05,
            &[0.05],
        ),
        Parameter::shape(
            "link_resonance_hz",
            "Hz",
            Scale::Own,
            [5.0, 300.0],
            40.0,
            &[15.0, 40.0, 100.0],
        ),
    ],
    symptom: "amplitude error that rings after load steps",
    look_alikes: &["voltage-gain"],
    separating_test: "measure the DC link",
};

/// DC link of an inductance, a diode bridge and a capacitor: `L di/dt = U - u` (`i >= 0`), `C du/dt = i - P/U`.
#[derive(Clone, Copy, Debug)]
pub struct DcLinkCapacitor;

steady_effect!(DcLinkCapacitor, DESCRIPTOR, unchanged);

#[cfg(feature = "std")]
mod dynamic {
    use super::DcLinkCapacitor;
    use crate::dynamic::{Flow, Terminal, Winding};
    use crate::effects::{At, Effect, Hook, Rates};

    impl Effect for DcLinkCapacitor {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Terminal, Hook::Finish]
        }

        fn extra_states(&self) -> usize {
            2
        }

        /// Extra states: deviation of the link voltage from nominal (relative) and link current (A).
        fn terminal(&self, _p: &[f64], at: &At<'_>, _winding: &Winding, terminal: &mut Terminal) {
            terminal.u *= 1.0 + at.extra[0];
        }

        fn finish(&self, p: &[f64], at: &At<'_>, flow: &Flow, rates: &mut Rates<'_>) {
            // Mean output of a three-phase bridge: 3/pi of the line voltage's crest.
            let nominal = 3.0 / core::f64::consts::PI * 3f64.sqrt() * at.rated.voltage;
            let omega = core::f64::consts::TAU * p[1];
            let capacitance = 1.0 / (omega * omega * p[0]);
            let (deviation, i) = (at.extra[0], at.extra[1].max(0.0));
            let power = 1.5 * (flow.terminal.supply * flow.terminal.i.conj()).re;
            let blocked = at.extra[1] <= 0.0 && deviation > 0.0;
            let i_rate = if blocked {
                -omega * at.extra[1]
            } else {
                -deviation * nominal / p[0]
            };
            rates.extra[0] = (i - power / nominal) / (capacitance * nominal);
            rates.extra[1] = i_rate;
        }
    }
}
