//! How many healthy motors light FAULT because of their board's parts alone.
//!
//! `cargo run --release -p studies --example front_end [BOARDS] [SEED]` prints the table of docs/wiring.md: boards drawn
//! within the tolerances of the bill of materials, a healthy motor at rated load behind each, judged by the core with the
//! motor file's thresholds, from the converter's codes as on the board. What is known of the chain stands in the motor file.
//!
//! `... front_end anywhere [BOARDS] [SEED] [FIRST]` calibrates each board and motor as the pages say, and judges the healthy motor at other
//! loads, frequencies and temperatures, on a grid or behind an inverter. A board depends on the seed and its number alone: what was
//! cut off goes on from board FIRST, and the counts of both runs are added.
//!
//! `... front_end channels [BOARDS] [SEED]` shows how small a channel's fault may be behind such boards.

mod anywhere;
mod board;
mod channels;
mod counts;
mod installed;
mod judge;

use board::{Board, Variant};
use counts::Counts;
use judge::{Judged, judge};
use motor::MotorFile;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use rayon::prelude::*;
use std::error::Error;

const MOTORS: [(&str, &str); 3] = [
    ("300 W", "assumed-300w"),
    ("2.2 kW", "peer-2k2"),
    ("18.5 kW", "imc-18k5"),
];
const BOARDS: u32 = 200;
const SEED: u64 = 7;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1).peekable();
    if arguments.next_if(|mode| mode == "anywhere").is_some() {
        return print_anywhere(arguments);
    }
    if arguments.next_if(|mode| mode == "channels").is_some() {
        return print_channels(arguments);
    }
    let boards = arguments.next().map_or(Ok(BOARDS), |text| text.parse())?;
    let seed = arguments.next().map_or(Ok(SEED), |text| text.parse())?;
    println!("{boards} boards a row, seed {seed}; r4 in percent of its scale, its limit is 0.3\n");
    println!("| front end | motor | FAULT | SENSOR | r4 mean | r4 from .. to |");
    println!("|---|---|---|---|---|---|");
    for variant in Variant::ALL {
        for (name, file) in MOTORS {
            let motor = shipped(file)?;
            row(variant, name, &motor, boards, seed)?;
        }
    }
    Ok(())
}

fn row(
    variant: Variant,
    name: &str,
    motor: &MotorFile,
    boards: u32,
    seed: u64,
) -> Result<(), Box<dyn Error>> {
    // The same boards in front of every motor.
    let mut random = Pcg64::seed_from_u64(seed);
    let mut all = Vec::new();
    for _ in 0..boards {
        all.push(judge(&Board::draw(variant, &mut random), motor)?);
    }
    let share = |of: fn(&Judged) -> bool| {
        100.0 * all.iter().filter(|x| of(x)).count() as f64 / f64::from(boards)
    };
    let r4: Vec<f64> = all.iter().map(|x| x.r4_percent).collect();
    let mean = r4.iter().sum::<f64>() / f64::from(boards);
    let least = r4.iter().copied().fold(f64::INFINITY, f64::min);
    let most = r4.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    println!(
        "| {} | {name} | {:.1} % | {:.1} % | {mean:+.2} | {least:+.2} .. {most:+.2} |",
        variant.name(),
        share(|x| x.fault),
        share(|x| x.sensor),
    );
    Ok(())
}

const CALIBRATED: [&str; 5] = [
    "assumed-300w",
    "peer-2k2",
    "chalmers-4kw",
    "imc-18k5",
    "itsc-075hp",
];
/// Boards in front of a motor whose channels fail.
const CHANNEL_BOARDS: u64 = 100;
/// Boards between two lines of progress.
const PORTION: u64 = 200;

fn print_anywhere(mut arguments: impl Iterator<Item = String>) -> Result<(), Box<dyn Error>> {
    let boards = arguments
        .next()
        .map_or(Ok(u64::from(BOARDS)), |text| text.parse())?;
    let seed = arguments.next().map_or(Ok(SEED), |text| text.parse())?;
    let first = arguments.next().map_or(Ok(0), |text| text.parse())?;
    let motors = CALIBRATED
        .iter()
        .map(|name| shipped(name))
        .collect::<Result<Vec<_>, _>>()?;
    let mut counts = Counts::default();
    for from in (first..boards).step_by(PORTION as usize) {
        let portion = from..boards.min(from + PORTION);
        let one = |k| anywhere::judged(&motors, seed, k).map_err(|error| error.to_string());
        let outcomes: Vec<_> = portion.into_par_iter().map(one).collect::<Result<_, _>>()?;
        outcomes.iter().for_each(|outcome| counts.add(outcome));
        // A run of hours that is cut off has told what it found so far.
        eprintln!("boards {first} to {boards}: {counts}");
    }
    println!(
        "boards {first} to {boards}, seed {seed}, each judged at {} conditions\n",
        anywhere::CONDITIONS
    );
    print!("{}", counts.table());
    Ok(())
}

fn print_channels(mut arguments: impl Iterator<Item = String>) -> Result<(), Box<dyn Error>> {
    let boards = arguments
        .next()
        .map_or(Ok(CHANNEL_BOARDS), |text| text.parse())?;
    let seed = arguments.next().map_or(Ok(SEED), |text| text.parse())?;
    let motors = [
        ("300 W", shipped("assumed-300w")?),
        ("2.2 kW", shipped("peer-2k2")?),
    ];
    channels::print(&motors, boards, seed)
}

/// A shipped motor file.
fn shipped(name: &str) -> Result<MotorFile, Box<dyn Error>> {
    let path = format!("{}/../motors/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    Ok(MotorFile::read(path)?)
}
