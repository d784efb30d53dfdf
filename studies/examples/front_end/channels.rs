//! How small a fault of a channel may be to be seen through a board of the documented parts.

use std::error::Error;
use std::ops::Range;

use crate::installed::{Conditions, DEGC, Installed, WARMTH, between, random_of};
use crate::judge::raw;
use campaign::T_SAMPLE_S;
use monitor::{Lamp, Monitor, MonitorConfig, MonitorState};
use motor::MotorFile;
use rand::Rng;
use rayon::prelude::*;
use scenario::simulate::Simulation;
use scenario::{Fault, Probe, Target};

/// Loads, shares of rated torque, as in the detection campaign.
const LOAD: [f64; 2] = [0.5, 1.2];
/// When the fault comes, s: as of a motor that runs, when the ripple of its inverter has been seen for a while.
const FAULT_FROM_S: f64 = 3.0;
/// When a run ends, s.
const JUDGED_S: f64 = 4.0;
/// Sizes in percent of campaigns/detection.toml and one more, and what they are of: one channel, or all three of a kind.
const ONE_CURRENT: &[f64] = &[1.0, 2.0, 3.0, 6.0];
const ONE_VOLTAGE: &[f64] = &[1.0, 2.0, 4.0, 8.0];
const ALL_CURRENTS: &[f64] = &[2.0, 3.0, 6.0, 12.0];
const ALL_VOLTAGES: &[f64] = &[1.0, 2.0, 3.0, 4.0, 8.0, 16.0];
/// Runs of a hundred that must be seen.
const SEEN: f64 = 0.99;
/// The same from which on the boards that miss it are named.
const MOST: f64 = 0.95;

/// A kind of fault and its sizes.
#[derive(Clone, Copy)]
struct Kind {
    name: &'static str,
    sizes: &'static [f64],
    probe: fn(usize) -> Probe,
    all: bool,
}

const KINDS: [Kind; 4] = [
    Kind {
        name: "`i`",
        sizes: ONE_CURRENT,
        probe: Probe::Current,
        all: false,
    },
    Kind {
        name: "`v`",
        sizes: ONE_VOLTAGE,
        probe: Probe::Voltage,
        all: false,
    },
    Kind {
        name: "`i-all`",
        sizes: ALL_CURRENTS,
        probe: Probe::Current,
        all: true,
    },
    Kind {
        name: "`v-all`",
        sizes: ALL_VOLTAGES,
        probe: Probe::Voltage,
        all: true,
    },
];

impl Kind {
    /// The fault with a change of so many percent, from its time on.
    fn faults(&self, percent: f64, phase: usize) -> Vec<Fault> {
        let phases = if self.all { 0..3 } else { phase..phase + 1 };
        let fault = |phase| Fault {
            from_s: FAULT_FROM_S,
            ..Fault::of(Target::Probe((self.probe)(phase)), percent)
        };
        phases.map(fault).collect()
    }
}

impl Kind {
    /// Changes of the gain, percent: upwards, then downwards.
    fn changes(&self) -> impl Iterator<Item = f64> {
        let up = self.sizes.iter().copied();
        up.chain(self.sizes.iter().map(|size| -size))
    }
}

/// A motor behind a board, and what the monitor has learnt of its noise.
#[derive(Clone)]
struct Running {
    simulation: Simulation,
    state: MonitorState,
}

impl Running {
    /// Whether FAULT is lit in any window until a time.
    fn lights(&mut self, monitor: &Monitor, until_s: f64) -> bool {
        let mut lit = false;
        while self.simulation.now() < until_s
            && let Some(sample) = self.simulation.next()
        {
            let report = monitor.update_raw(&mut self.state, &raw(&sample.measured));
            lit |= report.is_some_and(|report| report.lamps.fault == Lamp::On);
        }
        lit
    }
}

/// A board, and whether FAULT lights, for each kind and change one after another.
struct Judged {
    board: String,
    lights: Vec<bool>,
}

/// What is seen of a board; `None` where calibration refuses it.
fn seen(
    motor: &MotorFile,
    ideal: bool,
    seed: u64,
    k: u64,
) -> Result<Option<Judged>, Box<dyn Error>> {
    let mut random = random_of(seed, k);
    let drawn = Installed::draw(motor, &mut random);
    let installed = if ideal { drawn.without_errors() } else { drawn };
    let Some(calibrated) = installed.calibrated(&mut random, k)? else {
        return Ok(None);
    };
    let monitor = Monitor::new(MonitorConfig::from_motor_file(&calibrated, T_SAMPLE_S)?)?;
    let mut lights = Vec::new();
    for kind in KINDS {
        let at = Conditions {
            load: between(LOAD, &mut random),
            hertz: motor.nameplate.frequency_hz,
            warmth: between(WARMTH, &mut random),
            degc: between(DEGC, &mut random),
        };
        let phase = random.random_range(0..3);
        let mut healthy = Running {
            simulation: installed.simulation(&at, JUDGED_S, random.random())?,
            state: MonitorState::default(),
        };
        if healthy.lights(&monitor, FAULT_FROM_S) {
            return Err(format!("board {k}, {}: FAULT without a fault", motor.name).into());
        }
        // The healthy seconds are the same for each change.
        for percent in kind.changes() {
            let mut faulty = healthy.clone();
            faulty
                .simulation
                .switch_faults(kind.faults(percent, phase))?;
            lights.push(faulty.lights(&monitor, JUDGED_S));
        }
    }
    Ok(Some(Judged {
        board: format!("board {k}, {}", installed.supply()),
        lights,
    }))
}

/// Prints the table of docs/wiring.md.
///
/// # Errors
/// Motor files or conditions that cannot be simulated.
pub fn print(motors: &[(&str, MotorFile)], boards: u64, seed: u64) -> Result<(), Box<dyn Error>> {
    println!("{boards} boards a motor, seed {seed}\n");
    println!("| motor | fault | smallest | instruments without errors | seen at each size |");
    println!("|---|---|---|---|---|");
    for (name, motor) in motors {
        let [real, ideal] = [false, true].map(|ideal| judged(motor, ideal, boards, seed));
        let (real, ideal) = (real?, ideal?);
        eprintln!("{name}: {} of {boards} boards calibrated", real.len());
        let mut from = 0;
        for (kind, sign) in KINDS.iter().flat_map(|kind| [(kind, "+"), (kind, "-")]) {
            let lines = from..from + kind.sizes.len();
            let row = |judged: &[Judged]| Row {
                kind,
                sign,
                shares: lines.clone().map(|line| share(judged, line)).collect(),
            };
            let (row, ideal) = (row(&real), row(&ideal));
            let [smallest, without] = [row.smallest(), ideal.smallest()];
            println!(
                "| {name} | {} | {smallest} | {without} | {} |",
                kind.name,
                row.all()
            );
            tell_few_that_miss(kind, sign, &real, lines.clone());
            from = lines.end;
        }
    }
    Ok(())
}

/// What is seen of every board whose recordings calibrate it.
fn judged(
    motor: &MotorFile,
    ideal: bool,
    boards: u64,
    seed: u64,
) -> Result<Vec<Judged>, Box<dyn Error>> {
    let one = |k| seen(motor, ideal, seed, k).map_err(|error| error.to_string());
    let all: Result<Vec<_>, _> = (0..boards).into_par_iter().map(one).collect();
    Ok(all?.into_iter().flatten().collect())
}

/// Says which boards miss what most see.
fn tell_few_that_miss(kind: &Kind, sign: &str, judged: &[Judged], lines: Range<usize>) {
    for (line, size) in lines.zip(kind.sizes) {
        if share(judged, line) < MOST {
            continue;
        }
        for miss in judged.iter().filter(|one| !one.lights[line]) {
            eprintln!(
                "{} {sign}{size} % is missed behind {}",
                kind.name, miss.board
            );
        }
    }
}

fn share(judged: &[Judged], line: usize) -> f64 {
    let lit = judged.iter().filter(|one| one.lights[line]).count();
    lit as f64 / judged.len().max(1) as f64
}

struct Row<'a> {
    kind: &'a Kind,
    sign: &'a str,
    shares: Vec<f64>,
}

impl Row<'_> {
    /// The smallest size from which on enough are seen.
    fn smallest(&self) -> String {
        let missed = self.shares.iter().rposition(|share| *share < SEEN);
        match self.kind.sizes.get(missed.map_or(0, |last| last + 1)) {
            Some(size) => format!("{}{size} %", self.sign),
            None => "none".into(),
        }
    }

    fn all(&self) -> String {
        let one = |(size, share): (&f64, &f64)| format!("{size} %: {:.0} %", 100.0 * share);
        let all: Vec<String> = self.kind.sizes.iter().zip(&self.shares).map(one).collect();
        all.join(", ")
    }
}
