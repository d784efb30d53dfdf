//! The five-state motor on the scenario's supply and load.

use super::presence::{Presence, common_series};
use super::waveform::Waveform;
use crate::Load;
use crate::simulate::{SimulationError, Truth};
use crate::{Fault, Parameter, Scenario, Start, Target};
use motor::dynamic::{Dynamic, DynamicState, Extra, Hooks, phases};
use motor::steady_state::SteadyState;
use motor::{Mechanics, TParams};
use num_complex::Complex64;
use std::sync::Arc;

/// Largest integration step, s: RK4 then agrees with two other simulators to 1.4e-7.
const LARGEST_STEP_S: f64 = 100e-6;
/// RK4 is stable up to 2.78 over the fastest rate; this keeps it accurate as well.
const STEP_TIMES_RATE: f64 = 0.5;
/// Width of the band of speeds in which a passive load changes its sign, rad/s (see [`Load`]).
const STANDSTILL_RAD_S: f64 = 0.1;

/// Builds the motor from its parameters and the faults in force, which may bring effects along.
pub(super) type Make<H> =
    Arc<dyn Fn(&TParams<f64>, &Mechanics<f64>, &[&Fault]) -> Dynamic<H> + Send + Sync>;

#[derive(Clone)]
pub(in crate::simulate) struct Full<H: Hooks> {
    healthy: (TParams<f64>, Mechanics<f64>),
    make: Make<H>,
    model: Dynamic<H>,
    state: DynamicState<H::Extra>,
    now: (TParams<f64>, Mechanics<f64>),
    presence: Presence,
    load: Load,
    waveform: Waveform,
    largest_step: f64,
}

impl<H: Hooks> Full<H> {
    pub(super) fn new(scenario: &Scenario, make: Make<H>) -> Result<Full<H>, SimulationError> {
        let mut mechanics = scenario.motor.mechanics;
        mechanics.load_friction *= scenario.load.friction_factor;
        let motor = scenario.motor.parameters;
        let waveform = Waveform::new(&scenario.supply);
        let mut plant = Full {
            model: make(&motor, &mechanics, &[]),
            state: DynamicState::rest(),
            now: (motor, mechanics),
            presence: Presence::default(),
            load: scenario.load.other.clone(),
            largest_step: largest_step(scenario, &mechanics),
            healthy: (motor, mechanics),
            make,
            waveform,
        };
        // A motor that begins faulty begins in the state of the faulty motor.
        plant.switch_faults(&scenario.faults, 0.0);
        if scenario.start == Start::Running {
            plant.state = plant.running()?;
        }
        Ok(plant)
    }

    /// Settled on the supply at t = 0, at the speed to which the positive sequence drives the load.
    fn running(&self) -> Result<DynamicState<H::Extra>, SimulationError> {
        let (motor, mechanics) = self.now;
        let amplitude =
            Complex64::from_polar(self.waveform.amplitude(0.0), self.waveform.angle(0.0));
        let steady = SteadyState::new(
            &motor,
            mechanics.n_p,
            amplitude,
            self.waveform.omega_sync(0.0),
        );
        let friction = mechanics.total_friction();
        let point = match self.load {
            Load::None => steady.at_friction(friction),
            _ => steady.at_load(|w| friction * w + self.load.torque(0.0, w))?,
        };
        let supply = self.waveform.rotating(0.0);
        let settled = DynamicState::settled(&motor, mechanics.n_p, point.omega_mech, &supply);
        Ok(DynamicState {
            psi_s: settled.psi_s,
            psi_r: settled.psi_r,
            omega_mech: settled.omega_mech,
            theta_mech: 0.0,
            extra: H::Extra::ZERO,
        })
    }

    pub(super) fn switch_faults(&mut self, faults: &[Fault], t: f64) {
        if let Some(present) = self.presence.changed_at(faults, t) {
            self.now = changed(&self.healthy, &present);
            let (motor, mechanics) = &self.now;
            self.model = (self.make)(motor, mechanics, &present);
        }
    }

    pub(super) fn forget_faults(&mut self) {
        self.presence.forget();
    }

    pub(super) fn truth(&self, t: f64) -> Truth {
        let supply = self.voltage(t);
        let omega_mech = self.state.omega_mech;
        let tau_load = self.load.torque(t, omega_mech);
        let flow = self.model.flow(t, &self.state, supply, tau_load);
        Truth {
            u_s_abc: phases(flow.terminal.supply),
            i_s_abc: phases(flow.terminal.i),
            omega_mech,
            theta_mech: self.state.theta_mech,
            tau_em: flow.tau_em,
            tau_load: tau_load + self.now.1.load_friction * omega_mech,
            theta_voltage: self.waveform.d_axis(t),
            rotor_flux: self.state.psi_r,
        }
    }

    /// Voltage at the terminals, V: the supply's, or what the rotor induces in an open stator.
    fn voltage(&self, t: f64) -> Complex64 {
        match self.waveform.is_closed(t) {
            true => self.waveform.at(t),
            false => self.model.open_voltage(t, &self.state),
        }
    }

    pub(super) fn advance(&mut self, t: f64, t_next: f64) {
        let steps = ((t_next - t) / self.largest_step - 1e-9).ceil().max(1.0);
        let h = (t_next - t) / steps;
        // A step of supply or load at t_next belongs to the next interval.
        let last = t_next - 1e-9 * h;
        let supply = |time: f64| self.waveform.at(time.min(last));
        let load = |time: f64, omega: f64| self.load.torque(time.min(last), omega);
        let mut k = 0.0;
        while k < steps {
            let begin = t + k * h;
            if self.waveform.is_closed(begin) {
                self.model.step(&mut self.state, begin, h, supply, load);
            } else {
                self.model
                    .interrupt(&mut self.state, begin, Complex64::ZERO);
                let u = self.model.open_voltage(begin, &self.state);
                let omega_el = self.now.1.n_p * self.state.omega_mech;
                let turned = |time: f64| u * Complex64::from_polar(1.0, omega_el * (time - begin));
                self.model.step(&mut self.state, begin, h, turned, load);
            }
            k += 1.0;
        }
        if !self.waveform.is_closed(t_next) {
            self.model
                .interrupt(&mut self.state, t_next, Complex64::ZERO);
        }
    }
}

/// The motor with its faults.
fn changed(
    healthy: &(TParams<f64>, Mechanics<f64>),
    present: &[&Fault],
) -> (TParams<f64>, Mechanics<f64>) {
    let (mut motor, mut mechanics) = *healthy;
    for fault in present {
        if let Target::Parameter(parameter) = fault.target {
            let value = value_of(&mut motor, &mut mechanics, parameter);
            *value = fault.apply(*value);
        }
    }
    motor.r_s *= 1.0 + common_series(present);
    (motor, mechanics)
}

fn value_of<'p>(
    motor: &'p mut TParams<f64>,
    mechanics: &'p mut Mechanics<f64>,
    parameter: Parameter,
) -> &'p mut f64 {
    match parameter {
        Parameter::Rs => &mut motor.r_s,
        Parameter::Rr => &mut motor.r_r,
        // Scenario files refuse Ls and Lr here; a program that asks for them changes the leakage.
        Parameter::Ls | Parameter::Lls => &mut motor.l_ls,
        Parameter::Lr | Parameter::Llr => &mut motor.l_lr,
        Parameter::Lm => &mut motor.l_m,
        Parameter::B => &mut mechanics.friction,
        Parameter::Bl => &mut mechanics.load_friction,
    }
}

/// A passive torque yields within a narrow band around standstill: steep, and the step must resolve it.
fn largest_step(scenario: &Scenario, mechanics: &Mechanics<f64>) -> f64 {
    let torque = largest_torque(&scenario.load.other);
    let rate = torque / (STANDSTILL_RAD_S * mechanics.inertia);
    LARGEST_STEP_S.min(STEP_TIMES_RATE / rate)
}

fn largest_torque(load: &Load) -> f64 {
    match load {
        Load::None | Load::Friction(_) | Load::Quadratic(_) => 0.0,
        // What drives the shaft at standstill does not yield there.
        Load::Constant { active: true, .. } | Load::Profile { active: true, .. } => 0.0,
        Load::Constant { torque, .. } => torque.abs(),
        Load::Profile { profile, .. } => {
            let torques = profile.points().iter().map(|(_, torque)| torque.abs());
            torques.fold(0.0, f64::max)
        }
        Load::Sum(loads) => loads.iter().map(largest_torque).sum(),
    }
}
