//! Motors beyond what their calibration saw, with effects that their motor files do not know: how often FAULT lights.
//!
//! `cargo run --release -p studies --example beyond_calibration -- MACHINES SEED [WORD...]` draws motors around those that ship, hides up to
//! two effects in each, calibrates it as docs/calibrate.md asks at three loads up to a part of the rated one, and judges it at other
//! loads, voltages and frequencies. The words:
//!
//! - `one`: one recording at the largest load is all that the calibration gets; `moved`: it gets a start and a press beside its loads.
//! - `moving`: judged while it starts, is loaded or slowed.
//! - `hard`: iron and leakage saturate harder than commonly.
//! - `without`: the motor file forgets what the calibration saw.
//! - `faults`: the motors have faults, and FAULT is right.
//! - `list`: every FAULT; `save`: its recording and motor file, in the working folder.

use std::error::Error;

use audit::{Expectation, audit};
use monitor::Monitor;
use motor::InMotion;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use recording::Recording;
use replay::{Samples, VerdictState};
use scenario::Fault;
use studies::broken::{Broken, faults};
use studies::condition::Condition;
use studies::hidden::Machine;
use studies::words::Words;

/// What is judged at rest: load, share of the largest of the calibration, and voltage and frequency, shares of the rated ones.
const AT_REST: [[f64; 3]; 20] = [
    [0.3, 1.0, 1.0],
    [0.9, 1.0, 1.0],
    [1.1, 1.0, 1.0],
    [1.25, 1.0, 1.0],
    [1.5, 1.0, 1.0],
    [2.0, 1.0, 1.0],
    [0.8, 0.98, 1.0],
    [0.8, 1.02, 1.0],
    [0.8, 0.95, 1.0],
    [0.8, 1.05, 1.0],
    [0.8, 0.9, 1.0],
    [0.8, 1.1, 1.0],
    [0.1, 0.9, 1.0],
    [0.1, 1.1, 1.0],
    [0.8, 0.8, 0.8],
    [0.8, 0.5, 0.5],
    [-0.1, 1.0, 1.0],
    [-0.5, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [-0.5, 1.05, 1.0],
];
/// What is judged in motion: voltages, shares of the rated one.
const VOLTAGES: [f64; 3] = [0.93, 1.0, 1.07];

fn conditions(moving: bool) -> Vec<Condition> {
    Condition::all(moving, &AT_REST, VOLTAGES)
}

/// Loads are shares of the largest of the calibration.
fn recorded(
    machine: &Machine,
    at: Condition,
    fault: Option<Fault>,
    seed: u64,
) -> Result<Recording, Box<dyn Error>> {
    match at {
        Condition::AtRest([ratio, volt, hertz]) => {
            machine.recorded([ratio * machine.highest, volt, hertz], fault, seed)
        }
        Condition::InMotion(drive, volt) => machine.moved(drive, volt, fault, seed),
    }
}

/// What is asked.
#[derive(Clone, Copy)]
struct Asked {
    one: bool,
    moving: bool,
    moved: bool,
    hard: bool,
    without: bool,
    faults: bool,
    list: bool,
    save: bool,
}

/// What was said of a machine under a condition.
struct Judged {
    at: Condition,
    /// How its calibration says that it moves.
    in_motion: InMotion,
    /// Alarms that were raised in motion.
    alarms: usize,
    fault: &'static str,
    state: VerdictState,
    first: String,
}

/// A machine, and what was said of it; nothing where its calibration is refused.
type Told = (Machine, Option<Vec<Judged>>);

fn judged(seed: u64, asked: &Asked) -> Result<Told, Box<dyn Error>> {
    let mut random = Pcg64::seed_from_u64(seed);
    let machine = Machine::draw(&mut random, asked.hard)?;
    let mut calibrated = match machine.calibrated(asked.one, asked.moved, &mut random) {
        Ok(calibrated) => calibrated,
        Err(refusal) => {
            if asked.list {
                eprintln!(
                    "{}, hidden {}: {refusal}",
                    machine.motor.name,
                    machine.names()
                );
            }
            return Ok((machine, None));
        }
    };
    let in_motion = calibrated.healthy.as_ref().map(|h| h.in_motion);
    if asked.without
        && let Some(healthy) = &mut calibrated.healthy
    {
        healthy.range = None;
    }
    let broken: Vec<Option<Broken>> = match asked.faults {
        true => faults().into_iter().map(Some).collect(),
        false => vec![None],
    };
    let mut all = Vec::new();
    for at in conditions(asked.moving) {
        for broken in &broken {
            let fault = broken.as_ref().map(|broken| broken.1.clone());
            // Beyond the breakdown torque no motor runs.
            let Ok(recording) = recorded(&machine, at, fault, random.random()) else {
                continue;
            };
            let audit = audit(&recording, &Expectation::from(&calibrated));
            let monitor = Monitor::new(replay::config_for(&calibrated, &recording)?)?;
            let samples = Samples::new(&recording, &audit);
            let timeline = replay::replay(&monitor, &samples, &mut |_| {});
            let verdict = timeline.verdict(&[]);
            if asked.save && verdict.state == VerdictState::Fault {
                let name = format!("beyond-{seed}-{}", all.len());
                std::fs::write(format!("{name}-motor.toml"), calibrated.to_toml())?;
                formats::write_recording(format!("{name}.parquet").as_ref(), &recording)?;
            }
            let first = verdict.candidates.first().map(|first| {
                let size = first.size_percent.unwrap_or(f64::NAN);
                format!("{:?} {:?} {size:.1} %", first.fault, first.phase)
            });
            all.push(Judged {
                at,
                in_motion: in_motion.unwrap_or_default(),
                alarms: timeline.motion.alarms.len(),
                fault: broken.as_ref().map_or("healthy", |broken| broken.0),
                state: verdict.state,
                first: first.unwrap_or_default(),
            });
        }
    }
    Ok((machine, Some(all)))
}

fn main() -> Result<(), Box<dyn Error>> {
    let words = Words::given();
    let (machines, seed) = (words.number(0, 60), words.number(1, 1));
    let has = |word| words.has(word);
    let asked = Asked {
        one: has("one"),
        moving: has("moving"),
        moved: has("moved"),
        hard: has("hard"),
        without: has("without"),
        faults: has("faults"),
        list: has("list"),
        save: has("save"),
    };
    let one = |k| judged(1_000_003 * seed + k, &asked).map_err(|error| error.to_string());
    let all: Result<Vec<Told>, String> = (0..machines).into_par_iter().map(one).collect();
    let all = all?;
    let refused = all.iter().filter(|(_, judged)| judged.is_none()).count();
    let in_motion = |seen| {
        let judged = all
            .iter()
            .filter_map(|(_, judged)| judged.as_ref()?.first());
        judged.filter(|judged| judged.in_motion == seen).count()
    };
    println!(
        "{machines} machines, {refused} not calibrated; in motion {} fit, {} differ\n",
        in_motion(InMotion::Fits),
        in_motion(InMotion::Differs)
    );
    print(&all, &asked);
    Ok(())
}

fn print(all: &[Told], asked: &Asked) {
    let names: Vec<&str> = match asked.faults {
        true => faults().into_iter().map(|broken| broken.0).collect(),
        false => vec!["healthy"],
    };
    let head = Condition::head(asked.moving, "load, of the largest calibrated");
    println!("| {head} | FAULT: {} |", names.join(" | "));
    println!("|{}", "---|".repeat(head.split('|').count() + names.len()));
    let said = || all.iter().flat_map(|(_, judged)| judged).flatten();
    for at in conditions(asked.moving) {
        print!("| {} |", at.row());
        for name in &names {
            let here = || said().filter(|j| j.at == at && j.fault == *name);
            let lit = here().filter(|j| j.state == VerdictState::Fault);
            print!(" {} of {} |", lit.count(), here().count());
        }
        println!();
    }
    let lit = |j: &&Judged| asked.list && j.state == VerdictState::Fault;
    for (machine, judged) in all {
        for j in judged.iter().flatten().filter(lit) {
            println!(
                "{}, {:?}, hidden {}, calibrated to {}, in motion {:?}: {} at {:?}, {} alarms in motion: {}",
                machine.motor.name,
                machine.motor.load,
                machine.names(),
                machine.highest,
                j.in_motion,
                j.fault,
                j.at,
                j.alarms,
                j.first
            );
        }
    }
}
