//! Healthy motors of which nothing is known but the plate, away from their rated supply: how often FAULT lights.
//!
//! `cargo run --release -p studies --example plate_known -- MACHINES SEED [WORD...]` takes motors of the catalogues, hides up to two effects
//! that no plate tells, and judges each at loads, voltages and frequencies by a motor file that knows less of its plate. The words:
//!
//! - `learnt`: the board has learnt thresholds at one load before (docs/firmware.md).
//! - `healthy`: a recording in good order at that load has taught parameters and what is normal, as `drivemon check --healthy` does.
//! - `blind`: no recording has a speed; it is estimated, as `drivemon check` does. `clamps`: nor voltages.
//! - `ratios`: the plate has breakdown and locked-rotor values too.
//! - `faults`: the motors have faults, and FAULT is right.
//! - `list`: every FAULT of a healthy motor; with SAVE=FOLDER in the environment its recording and motor file are kept.

use std::error::Error;

use audit::{Expectation, audit};
use board::{Learner, Progress};
use monitor::{Monitor, MonitorState, RESIDUALS};
use motor::MotorFile;
use motor::motor_file::EffectEntry;
use nameplate::plate::PlateFile;
use nameplate::{Estimate, Plate, catalogue, motor_text};
use rand::seq::IndexedRandom;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use recording::{Channel, Recording};
use replay::check::Knowledge;
use replay::speed::with_estimated_speed;
use replay::{Samples, VerdictState};
use scenario::simulate::record;
use scenario::{Fault, LoadSpec, Piecewise, Scenario, SensorSpec, Start, SupplySpec};
use studies::broken::{Broken, faults};
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
/// Three voltages, three currents, speed.
const CHANNELS: [Channel; 7] = [
    Channel::VOLTAGES[0],
    Channel::VOLTAGES[1],
    Channel::VOLTAGES[2],
    Channel::CURRENTS[0],
    Channel::CURRENTS[1],
    Channel::CURRENTS[2],
    Channel::SPEED,
];
/// Seconds that are judged.
const SECONDS: f64 = 1.5;
/// Seconds in good order that `check --healthy` is given.
const HEALTHY_SECONDS: f64 = 4.0;
/// Seconds that a board learns from, at 50 Hz.
const LEARNT_SECONDS: f64 = 14.0;
/// Load at which the motor in good order is seen.
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

impl<'a> Machine<'a> {
    fn draw(motors: &'a [Known], random: &mut Pcg64) -> Self {
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

    fn recorded(
        &self,
        [load, volt, hertz]: [f64; 3],
        seconds: f64,
        fault: Option<Fault>,
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
            faults: fault.into_iter().collect(),
            sample_rate_hz: 5000.0,
            start: Start::Running,
            sensors: SensorSpec::of(&motor),
            ..Scenario::of(motor, seconds)
        };
        Ok(record(&scenario, |_| ())?)
    }

    fn name(&self) -> String {
        let names: Vec<&str> = self.hidden.iter().map(|e| e.name.as_str()).collect();
        format!("{}, hidden {}", self.of.truth.name, names.join(" "))
    }
}

/// The thresholds that the board learns, or what it says against learning.
fn learnt(
    known: &MotorFile,
    recording: &Recording,
) -> Result<Result<[f32; RESIDUALS], String>, Box<dyn Error>> {
    let config = replay::config_for(known, recording)?;
    let audit = audit(recording, &Expectation::from(known));
    let samples = Samples::new(recording, &audit);
    let monitor = Monitor::new(config)?;
    let (mut state, mut learner) = (MonitorState::default(), Learner::new(1));
    for timed in samples.iter() {
        let Some(report) = monitor.update(&mut state, &timed.sample) else {
            continue;
        };
        match learner.observe(&report, &config, &config.thresholds) {
            Progress::Learning => {}
            Progress::Learnt(calibration) => return Ok(Ok(calibration.thresholds)),
            Progress::Refused(refusal) => return Ok(Err(refusal.label().to_owned())),
        }
    }
    Ok(Err(format!("{} windows only", learner.windows())))
}

/// What is asked.
#[derive(Clone, Copy)]
struct Asked {
    learnt: bool,
    healthy: bool,
    faults: bool,
    channels: &'static [Channel],
}

/// What was said under a condition.
struct Judged {
    /// Place of the condition.
    at: usize,
    fault: &'static str,
    state: VerdictState,
    first: String,
}

/// What was said of one machine.
struct Told {
    name: String,
    knowledge: Knowledge,
    /// Why the board did not learn.
    refused: Option<String>,
    said: Vec<Judged>,
}

fn judged(motors: &[Known], seed: u64, asked: Asked) -> Result<Told, Box<dyn Error>> {
    let mut random = Pcg64::seed_from_u64(seed);
    let machine = Machine::draw(motors, &mut random);
    let mut told = Told {
        name: format!("{seed} {}", machine.name()),
        knowledge: Knowledge::AsGiven,
        refused: None,
        said: Vec::new(),
    };
    let mut known = machine.of.known.clone();
    if asked.healthy {
        let recording = machine.recorded(
            [LEARNT_AT, 1.0, 1.0],
            HEALTHY_SECONDS,
            None,
            random.random(),
        )?;
        let recording = only(&recording, asked.channels)?;
        let learnt = replay::check::learn(&known, &[&recording], &mut |_, _| {});
        told.name += &format!(", {:?} {:?}", learnt.knowledge, learnt.notes);
        told.knowledge = learnt.knowledge;
        known = learnt.motor;
        save(seed, "healthy", &known, &recording)?;
    }
    let mut thresholds = None;
    if asked.learnt {
        let at = [LEARNT_AT, 1.0, 1.0];
        let recording = machine.recorded(at, LEARNT_SECONDS, None, random.random())?;
        match learnt(&known, &recording)? {
            Ok(learnt) => thresholds = Some(learnt),
            Err(refusal) => {
                told.refused = Some(refusal);
                return Ok(told);
            }
        }
    }
    let broken: Vec<Option<Broken>> = match asked.faults {
        true => faults().into_iter().map(Some).collect(),
        false => vec![None],
    };
    for (at, condition) in CONDITIONS.into_iter().enumerate() {
        for broken in &broken {
            let fault = broken.as_ref().map(|broken| broken.1.clone());
            // Beyond the breakdown torque no motor runs.
            let Ok(recording) = machine.recorded(condition, SECONDS, fault, random.random()) else {
                continue;
            };
            let recording = only(&recording, asked.channels)?;
            let estimated = with_estimated_speed(&recording, &known);
            let recording = estimated.map_or(recording, |(shown, _)| shown);
            let audit = audit(&recording, &Expectation::from(&known));
            let mut config = replay::config_for(&known, &recording)?;
            config.thresholds = thresholds.unwrap_or(config.thresholds);
            let monitor = Monitor::new(config)?;
            let samples = Samples::new(&recording, &audit);
            let verdict = replay::replay(&monitor, &samples, &mut |_| {}).verdict(&[]);
            if verdict.state == VerdictState::Fault && broken.is_none() {
                save(seed, &at.to_string(), &known, &recording)?;
            }
            let first = verdict.candidates.first();
            let first = first.map(|first| format!("{:?} {:?}", first.fault, first.size_percent));
            told.said.push(Judged {
                at,
                fault: broken.as_ref().map_or("healthy", |broken| broken.0),
                state: verdict.state,
                first: first.unwrap_or_default(),
            });
        }
    }
    Ok(told)
}

/// What a recorder with these channels alone would have recorded.
fn only(recording: &Recording, channels: &[Channel]) -> Result<Recording, Box<dyn Error>> {
    let name = recording.name();
    let mut seen = Recording::new(name, recording.t().to_vec(), recording.metadata.clone())?;
    for channel in channels {
        if let Some(values) = recording.channel(*channel) {
            seen = seen.with_channel(*channel, values.to_vec())?;
        }
    }
    Ok(seen)
}

/// Keeps a recording and the motor file that judged it where `SAVE` names a folder.
fn save(
    seed: u64,
    what: &str,
    motor: &MotorFile,
    recording: &Recording,
) -> Result<(), Box<dyn Error>> {
    if let Ok(folder) = std::env::var("SAVE") {
        std::fs::write(format!("{folder}/{seed}-motor.toml"), motor.to_toml())?;
        formats::write_recording(
            format!("{folder}/{seed}-{what}.parquet").as_ref(),
            recording,
        )?;
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize, default: u64| {
        let word = words.get(k).and_then(|word| word.parse().ok());
        word.unwrap_or(default)
    };
    let (machines, seed) = (number(0, 60), number(1, 1));
    let has = |word: &str| words.iter().any(|given| given == word);
    let asked = Asked {
        learnt: has("learnt"),
        healthy: has("healthy"),
        faults: has("faults"),
        channels: match (has("blind"), has("clamps")) {
            (_, true) => &CHANNELS[3..6],
            (true, _) => &CHANNELS[..6],
            _ => &CHANNELS,
        },
    };
    let motors = motors(has("ratios"))?;
    let one = |k| judged(&motors, 1_000_003 * seed + k, asked).map_err(|error| error.to_string());
    let all: Result<Vec<Told>, String> = (0..machines).into_par_iter().map(one).collect();
    let all = all?;
    let of = |knowledge| {
        all.iter()
            .filter(|told| told.knowledge == knowledge)
            .count()
    };
    println!(
        "{machines} machines of {} motors: {} calibrated, {} refused by the board\n",
        motors.len(),
        of(Knowledge::Calibrated),
        all.iter().filter(|told| told.refused.is_some()).count()
    );
    print(&all, asked.faults);
    if has("list") {
        list(&all);
    }
    Ok(())
}

fn print(all: &[Told], broken: bool) {
    let names: Vec<&str> = match broken {
        true => faults().into_iter().map(|broken| broken.0).collect(),
        false => vec!["healthy"],
    };
    println!(
        "| load | voltage | frequency | FAULT: {} | not judged |",
        names.join(" | ")
    );
    println!("|---|---|---|{}---|", "---|".repeat(names.len()));
    let said = || all.iter().flat_map(|told| &told.said);
    for (place, [load, volt, hertz]) in CONDITIONS.into_iter().enumerate() {
        print!("| {load} | {volt} | {hertz} |");
        for name in &names {
            let here = || said().filter(|j| j.at == place && j.fault == *name);
            let lit = here().filter(|j| j.state == VerdictState::Fault);
            print!(" {} of {} |", lit.count(), here().count());
        }
        let judged = [VerdictState::Healthy, VerdictState::Fault];
        let not = said().filter(|j| j.at == place && !judged.contains(&j.state));
        println!(" {} |", not.count());
    }
}

/// Every FAULT of a healthy motor, and every refusal of a board.
fn list(all: &[Told]) {
    for told in all {
        let lit = |j: &&Judged| j.state == VerdictState::Fault && j.fault == "healthy";
        for j in told.said.iter().filter(lit) {
            println!("{}: {:?}: {}", told.name, CONDITIONS[j.at], j.first);
        }
        if let Some(refused) = &told.refused {
            println!("{}: {refused}", told.name);
        }
    }
}
