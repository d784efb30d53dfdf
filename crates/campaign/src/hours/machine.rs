//! A healthy machine: its motor as it is and as somebody believes it to be, its board, its plant.

use std::f64::consts::TAU;

use motor::MotorFile;
use motor::dynamic::Harmonic;
use motor::motor_file::{LoadKind, Sensors};
use num_complex::Complex64;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use super::habits::Habits;
use super::instrument::Instrument;
use super::weather::{log_between, normal, signed};

/// Standard deviations with which a motor file that was made from a plate is wrong (logarithms): circuit, inertia.
const BELIEF_OFF: [f64; 2] = [0.08, 0.2];
/// Orders of the harmonics of a grid with rectifiers on it.
const ORDERS: [f64; 4] = [-5.0, 7.0, -11.0, 13.0];

/// A healthy motor with its board and what it does all day.
#[derive(Clone, Debug)]
pub struct Machine {
    /// Name, power and what it does.
    pub words: String,
    /// The seed that everything random of it follows from.
    pub seed: u64,
    pub(super) truth: MotorFile,
    pub(super) believed: MotorFile,
    pub(super) instrument: Instrument,
    pub(super) habits: Habits,
    pub(super) heat: Heat,
    pub(super) harmonics: Vec<Harmonic>,
    /// Negative over positive sequence of the supply, that of an ordinary day.
    pub(super) unbalance: Complex64,
    /// Share of rated voltage, that of an ordinary day.
    pub(super) voltage: f64,
}

/// How motor and cabinet warm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Heat {
    /// Rise of winding and cage at rated current, K.
    pub rise_k: [f64; 2],
    /// Time constants of winding and cage while they run, s.
    pub constant_s: [f64; 2],
    /// Rise of the cage by one start, K.
    pub start_k: f64,
    /// Mean and daily swing of the hall's temperature, degC and K.
    pub hall_degc: [f64; 2],
    /// How much warmer the cabinet is than the hall, K.
    pub cabinet_k: f64,
    /// The cage has the winding's temperature at any time.
    pub alike: bool,
}

impl Machine {
    /// The machine of a seed. Every other one is one of `motors` (those that ship), the others have usual circuits of any power
    /// between 0.37 and 18.5 kW.
    pub fn draw(seed: u64, motors: &[MotorFile]) -> Machine {
        let mut random = Pcg64::seed_from_u64(seed);
        let shipped = motors.get((seed / 2) as usize % motors.len().max(1));
        let base = match shipped.filter(|_| seed.is_multiple_of(2)) {
            Some(motor) => motor.clone(),
            None => usual(&mut random),
        };
        let mut truth = base.clone();
        truth.effects.clear();
        truth.healthy = None;
        truth.uncertainty = None;
        truth.parameter_temperature_degc = None;
        scatter(&mut truth, [0.05, 0.05], &mut random);
        let habits = Habits::draw(&mut random);
        declare_load(&mut truth, &habits);
        truth.sensors = sensors(&truth, &mut random);
        let mut believed = truth.clone();
        scatter(&mut believed, BELIEF_OFF, &mut random);
        Machine {
            words: format!(
                "{:.2} kW ({}), {}",
                truth.nameplate.power_watt / 1e3,
                base.name,
                habits.words()
            ),
            seed,
            instrument: Instrument::draw(truth.sensors, &mut random),
            heat: Heat::draw(&mut random),
            harmonics: harmonics(&mut random),
            unbalance: Complex64::from_polar(
                random.random_range(0.0..0.015),
                TAU * random.random::<f64>(),
            ),
            voltage: 1.0 + 0.05 * signed(&mut random),
            truth,
            believed,
            habits,
        }
    }

    /// The same machine with a cage as warm as its winding, as the monitor believes it to be: what it lights less was the difference.
    #[must_use]
    pub fn with_one_temperature(mut self) -> Machine {
        self.heat.alike = true;
        self
    }

    /// Whether the load of the motor file is a friction.
    pub fn declares_friction(&self) -> bool {
        self.truth.load == LoadKind::Friction
    }
}

impl Heat {
    /// Temperatures of winding and cage where these would be theirs, degC.
    pub fn shared(&self, [winding, cage]: [f64; 2]) -> [f64; 2] {
        [winding, if self.alike { winding } else { cage }]
    }

    fn draw(random: &mut Pcg64) -> Heat {
        Heat {
            rise_k: [
                random.random_range(40.0..85.0),
                random.random_range(50.0..110.0),
            ],
            constant_s: [
                random.random_range(600.0..3600.0),
                random.random_range(300.0..2400.0),
            ],
            start_k: random.random_range(1.0..15.0),
            hall_degc: [
                random.random_range(8.0..32.0),
                random.random_range(1.0..9.0),
            ],
            cabinet_k: random.random_range(3.0..18.0),
            alike: false,
        }
    }
}

/// A motor of usual per-unit values, small ones with larger resistances.
fn usual(random: &mut Pcg64) -> MotorFile {
    let watt = log_between(random, 370.0, 18_500.0);
    let pole_pairs = [1, 2, 2, 3][random.random_range(0..4)];
    let (volt, hertz) =
        [(400.0, 50.0), (230.0, 50.0), (460.0, 60.0), (690.0, 50.0)][random.random_range(0..4)];
    let decades = (watt / 300.0).log10();
    let (efficiency, power_factor) = (0.72 + 0.1 * decades, 0.70 + 0.08 * decades);
    let amp = watt / efficiency / power_factor / volt / 3f64.sqrt();
    let synchronous = TAU * hertz / f64::from(pole_pairs);
    let torque = watt / (synchronous * (0.94 + 0.02 * decades));
    let ohm = volt / 3f64.sqrt() / amp;
    let henry = ohm / (TAU * hertz);
    let small = (watt / 300.0).powf(-0.25);
    let [r_s, r_r] = [
        random.random_range(0.05..0.10) * small * ohm,
        random.random_range(0.05..0.09) * small * ohm,
    ];
    let leakage = random.random_range(0.06..0.12) * henry;
    let magnetizing = random.random_range(1.4..2.6) * henry;
    let inertia = 2.0 * watt * random.random_range(0.1..0.6) / synchronous.powi(2);
    let friction = random.random_range(0.005..0.03) * torque / synchronous;
    let text = format!(
        "name = \"usual circuit\"\n[nameplate]\npole_pairs = {pole_pairs}\npower_watt = {watt}\n\
         voltage_line_rms_volt = {volt:?}\ncurrent_rms_amp = {amp}\nfrequency_hz = {hertz:?}\n\
         torque_nm = {torque}\nconnection = \"star\"\n[parameters]\nstator_resistance_ohm = {r_s}\n\
         rotor_resistance_ohm = {r_r}\nstator_leakage_henry = {leakage}\nrotor_leakage_henry = {leakage}\n\
         magnetizing_inductance_henry = {magnetizing}\ninertia_kg_m2 = {inertia}\nfriction_nm_s = {friction}\n\
         load_friction_nm_s = 0.0\n"
    );
    MotorFile::parse(&text, "usual.toml").expect("numbers within their ranges")
}

/// Makes circuit and inertia another specimen's.
fn scatter(motor: &mut MotorFile, [circuit, inertia]: [f64; 2], random: &mut Pcg64) {
    let mut off = |sigma: f64| (sigma * normal(random)).exp();
    let p = &mut motor.parameters;
    p.r_s *= off(circuit);
    p.r_r *= off(circuit);
    p.l_m *= off(circuit);
    let leakage = off(circuit);
    p.l_ls *= leakage;
    p.l_lr *= leakage;
    motor.mechanics.inertia *= off(inertia);
}

/// Friction that takes the load of an ordinary day, or a load that nobody knows.
fn declare_load(motor: &mut MotorFile, habits: &Habits) {
    let plate = &motor.nameplate;
    let friction = habits.load * plate.torque_nm / plate.rated_speed_mech();
    motor.load = if habits.is_friction {
        LoadKind::Friction
    } else {
        LoadKind::Free
    };
    motor.mechanics.load_friction = match motor.load {
        LoadKind::Friction => (friction - motor.mechanics.friction).max(0.0),
        _ => 0.0,
    };
}

/// The front end of docs/wiring.md, sixteen conversions of twelve bits to a sample, quiet cables and less quiet ones.
fn sensors(motor: &MotorFile, random: &mut Pcg64) -> Sensors {
    let plate = &motor.nameplate;
    let [small, large] = [420.0, 630.8];
    let peak = 1.3 * plate.phase_voltage_amplitude();
    let widest = if peak < small { small } else { large.max(peak) };
    Sensors {
        voltage_full_scale_volt: widest,
        current_full_scale_amp: random.random_range(1.8..3.0) * plate.current_amplitude(),
        adc_bits: 16,
        encoder_pulses_per_revolution: [256, 512, 1024, 2048][random.random_range(0..4)],
        noise_sigma_fraction_of_full_scale: log_between(random, 0.8e-4, 1.5e-3),
        ..Sensors::suited_to(plate)
    }
}

fn harmonics(random: &mut Pcg64) -> Vec<Harmonic> {
    let square: f64 = ORDERS.iter().map(|order| order.powi(-2)).sum();
    let distortion = random.random_range(0.0..0.05) / square.sqrt();
    let one = |order: f64| Harmonic {
        order,
        amplitude: Complex64::from_polar(distortion / order.abs(), TAU * random.random::<f64>()),
    };
    ORDERS.map(one).to_vec()
}
