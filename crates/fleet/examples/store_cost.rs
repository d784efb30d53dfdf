//! What a store costs: rate, processor time, bytes a motor and day, time of queries. Prints the tables of docs/fleet/store.md.
//!
//! `cargo run --release -p fleet --example store_cost` (some minutes, some gigabytes in the folder of temporary files); with
//! `months`, the second table alone.

use std::time::Instant;

use fleet::alarm::{AlarmFilter, Rules, Watch};
use fleet::{Entry, Limits, MotorId, MotorInfo, Second, Store};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

type Failed = Box<dyn std::error::Error>;

/// Midnight, so that days of the run are days of the store.
const BEGIN: i64 = 1_789_948_800_000;
const DAY_S: u32 = 86_400;

/// A plant whose motors run at constant load with the noise of a board: 0.05 % of voltage, 0.3 % of current, 2e-3 of the
/// residuals' scales, 5 mHz, 0.3 1/min.
struct Plant {
    motors: Vec<MotorId>,
    rng: Pcg64Mcg,
}

impl Plant {
    fn new(motors: usize) -> Result<Self, Failed> {
        let motors = (0..motors)
            .map(|k| format!("m{k}").parse())
            .collect::<Result<_, _>>()?;
        Ok(Self {
            motors,
            rng: Pcg64Mcg::seed_from_u64(1),
        })
    }

    /// Sum of four uniform numbers: near a normal one of this deviation, and fast.
    fn noise(&mut self, deviation: f32) -> f32 {
        let sum: f32 = (0..4).map(|_| self.rng.random_range(-1.0..1.0_f32)).sum();
        sum * deviation * 0.866
    }

    fn second(&mut self, number: u32) -> Second {
        Second {
            start: 1,
            number,
            time_ms: BEGIN + i64::from(number - 1) * 1000,
            lamps: 1,
            windows: 5,
            judged: 5,
            not_judged: 0,
            fault: 0,
            residuals: Some(std::array::from_fn(|_| self.noise(2e-3))),
            voltage_v: Some(230.0 + self.noise(0.1)),
            current_a: Some(10.0 + self.noise(0.03)),
            frequency_hz: Some(50.0 + self.noise(0.005)),
            speed_rpm: Some(1455.0 + self.noise(0.3)),
        }
    }
}

/// Processor time of this process, s.
fn processor_s() -> Result<f64, Failed> {
    let stat = std::fs::read_to_string("/proc/self/stat")?;
    let after = stat.rsplit_once(')').ok_or("no name in /proc/self/stat")?.1;
    let ticks = after
        .split_whitespace()
        .skip(11)
        .take(2)
        .map(str::parse::<f64>);
    // 100 ticks a second on every Linux of today.
    Ok(ticks.collect::<Result<Vec<_>, _>>()?.iter().sum::<f64>() / 100.0)
}

/// Largest memory of this process so far, MB.
fn memory_mb() -> Result<f64, Failed> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))
        .ok_or("no VmHWM")?;
    Ok(line.trim().trim_end_matches(" kB").parse::<f64>()? / 1000.0)
}

struct Spent {
    store_s: f64,
    alarms_s: f64,
    history_s: f64,
    slowest_ms: f64,
}

/// Stores `seconds` of each motor as a gateway does: four batches a second, alarms after each, upkeep every five seconds.
fn run(store: &Store, plant: &mut Plant, seconds: u32) -> Result<Spent, Failed> {
    let watch = Watch::new(Rules::default());
    let mut spent = Spent {
        store_s: 0.0,
        alarms_s: 0.0,
        history_s: 0.0,
        slowest_ms: 0.0,
    };
    for number in 1..=seconds {
        let motors: Vec<_> = plant.motors.iter().cloned().enumerate().collect();
        let now = BEGIN + i64::from(number) * 1000;
        for part in motors.chunks(motors.len().div_ceil(4)) {
            let entry = |(k, motor): &(usize, MotorId)| {
                let mut second = plant.second(number);
                // One motor of a hundred has a fault.
                if number > 10 && k % 100 == 99 {
                    second.lamps |= 1 << 16;
                }
                (motor.clone(), Entry::Second(second))
            };
            let batch: Vec<_> = part.iter().map(entry).collect();
            let before = (Instant::now(), processor_s()?);
            store.append(&batch)?;
            spent.slowest_ms = f64::max(spent.slowest_ms, before.0.elapsed().as_secs_f64() * 1e3);
            let stored = processor_s()?;
            spent.store_s += stored - before.1;
            watch.work(store, now)?;
            spent.alarms_s += processor_s()? - stored;
        }
        if number % 5 == 0 {
            let before = processor_s()?;
            store.maintain(now)?;
            spent.history_s += processor_s()? - before;
        }
    }
    Ok(spent)
}

fn open(folder: &tempfile::TempDir, plant: &Plant) -> Result<Store, Failed> {
    let store = Store::open(&folder.path().join("plant.db"), &Limits::default())?;
    let motors: Vec<_> = plant.motors.iter().cloned().map(MotorInfo::new).collect();
    store.declare(&motors)?;
    Ok(store)
}

/// Least time of five, ms: what other programs of the machine take is left out as far as it can be.
fn time_ms<T>(work: impl Fn() -> Result<T, fleet::StoreError>) -> Result<f64, Failed> {
    let mut least = f64::INFINITY;
    for _ in 0..5 {
        let before = Instant::now();
        work()?;
        least = least.min(before.elapsed().as_secs_f64() * 1e3);
    }
    Ok(least)
}

fn load(motors: usize, seconds: u32) -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let mut plant = Plant::new(motors)?;
    let store = open(&folder, &plant)?;
    let spent = run(&store, &mut plant, seconds)?;
    let rows = motors as f64 * f64::from(seconds);
    let share = |s: f64| 100.0 * s / f64::from(seconds);
    let states_ms = time_ms(|| store.motors())?;
    let alarms_ms = time_ms(|| store.alarms(&AlarmFilter::default()))?;
    let end = BEGIN + i64::from(seconds) * 1000;
    let hour_ms = time_ms(|| store.trend(&plant.motors[motors / 2], end - 3_600_000, end, 600))?;
    store.seal()?;
    store.maintain(end)?;
    // The queue is empty now: what is left is history, names and states.
    let per_day = store.bytes()? as f64 / rows * f64::from(DAY_S) / 1e6;
    println!(
        "| {motors} | {seconds} | {:.0} | {:.1} | {:.1} | {:.1} | {:.0} | {per_day:.2} | {:.0} | {states_ms:.0} | {alarms_ms:.1} | {hour_ms:.0} |",
        rows / (spent.store_s + spent.alarms_s + spent.history_s),
        share(spent.store_s),
        share(spent.alarms_s),
        share(spent.history_s),
        spent.slowest_ms,
        memory_mb()?,
    );
    Ok(())
}

fn months() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let mut plant = Plant::new(1)?;
    let store = open(&folder, &plant)?;
    let (motor, days) = (plant.motors[0].clone(), 90);
    let mut bytes = Vec::new();
    for day in 0..days {
        let numbers = day * DAY_S + 1..=(day + 1) * DAY_S;
        let batch: Vec<_> = numbers
            .map(|n| (motor.clone(), Entry::Second(plant.second(n))))
            .collect();
        // Ten minutes to a block, as in a plant of up to a thousand motors.
        for part in batch.chunks(600) {
            store.append(part)?;
            store.seal()?;
        }
        store.maintain(BEGIN + i64::from(day + 1) * i64::from(DAY_S) * 1000)?;
        bytes.push(store.bytes()? as f64);
    }
    let minutes = (bytes[59] - bytes[29]) / 30.0;
    println!(
        "a day of seconds {:.2} MB, of minutes and hours {:.3} MB\n",
        (bytes[13] - bytes[0]) / 13e6,
        minutes / 1e6
    );
    println!("| trend of one motor, 1000 points | ms |\n|---|---|");
    let end = BEGIN + i64::from(days) * i64::from(DAY_S) * 1000;
    for (words, hours) in [
        ("an hour", 1),
        ("a day", 24),
        ("a week", 168),
        ("ten days", 240),
        ("90 days", 2160),
    ] {
        let from = end - hours * 3_600_000;
        println!(
            "| {words} | {:.1} |",
            time_ms(|| store.trend(&motor, from, end, 1000))?
        );
    }
    Ok(())
}

fn main() -> Result<(), Failed> {
    if std::env::args().any(|arg| arg == "months") {
        return months();
    }
    println!(
        "| motors | s | seconds stored per s of processor | store, % of a core | alarms, % | history, % | slowest batch, ms | MB per motor and day | memory, MB | all states, ms | alarms, ms | trend of an hour, ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    load(300, 3600)?;
    load(1000, 1200)?;
    load(10_000, 300)?;
    println!();
    months()
}
