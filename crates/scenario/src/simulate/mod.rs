//! Runs a scenario: a stream of samples, each with what was true and what the instruments showed.

mod instruments;
mod plant;
#[cfg(feature = "recording")]
mod record;
mod side_by_side;

#[cfg(test)]
mod tests;

pub(crate) use plant::effects::check_entry;
#[cfg(feature = "recording")]
pub use record::{Pieces, RecordError, record};
pub use side_by_side::{DataPair, SideBySide};

use crate::{Fault, Scenario};
use instruments::Instruments;
use motor::motor_file::Frame;
use motor::steady_state::{DqPoint, NoOperatingPoint};
use num_complex::Complex64;
use plant::{Plant, effects};

/// What was so at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Phase-to-neutral voltages of the supply, before any effect between it and the motor, V.
    pub u_s_abc: [f64; 3],
    /// Phase currents into the motor, A.
    pub i_s_abc: [f64; 3],
    /// Shaft speed, mechanical rad/s.
    pub omega_mech: f64,
    /// Shaft angle, rad, not wrapped.
    pub theta_mech: f64,
    /// Electromagnetic torque, N m.
    pub tau_em: f64,
    /// Torque that the load takes from the shaft, load friction included and motor friction not, N m.
    pub tau_load: f64,
    /// Angle of the d axis of the voltage frame (a quarter turn behind the positive sequence), rad.
    pub theta_voltage: f64,
    /// Rotor flux, V s: the d axis of the rotor-flux frame lies along it. Of the linear plant, which has none, of length 1.
    pub rotor_flux: Complex64,
}

/// What the instruments showed at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Phase-to-neutral voltages, V, calibrated.
    pub u_s_abc: [f64; 3],
    /// Phase currents, A, calibrated.
    pub i_s_abc: [f64; 3],
    /// Shaft speed as the scenario's speed sensor shows it, mechanical rad/s; 0 without one.
    pub omega_mech: f64,
    /// Shaft torque, N m.
    pub tau_load: f64,
    /// ADC codes of the voltages; sums of them where the chain adds conversions up.
    pub voltage_codes: [u16; 3],
    /// ADC codes of the currents.
    pub current_codes: [u16; 3],
    /// Free-running encoder counter, four counts per pulse, wrapping.
    pub encoder_count: u16,
    /// Channels (voltages a, b, c, then currents a, b, c) of which any conversion was at a rail.
    pub clipped: [bool; 6],
}

/// One sample of a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimSample {
    /// Time since the beginning of the experiment, s.
    pub t: f64,
    /// What was so.
    pub truth: Truth,
    /// What the instruments showed.
    pub measured: Measured,
    /// Whether a fault was present.
    pub faulty: bool,
}

impl SimSample {
    /// The measured signals in a d-q frame whose angle is the true one: what an ideal instrument of the
    /// published kind computes.
    pub fn dq(&self, frame: Frame) -> DqPoint<f64> {
        let theta = self.truth.theta(frame);
        let back = Complex64::from_polar(1.0, -theta);
        let u = motor::dynamic::clarke(self.measured.u_s_abc) * back;
        let i = motor::dynamic::clarke(self.measured.i_s_abc) * back;
        DqPoint {
            u_d: u.re,
            u_q: u.im,
            i_d: i.re,
            i_q: i.im,
        }
    }
}

impl Truth {
    /// Angle of the d axis of a frame, rad.
    pub fn theta(&self, frame: Frame) -> f64 {
        match frame {
            Frame::Voltage => self.theta_voltage,
            Frame::RotorFlux => self.rotor_flux.arg(),
        }
    }
}

/// Why a scenario cannot be run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// The motor cannot be running at the beginning.
    #[error(
        "the motor cannot start from running: {0}; write start = \"standstill\", or change supply or load"
    )]
    NotRunning(#[from] NoOperatingPoint),
    /// An effect that cannot be simulated.
    #[error("effect `{name}`, `{key}`: {message}")]
    Effect {
        /// Name of the effect.
        name: String,
        /// The key to blame.
        key: String,
        /// What is wrong, with the remedy.
        message: String,
    },
}

/// A running experiment; an iterator over its samples in the order of time.
#[derive(Clone, Debug)]
pub struct Simulation {
    scenario: Scenario,
    plant: Plant,
    instruments: Instruments,
    next: u64,
    samples: u64,
    steps_per_sample: u32,
}

impl Simulation {
    /// Prepares a scenario.
    ///
    /// # Errors
    /// A motor that is to be running on a load that it cannot carry, or an effect that cannot be simulated sample by sample:
    /// those on the instruments need whole signals, which only [`record`] has.
    pub fn new(scenario: &Scenario) -> Result<Simulation, SimulationError> {
        match effects::of_instruments(scenario)?.first() {
            None => Simulation::inside(scenario),
            Some(effect) => Err(SimulationError::Effect {
                name: effect.effect.descriptor().name.to_owned(),
                key: "name".to_owned(),
                message: "concerns the instruments, which `drivemon simulate` can show and a running \
                          simulation cannot: leave it out, or use [[faults]] on va, vb, vc, ia, ib, ic or speed"
                    .to_owned(),
            }),
        }
    }

    /// Without the effects on the instruments.
    fn inside(scenario: &Scenario) -> Result<Simulation, SimulationError> {
        Ok(Simulation {
            plant: Plant::new(scenario)?,
            instruments: Instruments::new(scenario),
            next: 0,
            samples: scenario.samples(),
            steps_per_sample: scenario.steps_per_sample(),
            scenario: scenario.clone(),
        })
    }

    /// An experiment without an end, whose faults can be switched while it runs. After `duration_s` supply and load go
    /// on as they then are.
    ///
    /// # Errors
    /// As of [`Simulation::new`].
    pub fn endless(scenario: &Scenario) -> Result<Simulation, SimulationError> {
        let mut simulation = Simulation::new(scenario)?;
        simulation.plant = Plant::switchable(scenario)?;
        simulation.samples = u64::MAX;
        Ok(simulation)
    }

    /// Replaces the faults, from the next sample on; the motor keeps its state. Only in an [`Simulation::endless`] one
    /// are all kinds of fault possible.
    ///
    /// # Errors
    /// A fault of a size that cannot be simulated; the faults before it then stay.
    pub fn switch_faults(&mut self, faults: Vec<Fault>) -> Result<(), SimulationError> {
        let before = std::mem::replace(&mut self.scenario.faults, faults);
        if let Err(error) = effects::of_faults(&self.scenario) {
            self.scenario.faults = before;
            return Err(error);
        }
        self.plant.forget_faults();
        Ok(())
    }

    /// Time of the next sample, s.
    pub fn now(&self) -> f64 {
        self.time(self.next)
    }

    /// The experiment that is running.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// Time of sample `k`, s: a quotient, so that 0.3 s is 0.3 and not 3000 times 0.0001.
    fn time(&self, k: u64) -> f64 {
        #[allow(clippy::cast_precision_loss)]
        let k = k as f64;
        k / self.scenario.sample_rate_hz
    }

    /// Goes to the next sample; a signal chain sees what happens on the way.
    fn advance(&mut self, t: f64, t_next: f64) {
        let steps = f64::from(self.steps_per_sample);
        let mut before = t;
        for k in 1..self.steps_per_sample {
            let now = t + (t_next - t) * f64::from(k) / steps;
            self.plant.advance(before, now);
            let truth = self.plant.truth(now);
            self.instruments.observe(now, &truth, &self.scenario.faults);
            before = now;
        }
        self.plant.advance(before, t_next);
    }

    fn sample(&mut self, t: f64) -> SimSample {
        let truth = self.plant.truth(t);
        let faults = &self.scenario.faults;
        SimSample {
            t,
            truth,
            measured: self.instruments.read(t, &truth, faults),
            faulty: faults.iter().any(|fault| fault.is_active(t)),
        }
    }
}

impl Iterator for Simulation {
    type Item = SimSample;

    fn next(&mut self) -> Option<SimSample> {
        while self.next < self.samples {
            let (t, t_next) = (self.time(self.next), self.time(self.next + 1));
            self.plant.switch_faults(&self.scenario.faults, t);
            let sample = self.sample(t);
            self.advance(t, t_next);
            self.next += 1;
            if t >= self.scenario.record_from_s {
                return Some(sample);
            }
        }
        None
    }
}
