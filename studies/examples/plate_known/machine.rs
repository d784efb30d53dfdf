//! A motor of the catalogues, its plate, and what it is judged in.

use std::error::Error;

use motor::MotorFile;
use motor::motor_file::EffectEntry;
use nameplate::plate::PlateFile;
use nameplate::{Estimate, Plate, catalogue, motor_text};
use rand::Rng;
use rand::seq::IndexedRandom;
use rand_pcg::Pcg64;
use recording::Recording;
use scenario::simulate::record;
use scenario::{Fault, LoadSpec, Scenario, SensorSpec, Start};
use studies::condition::Condition;
use studies::drive::{self, Doubts};
use studies::hidden;

/// Load, share of the rated one, voltage and frequency, shares of the rated ones.
const AT_REST: [[f64; 3]; 24] = [
    [0.05, 1.0, 1.0],
    [0.3, 1.0, 1.0],
    [0.6, 1.0, 1.0],
    [1.0, 1.0, 1.0],
    [1.3, 1.0, 1.0],
    [0.05, 0.9, 1.0],
    [0.6, 0.9, 1.0],
    [1.0, 0.9, 1.0],
    [0.05, 0.95, 1.0],
    [0.6, 0.95, 1.0],
    [0.05, 1.05, 1.0],
    [0.6, 1.05, 1.0],
    [0.05, 1.1, 1.0],
    [0.6, 1.1, 1.0],
    [1.0, 1.1, 1.0],
    [0.6, 0.6, 1.0],
    [0.6, 0.8, 0.8],
    [0.6, 0.5, 0.5],
    [0.6, 0.22, 0.2],
    [0.05, 0.5, 0.5],
    [0.3, 1.0, 1.4],
    [0.6, 1.0, 1.2],
    [-0.5, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];
/// What is judged in motion: voltages, shares of the rated one.
const VOLTAGES: [f64; 3] = [0.95, 1.0, 1.05];
/// Of full scale.
const NOISE: f64 = 0.001;

/// Where a machine is judged.
pub fn conditions(moving: bool) -> Vec<Condition> {
    Condition::all(moving, &AT_REST, VOLTAGES)
}

/// A motor, and what its plate tells of it.
pub struct Known {
    truth: MotorFile,
    /// What the plate tells.
    pub known: MotorFile,
}

fn file(plate: &Plate, estimate: &Estimate) -> Result<MotorFile, Box<dyn Error>> {
    let plate = PlateFile {
        plate: *plate,
        ..PlateFile::default()
    };
    Ok(MotorFile::parse(
        &motor_text(&plate, estimate)?,
        "motor.toml",
    )?)
}

/// The catalogue motors that a circuit meets.
pub fn motors(ratios: bool) -> Result<Vec<Known>, Box<dyn Error>> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../crates/nameplate/data/motors.csv"
    );
    let (_, rows) = catalogue::read(std::fs::File::open(path)?).map_err(|e| e.to_string())?;
    let plates = rows.iter().filter_map(|row| row.plate.clone().ok());
    let mut all = Vec::new();
    for full in plates {
        let Ok(truth) = Estimate::of(&full) else {
            continue;
        };
        if truth.fit.worst >= 0.05 {
            continue;
        }
        let bare = Plate {
            breakdown_torque_ratio: None,
            locked_rotor_torque_ratio: None,
            locked_rotor_current_ratio: None,
            ..full
        };
        let told = if ratios { full } else { bare };
        let Ok(known) = Estimate::of(&told) else {
            continue;
        };
        all.push(Known {
            truth: file(&full, &truth)?,
            known: file(&told, &known)?,
        });
    }
    Ok(all)
}

/// A machine under judgement.
pub struct Machine<'a> {
    /// The motor.
    pub of: &'a Known,
    hidden: Vec<EffectEntry>,
    warmth: [f64; 2],
}

impl<'a> Machine<'a> {
    /// Draws a motor with up to two effects that no plate tells.
    pub fn draw(motors: &'a [Known], random: &mut Pcg64) -> Self {
        let of = motors.choose(random).expect("not empty");
        let is_new = |e: &EffectEntry| of.truth.effects.iter().all(|known| known.name != e.name);
        let mut hidden = hidden::hidden(&of.truth, random, false);
        hidden.retain(is_new);
        Machine {
            of,
            hidden,
            warmth: [(); 2].map(|()| random.random_range(0.0..0.15)),
        }
    }

    /// The machine under a condition; `seconds` of it where it is at rest.
    ///
    /// # Errors
    ///
    /// Where it cannot carry the load.
    pub fn recorded(
        &self,
        at: Condition,
        seconds: f64,
        fault: Option<Fault>,
        seed: u64,
    ) -> Result<Recording, Box<dyn Error>> {
        let mut scenario = match at {
            Condition::AtRest(at) => self.at_rest(at, seconds, seed),
            Condition::InMotion(drive, volt) => {
                let mut motor = self.of.truth.clone();
                motor.effects.clear();
                let doubts = Doubts::none(NOISE, volt);
                drive::run(&motor, drive, &doubts, None, seed).scenario
            }
        };
        scenario.effects = self.hidden.clone();
        scenario
            .effects
            .extend(self.of.truth.effects.iter().cloned());
        scenario.faults = fault.into_iter().collect();
        scenario.sample_rate_hz = 5000.0;
        Ok(record(&scenario, |_| ())?)
    }

    fn at_rest(&self, [load, volt, hertz]: [f64; 3], seconds: f64, seed: u64) -> Scenario {
        let mut motor = self.of.truth.clone();
        let warmer = (load * load).min(1.6) - 1.0;
        let [stator, rotor] = self.warmth.map(|rise| 1.0 + rise * warmer);
        motor.parameters.r_s *= stator;
        motor.parameters.r_r *= rotor;
        motor.sensors.noise_sigma_fraction_of_full_scale = NOISE;
        motor.effects.clear();
        let plate = &motor.nameplate;
        Scenario {
            seed,
            supply: hidden::supply(plate, [volt, hertz], seed),
            load: LoadSpec::constant(load * plate.torque_nm, true),
            start: Start::Running,
            sensors: SensorSpec::of(&motor),
            ..Scenario::of(motor, seconds)
        }
    }

    /// In words.
    pub fn name(&self) -> String {
        let names: Vec<&str> = self.hidden.iter().map(|e| e.name.as_str()).collect();
        format!("{}, hidden {}", self.of.truth.name, names.join(" "))
    }
}
