//! Healthy motors of which nothing is known but the plate, away from their rated supply: how often FAULT lights.
//!
//! `cargo run --release -p studies --example plate_known -- MACHINES SEED [WORD...]` takes motors of the catalogues, hides up to two effects
//! that no plate tells, and judges each at loads, voltages and frequencies by a motor file that knows less of its plate. The words:
//!
//! - `learnt`: the board has learnt thresholds at one load before (docs/firmware.md).
//! - `healthy`: a recording in good order at that load has taught parameters and what is normal, as `drivemon check --healthy` does.
//! - `ratios`: the plate has breakdown and locked-rotor values too.
//! - `list`: every FAULT.

use std::error::Error;

use audit::{Expectation, audit};
use board::{Learner, Progress};
use monitor::{Monitor, MonitorConfig, MonitorState};
use motor::MotorFile;
use motor::motor_file::EffectEntry;
use nameplate::plate::PlateFile;
use nameplate::{Estimate, Plate, catalogue, motor_text};
use rand::seq::IndexedRandom;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use recording::Recording;
use replay::check::Knowledge;
use replay::{Samples, VerdictState};
use scenario::simulate::record;
use scenario::{LoadSpec, Piecewise, Scenario, SensorSpec, Start, SupplySpec};
use studies::hidden;

/// Load, share of the rated one, voltage and frequency, shares of the rated ones.
const CONDITIONS: [[f64; 3]; 24] = [
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
/// Seconds that are judged.
const SECONDS: f64 = 1.5;
/// Seconds that a board learns from, at 50 Hz.
const LEARNT_SECONDS: f64 = 14.0;
/// Load at which a board learns.
const LEARNT_AT: f64 = 0.7;
/// Of full scale.
const NOISE: f64 = 0.001;

/// A motor, and what its plate tells of it.
struct Known {
    truth: MotorFile,
    known: MotorFile,
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
fn motors(ratios: bool) -> Result<Vec<Known>, Box<dyn Error>> {
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
struct Machine<'a> {
    of: &'a Known,
    hidden: Vec<EffectEntry>,
    warmth: [f64; 2],
}

impl Machine<'_> {
    fn recorded(
        &self,
        [load, volt, hertz]: [f64; 3],
        seconds: f64,
        seed: u64,
    ) -> Result<Recording, Box<dyn Error>> {
        let mut motor = self.of.truth.clone();
        let warmed = self
            .warmth
            .map(|rise| 1.0 + rise * ((load * load).min(1.6) - 1.0));
        motor.parameters.r_s *= warmed[0];
        motor.parameters.r_r *= warmed[1];
        motor.sensors.noise_sigma_fraction_of_full_scale = NOISE;
        let mut effects = self.hidden.clone();
        effects.extend(motor.effects.iter().cloned());
        motor.effects.clear();
        let torque = load * motor.nameplate.torque_nm;
        let scenario = Scenario {
            seed,
            supply: SupplySpec {
                amplitude_volt: Piecewise::constant(
                    volt * motor.nameplate.phase_voltage_amplitude(),
                ),
                frequency_hz: Piecewise::constant(hertz * motor.nameplate.frequency_hz),
                components: vec![hidden::unbalance(seed)],
                ..SupplySpec::rated(&motor.nameplate)
            },
            load: LoadSpec::constant(torque, true),
            effects,
            sample_rate_hz: 5000.0,
            start: Start::Running,
            sensors: SensorSpec::of(&motor),
            ..Scenario::of(motor, seconds)
        };
        Ok(record(&scenario, |_| ())?)
    }

    /// What the board does with the motor file after it has learnt, or what it says against learning.
    fn learnt(
        &self,
        config: MonitorConfig,
        recording: &Recording,
    ) -> Result<MonitorConfig, String> {
        let audit = audit(recording, &Expectation::from(&self.of.known));
        let samples = Samples::new(recording, &audit);
        let monitor = Monitor::new(config).map_err(|e| e.to_string())?;
        let (mut state, mut learner) = (MonitorState::default(), Learner::new(1));
        for timed in samples.iter() {
            let Some(report) = monitor.update(&mut state, &timed.sample) else {
                continue;
            };
            match learner.observe(&report, &config, &config.thresholds) {
                Progress::Learning => {}
                Progress::Learnt(calibration) => {
                    let mut learnt = config;
                    learnt.thresholds = calibration.thresholds;
                    return Ok(learnt);
                }
                Progress::Refused(refusal) => return Err(refusal.label().to_owned()),
            }
        }
        Err(format!("{} windows only", learner.windows()))
    }
}

/// What is asked.
#[derive(Clone, Copy)]
struct Asked {
    learnt: bool,
    healthy: bool,
}

/// What was said of one machine at each condition.
struct Told {
    name: String,
    knowledge: Knowledge,
    refused: Option<String>,
    said: Vec<(usize, VerdictState, String)>,
}

fn judged(motors: &[Known], seed: u64, asked: Asked) -> Result<Told, Box<dyn Error>> {
    let mut random = Pcg64::seed_from_u64(seed);
    let of = motors.choose(&mut random).expect("not empty");
    let machine = Machine {
        of,
        hidden: hidden::hidden(&of.truth, &mut random, false)
            .into_iter()
            .filter(|e| of.truth.effects.iter().all(|known| known.name != e.name))
            .collect(),
        warmth: [(); 2].map(|()| random.random_range(0.0..0.15)),
    };
    let names: Vec<&str> = machine.hidden.iter().map(|e| e.name.as_str()).collect();
    let mut told = Told {
        name: format!("{seed} {}, hidden {}", of.truth.name, names.join(" ")),
        knowledge: Knowledge::AsGiven,
        refused: None,
        said: Vec::new(),
    };
    let mut thresholds = None;
    let mut known = of.known.clone();
    if asked.healthy {
        let recording = machine.recorded([LEARNT_AT, 1.0, 1.0], 4.0, random.random())?;
        let learnt = replay::check::learn(&known, &[&recording], &mut |_, _| {});
        told.name += &format!(", {:?} {:?}", learnt.knowledge, learnt.notes);
        told.knowledge = learnt.knowledge;
        known = learnt.motor;
        if let Ok(folder) = std::env::var("SAVE") {
            std::fs::write(format!("{folder}/{seed}-truth.toml"), of.truth.to_toml())?;
            std::fs::write(format!("{folder}/{seed}-plate.toml"), of.known.to_toml())?;
            std::fs::write(format!("{folder}/{seed}-known.toml"), known.to_toml())?;
            formats::write_recording(format!("{folder}/{seed}.parquet").as_ref(), &recording)?;
        }
    }
    if asked.learnt {
        let recording = machine.recorded([LEARNT_AT, 1.0, 1.0], LEARNT_SECONDS, random.random())?;
        let config = replay::config_for(&of.known, &recording)?;
        match machine.learnt(config, &recording) {
            Ok(config) => thresholds = Some(config.thresholds),
            Err(refusal) => {
                told.refused = Some(refusal);
                return Ok(told);
            }
        }
    }
    for (place, at) in CONDITIONS.into_iter().enumerate() {
        // Beyond the breakdown torque no motor runs.
        let Ok(recording) = machine.recorded(at, SECONDS, random.random()) else {
            continue;
        };
        let audit = audit(&recording, &Expectation::from(&known));
        let mut config = replay::config_for(&known, &recording)?;
        config.thresholds = thresholds.unwrap_or(config.thresholds);
        let monitor = Monitor::new(config)?;
        let timeline = replay::replay(&monitor, &Samples::new(&recording, &audit), &mut |_| {});
        let verdict = timeline.verdict(&[]);
        let first = verdict
            .candidates
            .first()
            .map(|first| format!("{:?} {:?}", first.fault, first.size_percent));
        told.said
            .push((place, verdict.state, first.unwrap_or_default()));
    }
    Ok(told)
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize, default: u64| {
        let word = words.get(k).and_then(|word| word.parse().ok());
        word.unwrap_or(default)
    };
    let (machines, seed) = (number(0, 60), number(1, 1));
    let has = |word: &str| words.iter().any(|given| given == word);
    let motors = motors(has("ratios"))?;
    let asked = Asked {
        learnt: has("learnt"),
        healthy: has("healthy"),
    };
    let one = |k| judged(&motors, 1_000_003 * seed + k, asked).map_err(|error| error.to_string());
    let all: Result<Vec<Told>, String> = (0..machines).into_par_iter().map(one).collect();
    let all = all?;
    let refused: Vec<&String> = all
        .iter()
        .filter_map(|told| told.refused.as_ref())
        .collect();
    let of = |knowledge| {
        all.iter()
            .filter(|told| told.knowledge == knowledge)
            .count()
    };
    println!(
        "identified {}, calibrated {}",
        of(Knowledge::Identified),
        of(Knowledge::Calibrated)
    );
    println!(
        "{} motors, {machines} machines, {} not learnt",
        motors.len(),
        refused.len()
    );
    println!("| load | voltage | frequency | FAULT | healthy | not judged | other |");
    println!("|---|---|---|---|---|---|---|");
    for (place, [load, volt, hertz]) in CONDITIONS.into_iter().enumerate() {
        let here = || {
            let said = all.iter().flat_map(|told| &told.said);
            said.filter(|(at, _, _)| *at == place)
        };
        let count = |state| here().filter(|(_, is, _)| *is == state).count();
        let [fault, healthy, not] = [
            VerdictState::Fault,
            VerdictState::Healthy,
            VerdictState::NotJudged,
        ]
        .map(count);
        let other = here().count() - fault - healthy - not;
        println!("| {load} | {volt} | {hertz} | {fault} | {healthy} | {not} | {other} |");
    }
    if has("list") {
        for told in &all {
            for (place, state, first) in &told.said {
                if *state == VerdictState::Fault {
                    println!("{}: {:?}: {first}", told.name, CONDITIONS[*place]);
                }
            }
            if let Some(refused) = &told.refused {
                println!("{}: {refused}", told.name);
            }
        }
    }
    Ok(())
}
