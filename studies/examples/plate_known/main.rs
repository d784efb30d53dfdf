//! Healthy motors of which nothing is known but the plate, away from their rated supply: how often FAULT lights.
//!
//! `cargo run --release -p studies --example plate_known -- MACHINES SEED [WORD...]` takes motors of the catalogues, hides up to two effects
//! that no plate tells, and judges each at loads, voltages and frequencies by a motor file that knows less of its plate. The words:
//!
//! - `learnt`: the board has learnt thresholds at one load before (docs/firmware.md).
//! - `healthy`: a recording in good order at that load has taught parameters and what is normal, as `drivemon check --healthy` does.
//! - `blind`: no recording has a speed; it is estimated, as `drivemon check` does. `clamps`: nor voltages.
//! - `ratios`: the plate has breakdown and locked-rotor values too.
//! - `moving`: judged while it starts, is loaded or slowed; a start and a press teach beside the load.
//! - `faults`: the motors have faults, and FAULT is right.
//! - `list`: every FAULT of a healthy motor; with SAVE=FOLDER in the environment its recording and motor file are kept.

mod machine;

use std::error::Error;

use audit::{Expectation, audit};
use board::{Learner, Progress};
use machine::{Known, Machine, conditions, motors};
use monitor::{Monitor, MonitorState, RESIDUALS};
use motor::MotorFile;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use recording::{Channel, Recording};
use replay::check::{Knowledge, Reference};
use replay::speed::with_estimated_speed;
use replay::{Samples, VerdictState};
use studies::broken::{Broken, faults};
use studies::condition::Condition;
use studies::drive::Drive;
use studies::words::Words;

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
/// At which the motor in good order is seen.
const LEARNT_AT: Condition = Condition::AtRest([0.7, 1.0, 1.0]);

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
    moving: bool,
    channels: &'static [Channel],
}

/// What was said under a condition.
struct Judged {
    at: Condition,
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
        let moved = [Drive::DirectStart, Drive::Press].map(|drive| Condition::InMotion(drive, 1.0));
        let moved = if asked.moving { &moved[..] } else { &[] };
        let mut recordings = Vec::new();
        for at in [&[LEARNT_AT], moved].concat() {
            let recording = machine.recorded(at, HEALTHY_SECONDS, None, random.random())?;
            recordings.push(only(&recording, asked.channels)?);
        }
        let healthy: Vec<&dyn Reference> = recordings.iter().map(|one| one as _).collect();
        let learnt = replay::check::learn(&known, &healthy, &mut |_, _| {});
        told.name += &format!(", {:?} {:?}", learnt.knowledge, learnt.notes);
        told.knowledge = learnt.knowledge;
        known = learnt.motor;
        save(seed, "healthy", &known, &recordings[0])?;
    }
    let mut thresholds = None;
    if asked.learnt {
        let recording = machine.recorded(LEARNT_AT, LEARNT_SECONDS, None, random.random())?;
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
    for (place, at) in conditions(asked.moving).into_iter().enumerate() {
        for broken in &broken {
            let fault = broken.as_ref().map(|broken| broken.1.clone());
            // Beyond the breakdown torque no motor runs.
            let Ok(recording) = machine.recorded(at, SECONDS, fault, random.random()) else {
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
                save(seed, &place.to_string(), &known, &recording)?;
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
    let words = Words::given();
    let (machines, seed) = (words.number(0, 60), words.number(1, 1));
    let has = |word| words.has(word);
    let asked = Asked {
        learnt: has("learnt"),
        healthy: has("healthy"),
        faults: has("faults"),
        moving: has("moving"),
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
    print(&all, &asked);
    if has("list") {
        list(&all);
    }
    Ok(())
}

fn print(all: &[Told], asked: &Asked) {
    let names: Vec<&str> = match asked.faults {
        true => faults().into_iter().map(|broken| broken.0).collect(),
        false => vec!["healthy"],
    };
    let head = Condition::head(asked.moving, "load");
    println!("| {head} | FAULT: {} | not judged |", names.join(" | "));
    let columns = head.split('|').count() + names.len() + 1;
    println!("|{}", "---|".repeat(columns));
    let said = || all.iter().flat_map(|told| &told.said);
    for at in conditions(asked.moving) {
        print!("| {} |", at.row());
        for name in &names {
            let here = || said().filter(|j| j.at == at && j.fault == *name);
            let lit = here().filter(|j| j.state == VerdictState::Fault);
            print!(" {} of {} |", lit.count(), here().count());
        }
        let judged = [VerdictState::Healthy, VerdictState::Fault];
        let not = said().filter(|j| j.at == at && !judged.contains(&j.state));
        println!(" {} |", not.count());
    }
}

/// Every FAULT of a healthy motor, and every refusal of a board.
fn list(all: &[Told]) {
    for told in all {
        let lit = |j: &&Judged| j.state == VerdictState::Fault && j.fault == "healthy";
        for j in told.said.iter().filter(lit) {
            println!("{}: {:?}: {}", told.name, j.at, j.first);
        }
        if let Some(refused) = &told.refused {
            println!("{}: {refused}", told.name);
        }
    }
}
