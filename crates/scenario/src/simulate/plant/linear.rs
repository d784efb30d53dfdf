//! The published linear model (33) behind three-phase terminals.
//!
//! Its q axis lies on the voltage, so that voltage frame and rotor-flux frame are one and the same.

use super::presence::Presence;
use super::waveform::Waveform;
use crate::simulate::Truth;
use crate::{Fault, Parameter, Scenario, Start, Target};
use motor::dynamic::phases;
use num_complex::Complex64;
use parity::linear_plant::{LinearParams, LinearState, LinearStep};

#[derive(Clone)]
pub(in crate::simulate) struct Linear {
    healthy: LinearParams,
    params: LinearParams,
    step: LinearStep,
    t_step: f64,
    state: LinearState,
    theta_mech: f64,
    presence: Presence,
    waveform: Waveform,
}

impl Linear {
    pub(super) fn new(scenario: &Scenario) -> Linear {
        let file = &scenario.motor;
        let mut mechanics = file.mechanics;
        mechanics.load_friction *= scenario.load.friction_factor;
        let field_current = file.nominal_field_current();
        let healthy = LinearParams::new(&file.parameters, &mechanics, field_current);
        let t_step = scenario.t_sample() / f64::from(scenario.steps_per_sample());
        let mut plant = Linear {
            healthy,
            params: healthy,
            step: healthy.discretise(t_step),
            t_step,
            state: LinearState::default(),
            theta_mech: 0.0,
            presence: Presence::default(),
            waveform: Waveform::new(&scenario.supply),
        };
        plant.switch_faults(&scenario.faults, 0.0);
        if scenario.start == Start::Running {
            plant.state = plant.params.steady_state(plant.waveform.amplitude(0.0));
        }
        plant
    }

    pub(super) fn switch_faults(&mut self, faults: &[Fault], t: f64) {
        if let Some(present) = self.presence.changed_at(faults, t) {
            self.params = changed(&self.healthy, &present);
            self.step = self.params.discretise(self.t_step);
        }
    }

    pub(super) fn forget_faults(&mut self) {
        self.presence.forget();
    }

    pub(super) fn truth(&self, t: f64) -> Truth {
        let d_axis = self.waveform.d_axis(t);
        let turn = Complex64::from_polar(1.0, d_axis);
        let u = Complex64::new(0.0, self.waveform.amplitude(t)) * turn;
        let i = Complex64::new(self.params.field_current, self.state.i_q) * turn;
        let omega_mech = self.state.omega_el / self.params.n_p;
        Truth {
            u_s_abc: phases(u),
            i_s_abc: phases(i),
            omega_mech,
            theta_mech: self.theta_mech,
            tau_em: self.params.k_f() * self.state.i_q,
            tau_load: self.params.load_friction * omega_mech,
            theta_voltage: d_axis,
            rotor_flux: turn,
        }
    }

    pub(super) fn advance(&mut self, t: f64, t_next: f64) {
        let before = self.state.omega_el;
        self.state = self.step.advance(self.state, self.waveform.amplitude(t));
        let mean = 0.5 * (before + self.state.omega_el) / self.params.n_p;
        self.theta_mech += mean * (t_next - t);
    }
}

fn changed(healthy: &LinearParams, present: &[&Fault]) -> LinearParams {
    let mut params = *healthy;
    for fault in present {
        let Target::Parameter(parameter) = fault.target else {
            continue;
        };
        let value = match parameter {
            Parameter::Rs => &mut params.r_s,
            Parameter::Rr => &mut params.r_r,
            // Scenario files refuse the leakages here; a program that asks for them changes the inductance.
            Parameter::Ls | Parameter::Lls => &mut params.l_s,
            Parameter::Lr | Parameter::Llr => &mut params.l_r,
            Parameter::Lm => &mut params.l_m,
            Parameter::B => &mut params.friction,
            Parameter::Bl => &mut params.load_friction,
        };
        *value = fault.apply(*value);
    }
    params
}
