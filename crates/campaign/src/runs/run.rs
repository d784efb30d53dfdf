//! One run of a campaign, made from its index alone.

use std::f64::consts::TAU;

use monitor::{ClippedChannels, Monitor, MonitorConfig, MonitorState, RawSample, Report};
use motor::MotorFile;
use motor::dynamic::Harmonic;
use motor::motor_file::{LoadKind, Sensors};
use motor::temperature::copper_resistance_at;
use num_complex::Complex64;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use twox_hash::XxHash64;

use crate::planned::axis::{Axis, Conditions, FIRST_STREAM};
use crate::planned::plan::{LoadKnowledge, Place, Plan};
use crate::runs::outcome::Outcome;
use replay::{Follower, MotionSummary};
use scenario::simulate::{Measured, Simulation};
use scenario::{
    Interpolation, Load, LoadSpec, Piecewise, Profile, Scenario, SensorSpec, SpeedSensor, Start,
    SupplySpec,
};

/// The board's sampling time, s.
pub const T_SAMPLE_S: f64 = 1e-4;
/// Temperature for which a motor file's resistances count where it names none: a motor that was measured cold.
const COLD_DEGC: f64 = 20.0;
/// Harmonics of a grid with rectifiers on it, each in proportion to one over its order; the fifth and the
/// eleventh turn backwards.
const HARMONICS: [f64; 4] = [-5.0, 7.0, -11.0, 13.0];
/// A load or voltage step comes in the middle of the healthy time, up to this share of it earlier or later.
const STEP_JITTER: f64 = 0.1;

/// One run.
#[derive(Clone, Debug)]
pub struct Run<'p> {
    /// Its index in the plan.
    pub index: u64,
    /// Hash of the plan's seed and the index: everything random follows from it.
    pub seed: u64,
    /// Motor, block and fault.
    pub place: Place<'p>,
    /// Its conditions, with nothing left open but steps that do not come.
    pub conditions: Conditions,
    /// Phase of the fault, 0..=2.
    pub phase: usize,
    /// Time of the fault, s; infinite where there is none.
    pub fault_from_s: f64,
    /// At rest, switched on at t = 0, or running.
    pub(crate) start: Start,
    duration_s: f64,
    chance: Chance,
}

/// What is random besides the conditions.
#[derive(Clone, Copy, Debug)]
struct Chance {
    supply_angle: f64,
    unbalance_angle: f64,
    harmonic_angles: [f64; HARMONICS.len()],
    /// In -1..1.
    gains: [f64; 6],
    /// In -1..1.
    steps: [f64; 2],
    noise_seed: u64,
}

impl<'p> Run<'p> {
    /// The run with this index; `None` beyond the last.
    pub fn new(plan: &'p Plan, index: u64) -> Option<Run<'p>> {
        let place = plan.place(index)?;
        let seed = XxHash64::oneshot(plan.seed, &index.to_le_bytes());
        let mut random = Pcg64::seed_from_u64(seed);
        let mut later = Pcg64::seed_from_u64(!seed);
        let drawn = place.conditions(|axis| match axis < FIRST_STREAM {
            true => random.random(),
            false => later.random(),
        });
        let conditions = resolved(&drawn, &place);
        let phase = random.random_range(0..3);
        let jitter: f64 = random.random();
        Some(Run {
            index,
            seed,
            phase,
            // Anywhere within a supply cycle: delays do not depend on where windows happen to end.
            fault_from_s: match place.case {
                Some(_) => place.block.healthy_s + jitter / conditions.of(Axis::Frequency),
                None => f64::INFINITY,
            },
            start: place.block.start,
            duration_s: place.block.duration_s(),
            chance: Chance::draw(&mut random),
            conditions,
            place,
        })
    }

    /// The same run up to its fault.
    pub(crate) fn healthy_part(&self) -> Run<'p> {
        Run {
            duration_s: self.place.block.healthy_s,
            ..self.clone()
        }
    }

    /// Changes a condition.
    pub(crate) fn set(&mut self, axis: Axis, value: f64) {
        self.conditions.0[axis as usize] = value;
    }

    /// What a condition is where the plan does not name it.
    pub(crate) fn nominal(&self, axis: Axis) -> f64 {
        nominal(axis, &self.place).unwrap_or(f64::NAN)
    }

    /// Whether anything is asked of this run that is not asked of the other; a step that does not come equals itself.
    pub(crate) fn differs_from(&self, other: &Run<'_>) -> bool {
        let bits = |run: &Run<'_>| run.conditions.0.map(f64::to_bits);
        bits(self) != bits(other) || self.start != other.start
    }

    /// What is simulated.
    pub fn scenario(&self) -> Scenario {
        let monitor = self.monitor_file();
        let motor = self.plant_motor();
        let case = self.place.case;
        Scenario {
            start: self.start,
            seed: self.chance.noise_seed,
            supply: self.supply(&motor),
            load: self.load(&motor),
            sensors: self.sensors(&monitor),
            faults: case.map_or(Vec::new(), |case| {
                case.kind
                    .faults(case.percent, self.phase, self.fault_from_s)
            }),
            sample_rate_hz: self.sample_rate_hz(),
            ..Scenario::of(motor, self.duration_s)
        }
    }

    fn sample_rate_hz(&self) -> f64 {
        self.conditions.of(Axis::SampleRate)
    }

    /// Whether the motor runs backwards: it is simulated forwards and shown to the monitor in the mirror.
    pub fn is_backwards(&self) -> bool {
        self.conditions.of(Axis::Backwards) >= 0.5
    }

    /// What the monitor is told: the nominal motor, and the load where it is declared.
    pub fn monitor_file(&self) -> MotorFile {
        let mut file = self.place.motor.monitor.clone();
        self.declare_load(&mut file);
        // An axis of whole numbers between 6 and 16.
        file.sensors.adc_bits = self.conditions.of(Axis::Bits).round() as u32;
        // The boards of a campaign have no chain.
        file.sensors = file.sensors.without_delays();
        file
    }

    fn plant_motor(&self) -> MotorFile {
        let mut motor = self.place.motor.plant.clone();
        self.declare_load(&mut motor);
        let cold = motor.parameter_temperature_degc.unwrap_or(COLD_DEGC);
        let degc = self.conditions.of(Axis::Winding);
        let parameters = &mut motor.parameters;
        parameters.r_s = copper_resistance_at(parameters.r_s, cold, degc);
        parameters.r_r = copper_resistance_at(parameters.r_r, cold, degc);
        motor
    }

    /// Friction that takes the torque of this run at the speed of a loaded motor, or none.
    fn declare_load(&self, file: &mut MotorFile) {
        let plate = &file.nameplate;
        let relative = self.conditions.of(Axis::Frequency) / plate.frequency_hz;
        let torque = self.conditions.of(Axis::Load) / 100.0 * plate.torque_nm;
        let friction = torque / (plate.rated_speed_mech() * relative);
        match self.place.block.load {
            LoadKnowledge::Friction => {
                file.load = LoadKind::Friction;
                file.mechanics.load_friction = (friction - file.mechanics.friction).max(0.0);
            }
            LoadKnowledge::Free => {
                file.load = LoadKind::Free;
                file.mechanics.load_friction = 0.0;
            }
        }
    }

    fn supply(&self, motor: &MotorFile) -> SupplySpec {
        let rated = motor.nameplate.phase_voltage_amplitude();
        let volt = |percent: f64| percent / 100.0 * rated;
        let mut amplitude = Piecewise::constant(volt(self.conditions.of(Axis::Voltage)));
        let step_to = self.conditions.of(Axis::VoltageStepTo);
        if !step_to.is_nan() {
            amplitude.change(self.step_time(1), volt(step_to), self.ramp_s());
        }
        let mut frequency = Piecewise::constant(self.conditions.of(Axis::Frequency));
        let step_to = self.conditions.of(Axis::FrequencyStepTo);
        if !step_to.is_nan() {
            frequency.change(self.step_time(1), step_to, self.ramp_s());
        }
        SupplySpec {
            amplitude_volt: amplitude,
            frequency_hz: frequency,
            phase_rad: self.chance.supply_angle,
            components: self.components(),
            ..SupplySpec::rated(&motor.nameplate)
        }
    }

    fn components(&self) -> Vec<Harmonic> {
        let share = |order: f64| 1.0 / order.abs();
        let square: f64 = HARMONICS.iter().map(|order| share(*order).powi(2)).sum();
        let distortion = self.conditions.of(Axis::Distortion) / 100.0 / square.sqrt();
        let harmonics = HARMONICS.iter().zip(self.chance.harmonic_angles);
        let harmonics = harmonics.map(|(order, angle)| (*order, distortion * share(*order), angle));
        let unbalance = self.conditions.of(Axis::Unbalance) / 100.0;
        let all = harmonics.chain([(-1.0, unbalance, self.chance.unbalance_angle)]);
        all.filter(|(_, size, _)| *size > 0.0)
            .map(|(order, size, angle)| Harmonic {
                order,
                amplitude: Complex64::from_polar(size, angle),
            })
            .collect()
    }

    fn load(&self, motor: &MotorFile) -> LoadSpec {
        if self.place.block.load == LoadKnowledge::Friction {
            return LoadSpec::default();
        }
        // A load that holds its direction needs no steep law around standstill, and a running shaft never comes there.
        let active = self.start == Start::Running;
        let torque = |percent: f64| percent / 100.0 * motor.nameplate.torque_nm;
        let first = torque(self.conditions.of(Axis::Load));
        let step_to = self.conditions.of(Axis::LoadStepTo);
        let constant = Load::Constant {
            torque: first,
            active,
        };
        let (from_s, second) = (self.step_time(0), torque(step_to));
        let cycle_s = self.conditions.of(Axis::LoadCycle);
        let (points, between) = match self.ramp_s() > 0.0 {
            _ if cycle_s > 0.0 => (self.strokes(first, second, cycle_s), Interpolation::Linear),
            true => (
                vec![
                    (0.0, first),
                    (from_s, first),
                    (from_s + self.ramp_s(), second),
                ],
                Interpolation::Linear,
            ),
            false => (vec![(0.0, first), (from_s, second)], Interpolation::Step),
        };
        // A step that does not come is not a number, and no profile.
        let other = Profile::new(points, between)
            .map_or(constant, |profile| Load::Profile { profile, active });
        LoadSpec {
            other,
            ..LoadSpec::default()
        }
    }

    /// Load of a press or a crane: half of each cycle at one torque, half at the other, with flanks as long as a step takes,
    /// a hundredth of the cycle at least.
    fn strokes(&self, first: f64, second: f64, cycle_s: f64) -> Vec<(f64, f64)> {
        let flank_s = self.ramp_s().clamp(0.01 * cycle_s, 0.4 * cycle_s);
        let begins = self.step_time(0) % cycle_s;
        let strokes = (self.duration_s / cycle_s).ceil() as usize;
        let stroke = |k: usize| {
            let up = begins + k as f64 * cycle_s;
            let down = up + 0.5 * cycle_s;
            [
                (up, first),
                (up + flank_s, second),
                (down, second),
                (down + flank_s, first),
            ]
        };
        let all = (0..strokes).flat_map(stroke);
        std::iter::once((0.0, first))
            .chain(all.filter(|(t, _)| *t > 0.0))
            .collect()
    }

    fn ramp_s(&self) -> f64 {
        self.conditions.of(Axis::Ramp)
    }

    fn step_time(&self, which: usize) -> f64 {
        self.place.block.healthy_s * (0.5 + STEP_JITTER * self.chance.steps[which])
    }

    fn sensors(&self, monitor: &MotorFile) -> SensorSpec {
        let off = self.conditions.of(Axis::GainError) / 100.0;
        let own = &monitor.sensors;
        let gain = |gains: [f64; 3], first: usize| {
            std::array::from_fn(|k| gains[k] * (1.0 + off * self.chance.gains[first + k]))
        };
        SensorSpec {
            instrument: Sensors {
                noise_sigma_fraction_of_full_scale: self.conditions.of(Axis::Noise) / 100.0,
                voltage_gain: gain(own.voltage_gain, 0),
                current_gain: gain(own.current_gain, 3),
                ..*own
            },
            speed: SpeedSensor::Encoder,
            torque: false,
            ..SensorSpec::of(monitor)
        }
    }

    /// Simulates the run and replays it through the core in ADC codes; `each` sees every report with its time, and whether a
    /// window that is left to motion was judged there. Returns what came in motion, where the plan asks for it.
    ///
    /// # Errors
    /// Why the motor cannot run under these conditions, in words.
    pub fn replay(
        &self,
        mut each: impl FnMut(f64, &Report, Option<bool>),
    ) -> Result<MotionSummary, String> {
        let simulation = Simulation::new(&self.scenario()).map_err(|error| error.to_string())?;
        let t_sample = 1.0 / self.sample_rate_hz();
        let config = MonitorConfig::from_motor_file(&self.monitor_file(), t_sample)
            .map_err(|error| error.to_string())?;
        let monitor = Monitor::new(config).map_err(|error| error.to_string())?;
        let mut state = MonitorState::default();
        let mut follower = self.place.block.in_motion.then(|| Follower::new(&monitor));
        for sample in simulation {
            let shown = raw(&sample.measured);
            let shown = if self.is_backwards() {
                mirrored(shown)
            } else {
                shown
            };
            let shown = monitor.config().converter.convert(&shown);
            let report = monitor.update(&mut state, &shown);
            if let Some(follower) = &mut follower {
                follower.update(sample.t, &shown, &state);
            }
            if let Some(report) = report {
                let follower = follower.as_mut();
                let moved = follower.and_then(|follower| follower.window(&report));
                each(sample.t, &report, moved);
            }
        }
        Ok(follower.map_or_else(MotionSummary::default, Follower::finish))
    }

    /// What the core showed.
    ///
    /// # Errors
    /// Why the motor cannot run under these conditions, in words.
    pub fn outcome(&self) -> Result<Outcome, String> {
        let mut outcome = Outcome::default();
        let motion = self.replay(|t, report, moved| {
            outcome.take(t, self.fault_from_s, report);
            if let Some(judged) = moved {
                outcome.take_moved(t, self.fault_from_s, judged);
            }
        })?;
        outcome.take_alarms(self.fault_from_s, &motion);
        Ok(outcome)
    }
}

impl Chance {
    fn draw(random: &mut Pcg64) -> Chance {
        let mut angle = || TAU * random.random::<f64>();
        let (supply_angle, unbalance_angle) = (angle(), angle());
        let harmonic_angles = std::array::from_fn(|_| angle());
        let mut signed = || 2.0 * random.random::<f64>() - 1.0;
        Chance {
            supply_angle,
            unbalance_angle,
            harmonic_angles,
            gains: std::array::from_fn(|_| signed()),
            steps: std::array::from_fn(|_| signed()),
            noise_seed: random.random(),
        }
    }
}

/// Fills in what the plan leaves to the motor file.
fn resolved(drawn: &Conditions, place: &Place<'_>) -> Conditions {
    let mut conditions = *drawn;
    for axis in [Axis::Frequency, Axis::Winding, Axis::Noise, Axis::Bits] {
        if let Some(value) = nominal(axis, place) {
            conditions.0[axis as usize] = drawn.or(axis, value);
        }
    }
    conditions
}

/// What the motor files say about a condition.
fn nominal(axis: Axis, place: &Place<'_>) -> Option<f64> {
    let (file, plant) = (&place.motor.monitor, &place.motor.plant);
    match axis {
        Axis::Frequency => Some(file.nameplate.frequency_hz),
        Axis::Winding => Some(plant.parameter_temperature_degc.unwrap_or(COLD_DEGC)),
        Axis::Noise => Some(100.0 * file.sensors.noise_sigma_fraction_of_full_scale),
        Axis::Bits => Some(f64::from(file.sensors.adc_bits)),
        _ => None,
    }
}

/// The mirror image: phases b and c exchanged, the shaft turning the other way.
fn mirrored(mut raw: RawSample) -> RawSample {
    raw.voltage_codes.swap(1, 2);
    raw.current_codes.swap(1, 2);
    raw.encoder_count = raw.encoder_count.wrapping_neg();
    raw
}

fn raw(measured: &Measured) -> RawSample {
    RawSample {
        voltage_codes: measured.voltage_codes,
        current_codes: measured.current_codes,
        encoder_count: measured.encoder_count,
        clipped: ClippedChannels::of(measured.clipped),
    }
}
