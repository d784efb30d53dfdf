//! Judging in motion, counted: healthy transients, what the T model lacks, faults that come while the machine moves.
//!
//! `cargo run --release -p studies --example transients -- PART DRAWS` prints the tables of `docs/transients.md`; PART is
//! `printed`, `healthy`, `doubts`, `press` or `start`.

mod faults;
mod healthy;
mod judge;
mod printed;

use motor::MotorFile;
use motor::motor_file::LoadKind;

use studies::drive::{Doubts, Drive};

/// The motors that ship, but for those that differ only in what a window at rest is told.
const MOTORS: [&str; 6] = [
    "assumed-300w-calibrated",
    "itsc-075hp",
    "peer-2k2-calibrated",
    "peer-2k2-saturating-calibrated",
    "chalmers-4kw-calibrated",
    "imc-18k5",
];

fn read(name: &str) -> MotorFile {
    let path = format!("{}/../motors/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    MotorFile::read(path).expect("it ships")
}

/// What the monitor is told. A declared friction would not know the loads of these runs: it measures them. Files without a
/// calibration are taken for as well known as the 2.2 kW motor: without one nothing is judged in motion.
fn motor(name: &str) -> MotorFile {
    let mut motor = read(name);
    if motor.load == LoadKind::Friction {
        motor.load = LoadKind::Measured;
    }
    if motor.healthy.is_none() {
        motor.healthy = read("peer-2k2-calibrated").healthy;
    }
    motor
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let draws = arguments.get(1).and_then(|x| x.parse().ok()).unwrap_or(2);
    match arguments.first().map(String::as_str) {
        Some("printed") => printed::table(draws),
        Some("healthy") => healthy::table(draws, &Doubts::USUAL),
        Some("doubts") => healthy::doubts(draws),
        Some("press") => faults::table(draws, Drive::Press, true),
        Some("start") => faults::table(draws, Drive::DirectStart, false),
        _ => println!("printed, healthy, doubts, press or start, and a number of draws"),
    }
}
