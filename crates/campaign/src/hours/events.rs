//! What happens to a machine at once, simulated sample by sample.

use motor::dynamic::Harmonic;
use rand::Rng;
use rand_pcg::Pcg64;
use scenario::simulate::SimulationError;
use scenario::{
    Interpolation, Load, LoadSpec, Piecewise, Profile, Scenario, SensorSpec, SpeedSensor, Start,
    SupplySpec,
};

use super::instrument::Instrument;
use super::machine::Machine;
use super::operating::{Conditions, warmed};
use super::weather::log_between;
use crate::runs::run::T_SAMPLE_S;
use scenario::simulate::Simulation;

/// What happens at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Event {
    /// Switched on from standstill.
    Start,
    /// Switched off: the shaft coasts.
    Stop,
    /// The torque jumps within 5 to 50 ms.
    LoadStep,
    /// The torque swings at 0.2 to 3 Hz for some seconds, by 3 to 30 % of the rated one.
    LoadSwing,
    /// The supply falls to 40 to 90 % for 20 ms to 1 s.
    Dip,
    /// The supply is away for 50 to 300 ms.
    Interruption,
    /// The supply's voltage jumps by up to 3 %, as a tap changer does it.
    VoltageStep,
}

impl Event {
    /// All of them.
    pub const ALL: [Event; 7] = [
        Event::Start,
        Event::Stop,
        Event::LoadStep,
        Event::LoadSwing,
        Event::Dip,
        Event::Interruption,
        Event::VoltageStep,
    ];

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Event::Start => "start",
            Event::Stop => "stop",
            Event::LoadStep => "load step",
            Event::LoadSwing => "load swings",
            Event::Dip => "voltage dip",
            Event::Interruption => "interruption of the supply",
            Event::VoltageStep => "voltage step",
        }
    }
}

/// Before a start the terminals are dark so long, s.
const DARK_S: f64 = 0.3;
/// Before anything else the motor runs so long: the monitor finds the supply and judges, s.
const BEFORE_S: f64 = 1.0;
/// A motor is steady again after so many time constants of its rotor, and this long, s.
const ROTOR_CONSTANTS: f64 = 4.0;
const SETTLES_S: f64 = 1.5;
/// The longest start that is simulated, s.
const LONGEST_START_S: f64 = 15.0;
/// Swings of a load last so long, s, and are made of so many points a turn.
const SWINGS_S: f64 = 6.0;
const POINTS_A_TURN: f64 = 24.0;
/// After a stop the terminals are followed so long, s.
const COASTS_S: f64 = 0.6;

/// An event of a machine: from one steady point to another.
pub(super) struct Staged<'m> {
    pub machine: &'m Machine,
    pub event: Event,
    pub from: Conditions,
    pub to: Conditions,
}

impl Staged<'_> {
    /// The simulation.
    ///
    /// # Errors
    /// A motor that does not carry its load at the beginning.
    pub fn simulation(&self, random: &mut Pcg64) -> Result<Simulation, SimulationError> {
        Simulation::new(&self.scenario(random))
    }

    fn scenario(&self, random: &mut Pcg64) -> Scenario {
        let Staged { machine, from, .. } = self;
        let motor = warmed(&machine.truth, from.degc);
        let happens_s = match self.event {
            Event::Start => DARK_S,
            _ => BEFORE_S,
        };
        let rotor_s = motor.parameters.l_r() / motor.parameters.r_r;
        let after_s = match self.event {
            Event::Stop => COASTS_S,
            Event::LoadSwing => SWINGS_S + SETTLES_S + ROTOR_CONSTANTS * rotor_s,
            Event::Start => self.runs_up_s() + SETTLES_S + ROTOR_CONSTANTS * rotor_s,
            _ => SETTLES_S + ROTOR_CONSTANTS * rotor_s,
        };
        let mut scenario = Scenario::of(motor, happens_s + after_s);
        scenario.seed = random.random_range(0..u64::from(u32::MAX));
        scenario.sample_rate_hz = 1.0 / T_SAMPLE_S;
        scenario.start = match self.event {
            Event::Start => Start::Standstill,
            _ => Start::Running,
        };
        scenario.sensors = sensors(&machine.instrument, from.cabinet_degc, &scenario);
        scenario.supply = self.supply(happens_s, random);
        scenario.load = self.load(happens_s, random);
        scenario
    }

    /// How long the shaft takes to run up with seven tenths of the rated torque, s.
    fn runs_up_s(&self) -> f64 {
        let (plate, mechanics) = (&self.machine.truth.nameplate, &self.machine.truth.mechanics);
        let momentum = mechanics.inertia * plate.synchronous_speed_mech();
        (momentum / (0.7 * plate.torque_nm)).min(LONGEST_START_S)
    }

    fn supply(&self, at_s: f64, random: &mut Pcg64) -> SupplySpec {
        let (from, to) = (&self.from, &self.to);
        let mut volts = Piecewise::constant(from.volt);
        match self.event {
            Event::Dip => {
                volts.change(at_s, from.volt * random.random_range(0.4..0.9), 0.0);
                volts.change(at_s + random.random_range(0.02..1.0), to.volt, 0.0);
            }
            Event::Interruption => {
                volts.change(at_s, 0.0, 0.0);
                volts.change(at_s + random.random_range(0.05..0.3), to.volt, 0.0);
            }
            Event::VoltageStep => volts.change(at_s, to.volt, 0.0),
            Event::Start | Event::Stop | Event::LoadStep | Event::LoadSwing => {}
        }
        SupplySpec {
            amplitude_volt: volts,
            frequency_hz: Piecewise::constant(from.hertz),
            phase_rad: random.random_range(0.0..std::f64::consts::TAU),
            switch_on_s: if self.event == Event::Start {
                at_s
            } else {
                0.0
            },
            switch_off_s: (self.event == Event::Stop).then_some(at_s),
            components: components(self.machine, from),
        }
    }

    fn load(&self, at_s: f64, random: &mut Pcg64) -> LoadSpec {
        let (first, second) = (self.from.torque, self.to.torque);
        // What these machines drive brakes: it does not turn a motor that a dip has stalled.
        let active = false;
        let constant = Load::Constant {
            torque: first,
            active,
        };
        let points = match self.event {
            Event::LoadStep => {
                let ramp_s = random.random_range(0.005..0.05);
                vec![(0.0, first), (at_s, first), (at_s + ramp_s, second)]
            }
            Event::LoadSwing => self.swings(at_s, random),
            _ => Vec::new(),
        };
        let other = Profile::new(points, Interpolation::Linear)
            .map_or(constant, |profile| Load::Profile { profile, active });
        LoadSpec {
            friction_factor: self.from.friction,
            other,
        }
    }
}

impl Staged<'_> {
    fn swings(&self, at_s: f64, random: &mut Pcg64) -> Vec<(f64, f64)> {
        let rated = self.machine.truth.nameplate.torque_nm;
        let hertz = log_between(random, 0.2, 3.0);
        let size = rated * log_between(random, 0.03, 0.3);
        let mean = self.from.torque;
        let step_s = 1.0 / (hertz * POINTS_A_TURN);
        // Whole turns, so that it ends where it began.
        let turns = (SWINGS_S * hertz).floor().max(1.0);
        let swing = |k: usize| {
            let t = k as f64 * step_s;
            let torque = mean + size * (std::f64::consts::TAU * hertz * t).sin();
            (at_s + t, torque.max(0.0))
        };
        let swings = (0..=(turns * POINTS_A_TURN) as usize).map(swing);
        std::iter::once((0.0, mean)).chain(swings).collect()
    }
}

/// Negative sequence and harmonics of a machine's supply.
pub(super) fn components(machine: &Machine, at: &Conditions) -> Vec<Harmonic> {
    let negative = Harmonic {
        order: -1.0,
        amplitude: at.unbalance,
    };
    let harmonics = machine.harmonics.iter().copied();
    harmonics.chain([negative]).collect()
}

/// The board's channels with their errors, as the simulator takes them.
pub(super) fn sensors(
    instrument: &Instrument,
    cabinet_degc: f64,
    scenario: &Scenario,
) -> SensorSpec {
    SensorSpec {
        instrument: instrument.simulated(cabinet_degc),
        speed: SpeedSensor::Encoder,
        torque: false,
        ..SensorSpec::of(&scenario.motor)
    }
}
