//! Motors around those that ship, with effects that their motor files do not know, and what a calibration makes of them.

use std::error::Error;
use std::f64::consts::TAU;

use motor::MotorFile;
use motor::dynamic::Harmonic;
use motor::motor_file::{EffectEntry, LoadKind, Nameplate};
use num_complex::Complex64;
use rand::seq::{IndexedRandom, SliceRandom};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use recording::Recording;
use replay::calibrate::{Surroundings, calibrate};
use scenario::simulate::record;
use scenario::{Fault, LoadSpec, Piecewise, Scenario, SensorSpec, Start, SupplySpec};

use crate::drive::{self, Doubts, Drive};

const MOTORS: [&str; 5] = [
    "assumed-300w",
    "itsc-075hp",
    "peer-2k2",
    "chalmers-4kw",
    "imc-18k5",
];
/// The largest load of the calibration, share of the rated torque.
const HIGHEST: [f64; 3] = [0.5, 0.75, 1.0];
/// Loads of the calibration, shares of the largest.
const CALIBRATED: [f64; 3] = [0.1, 0.5, 1.0];
/// A motor that runs; longer than FAULT needs.
const SECONDS: f64 = 1.6;
/// Largest negative over positive sequence of the supply.
const UNBALANCE: f64 = 0.01;
/// Of full scale.
const NOISE: f64 = 0.001;

/// A machine, and what its motor file does not know.
pub struct Machine {
    /// What its motor file says, which is the machine but for what is hidden.
    pub motor: MotorFile,
    /// The effects that the file does not know.
    pub hidden: Vec<EffectEntry>,
    /// The largest load of its calibration, share of the rated torque.
    pub highest: f64,
    /// How much the resistances of stator and rotor rise by the warmth of the rated load, shares.
    warmth: [f64; 2],
}

impl Machine {
    /// One of the motors that ship with another circuit and up to two effects; `hard`: larger ones than motors commonly have.
    ///
    /// # Errors
    ///
    /// Where a motor file cannot be read.
    pub fn draw(random: &mut Pcg64, hard: bool) -> Result<Self, Box<dyn Error>> {
        let name = MOTORS.choose(random).expect("not empty");
        let path = format!("{}/../motors/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let mut motor = MotorFile::read(path)?;
        let p = &mut motor.parameters;
        for value in [&mut p.r_s, &mut p.r_r, &mut p.l_m, &mut p.l_ls, &mut p.l_lr] {
            *value *= random.random_range(0.8..1.25);
        }
        motor.load = match random.random_bool(0.3) {
            true => LoadKind::Measured,
            false => LoadKind::Free,
        };
        motor.mechanics.load_friction = 0.0;
        motor.sensors.noise_sigma_fraction_of_full_scale = NOISE;
        // A recorder's ranges hold what the motor takes at twice its load.
        motor.sensors.current_full_scale_amp = 4.0 * motor.nameplate.current_amplitude();
        motor.effects.clear();
        motor.healthy = None;
        Ok(Machine {
            hidden: hidden(&motor, random, hard),
            highest: *HIGHEST.choose(random).expect("not empty"),
            warmth: [(); 2].map(|()| random.random_range(0.0..0.15)),
            motor,
        })
    }

    /// Recorded while it runs at a load, voltage and frequency, shares of the rated ones.
    ///
    /// # Errors
    ///
    /// Where the machine cannot carry the load.
    pub fn recorded(
        &self,
        [load, volt, hertz]: [f64; 3],
        fault: Option<Fault>,
        seed: u64,
    ) -> Result<Recording, Box<dyn Error>> {
        let mut motor = self.motor.clone();
        let warmed = self.warmth.map(|rise| 1.0 + rise * (load * load).min(1.6));
        motor.parameters.r_s *= warmed[0];
        motor.parameters.r_r *= warmed[1];
        let torque = load * motor.nameplate.torque_nm;
        let supply = supply(&motor.nameplate, [volt, hertz], seed);
        let scenario = Scenario {
            seed,
            supply,
            load: LoadSpec::constant(torque, true),
            effects: self.hidden.clone(),
            faults: fault.into_iter().collect(),
            sample_rate_hz: 5000.0,
            start: Start::Running,
            sensors: SensorSpec::of(&motor),
            ..Scenario::of(motor, SECONDS)
        };
        Ok(record(&scenario, |_| ())?)
    }

    /// Recorded while it starts, is loaded or slowed; `volt`: share of the rated voltage.
    ///
    /// # Errors
    ///
    /// Where the scenario cannot be simulated.
    pub fn moved(
        &self,
        drive: Drive,
        volt: f64,
        fault: Option<Fault>,
        seed: u64,
    ) -> Result<Recording, Box<dyn Error>> {
        let doubts = Doubts::none(NOISE, volt);
        let mut scenario = drive::run(&self.motor, drive, &doubts, None, seed).scenario;
        scenario.effects = self.hidden.clone();
        scenario.faults = fault.into_iter().collect();
        scenario.sample_rate_hz = 5000.0;
        Ok(record(&scenario, |_| ())?)
    }

    /// What a calibration makes of the motor file: at three loads or (`one`) the largest alone, and (`moved`) at a start and at a press.
    ///
    /// # Errors
    ///
    /// Where a recording is not possible or the calibration refuses.
    pub fn calibrated(
        &self,
        one: bool,
        moved: bool,
        random: &mut Pcg64,
    ) -> Result<MotorFile, Box<dyn Error>> {
        let shares = if one { &CALIBRATED[2..] } else { &CALIBRATED };
        let recorded = |share| {
            let at = [share * self.highest, 1.0, 1.0];
            self.recorded(at, None, random.random())
        };
        let mut recordings = shares.iter().map(recorded).collect::<Result<Vec<_>, _>>()?;
        if moved {
            for drive in [Drive::DirectStart, Drive::Press] {
                recordings.push(self.moved(drive, 1.0, None, random.random())?);
            }
        }
        let calibrated = calibrate(&self.motor, &recordings, &Surroundings::default())?;
        Ok(calibrated.motor)
    }

    /// What is hidden.
    pub fn names(&self) -> String {
        let names: Vec<&str> = self.hidden.iter().map(|e| e.name.as_str()).collect();
        match names.is_empty() {
            true => "nothing".to_owned(),
            false => names.join(" "),
        }
    }
}

/// A supply of this voltage and frequency, shares of the rated ones, whose unbalance is that of `seed`.
pub fn supply(plate: &Nameplate, [volt, hertz]: [f64; 2], seed: u64) -> SupplySpec {
    SupplySpec {
        components: vec![unbalance(seed)],
        amplitude_volt: Piecewise::constant(volt * plate.phase_voltage_amplitude()),
        frequency_hz: Piecewise::constant(hertz * plate.frequency_hz),
        ..SupplySpec::rated(plate)
    }
}

/// A negative sequence of the supply; it wanders from recording to recording.
fn unbalance(seed: u64) -> Harmonic {
    let mut random = Pcg64::seed_from_u64(seed);
    Harmonic {
        order: -1.0,
        amplitude: Complex64::from_polar(
            random.random_range(0.0..UNBALANCE),
            random.random_range(0.0..TAU),
        ),
    }
}

/// Up to two effects, as small or large as they are in motors; `hard`: larger ones than motors commonly have.
pub fn hidden(motor: &MotorFile, random: &mut Pcg64, hard: bool) -> Vec<EffectEntry> {
    let drop = if hard { 0.25..0.4 } else { 0.02..0.25 };
    let iron = if hard { 0.25..0.45 } else { 0.02..0.25 };
    let exponent = if hard {
        random.random_range(4.0..9.0)
    } else {
        7.0
    };
    let plate = &motor.nameplate;
    let volt = plate.phase_voltage_amplitude();
    let mut all = vec![
        EffectEntry::with_numbers(
            "leakage-saturation",
            [
                ("leakage_drop", random.random_range(drop)),
                ("reference_current_amp", 3.0 * plate.current_amplitude()),
            ],
        ),
        EffectEntry::with_numbers(
            "magnetizing-saturation",
            [
                ("saturation", random.random_range(iron)),
                ("saturation_exponent", exponent),
            ],
        ),
        EffectEntry::with_numbers(
            "core-loss",
            [(
                "core_loss_resistance_ohm",
                1.5 * volt * volt / (random.random_range(0.003..0.03) * plate.power_watt),
            )],
        ),
        EffectEntry::with_numbers(
            "stray-load-loss",
            [(
                "stray_load_torque_nm",
                random.random_range(0.002..0.02) * plate.torque_nm,
            )],
        ),
        EffectEntry::with_numbers(
            "deep-bar",
            [
                ("resistance_rise", random.random_range(0.05..0.6)),
                ("leakage_drop", random.random_range(0.02..0.2)),
                ("slip_exponent", 1.0),
            ],
        ),
    ];
    all.shuffle(random);
    all.truncate(random.random_range(0..3));
    all
}
