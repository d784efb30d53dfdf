//! False alarms per 1000 motor-days of healthy motors: `docs/fleet/false-alarms.md`.
//!
//! `cargo run --release -p studies --example false-alarms -- --motor-days N --seed S [--week-days D] [--lapse K] [--minutes M] [--machine N] [--alike] [--list]`
//!
//! `--minutes M` begins no machine after M minutes; `--machine N` lives the N-th alone, from 1; `--alike` gives the cage the winding's temperature. Every machine is drawn from its seed, calibrated as a user would do it, and lives for D days (7). Steady hours are made cycle
//! by cycle, events sample by sample (`campaign::hours`); the lamps go through the alarm desk of the gateway.

mod machine;
mod printed;
mod tally;

use std::error::Error;
use std::path::Path;

use motor::MotorFile;
use rayon::prelude::*;

use tally::Tally;

/// Motors that ship without a calibration and without adopted effects.
const MOTORS: [&str; 6] = [
    "assumed-300w",
    "itsc-075hp",
    "peer-2k2",
    "chalmers-4kw",
    "imc-18k5",
    "published-300w",
];

/// What the command line asks for.
struct Asked {
    motor_days: f64,
    seed: u64,
    days: f64,
    lapse: f64,
    minutes: f64,
    machine: Option<u64>,
    alike: bool,
    list: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let asked = asked()?;
    let motors = motors()?;
    let machines = (asked.motor_days / asked.days).ceil() as u64;
    let begin = std::time::Instant::now();
    let tallies: Vec<Tally> = (0..machines)
        .into_par_iter()
        .filter(|k| asked.machine.is_none_or(|only| only == k + 1))
        .filter(|_| begin.elapsed().as_secs_f64() < 60.0 * asked.minutes)
        .map(|k| {
            let seed = asked.seed.wrapping_mul(1_000_003).wrapping_add(k);
            machine::tally(seed, &motors, (asked.days, asked.lapse), asked.alike)
        })
        .collect();
    let seconds = begin.elapsed().as_secs_f64();
    printed::print(&tallies, asked.seed, asked.list);
    eprintln!("{seconds:.0} s on {} threads", rayon::current_num_threads());
    Ok(())
}

fn motors() -> Result<Vec<MotorFile>, Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../motors");
    let read = |name: &&str| MotorFile::read(folder.join(format!("{name}.toml")));
    Ok(MOTORS.iter().map(read).collect::<Result<_, _>>()?)
}

fn asked() -> Result<Asked, Box<dyn Error>> {
    let mut asked = Asked {
        motor_days: 14.0,
        seed: 1,
        days: 7.0,
        lapse: 1.0,
        minutes: f64::INFINITY,
        machine: None,
        alike: false,
        list: false,
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || {
            words
                .next()
                .ok_or(format!("{word} wants a number behind it"))
        };
        match word.as_str() {
            "--motor-days" => asked.motor_days = value()?.parse()?,
            "--seed" => asked.seed = value()?.parse()?,
            "--week-days" => asked.days = value()?.parse()?,
            "--lapse" => asked.lapse = value()?.parse()?,
            "--minutes" => asked.minutes = value()?.parse()?,
            "--machine" => asked.machine = Some(value()?.parse()?),
            "--alike" => asked.alike = true,
            "--list" => asked.list = true,
            _ => {
                return Err(format!(
                    "{word} is not known: use --motor-days N, --seed S, --week-days D, --lapse K, --minutes M, --machine N, --alike or --list"
                )
                .into());
            }
        }
    }
    let positive = asked.motor_days > 0.0 && asked.days > 0.0 && asked.lapse >= 1.0;
    positive
        .then_some(asked)
        .ok_or_else(|| "--motor-days and --week-days must be above 0, --lapse 1 or more".into())
}
