//! Faults in motion: share found, median delay, cause.

use monitor::{Cause, MovingCause, Phase, SensorFinding};
use motion::Named;
use rayon::prelude::*;
use scenario::{Asymmetry, Parameter, Probe, Target};

use crate::judge::{Outcome, judge};
use crate::{MOTORS, motor};
use studies::drive::{Break, DURING_S, Doubts, Drive, run};

struct Fault {
    label: &'static str,
    targets: &'static [Target],
    percent: f64,
    right: MovingCause,
}

const fn fault(
    label: &'static str,
    targets: &'static [Target],
    percent: f64,
    cause: Cause,
) -> Fault {
    let right = MovingCause::Departure(cause);
    Fault {
        label,
        targets,
        percent,
        right,
    }
}

const I_A: &[Target] = &[Target::Probe(Probe::Current(0))];
const U_B: &[Target] = &[Target::Probe(Probe::Voltage(1))];
const R_S: &[Target] = &[Target::Parameter(Parameter::Rs)];
const R_R: &[Target] = &[Target::Parameter(Parameter::Rr)];
const SERIES: &[Target] = &[Target::Asymmetry(Asymmetry::Series(1))];
const SPEED: &[Target] = &[Target::Probe(Probe::Speed)];

const FAULTS: [Fault; 12] = [
    fault("R_s +15 %", R_S, 15.0, Cause::StatorResistance),
    fault("R_s +30 %", R_S, 30.0, Cause::StatorResistance),
    fault("R_r +15 %", R_R, 15.0, Cause::RotorResistance),
    fault("R_r +30 %", R_R, 30.0, Cause::RotorResistance),
    fault(
        "current gain a 3 %",
        I_A,
        3.0,
        Cause::CurrentChannel(Phase::A),
    ),
    fault(
        "current gain a 10 %",
        I_A,
        10.0,
        Cause::CurrentChannel(Phase::A),
    ),
    Fault {
        label: "current a dead",
        targets: I_A,
        percent: -100.0,
        right: MovingCause::Dead(SensorFinding::DeadCurrent(Phase::A)),
    },
    fault(
        "voltage gain b 2 %",
        U_B,
        2.0,
        Cause::VoltageChannel(Phase::B),
    ),
    fault(
        "voltage gain b 10 %",
        U_B,
        10.0,
        Cause::VoltageChannel(Phase::B),
    ),
    Fault {
        label: "voltage b dead",
        targets: U_B,
        percent: -100.0,
        right: MovingCause::Dead(SensorFinding::DeadVoltage(Phase::B)),
    },
    fault("speed 1 %", SPEED, 1.0, Cause::SpeedGain),
    fault(
        "series resistance b 30 %",
        SERIES,
        30.0,
        Cause::SeriesResistance(Phase::B),
    ),
];

/// One row a fault, one column a motor: found of runs, within 150 ms, median delay, cause right of those named.
pub fn table(draws: u64, drive: Drive, during: bool) {
    println!("| fault | {} |", MOTORS.join(" | "));
    println!("|---|{}", "---|".repeat(MOTORS.len()));
    for fault in &FAULTS {
        let cells = MOTORS.map(|name| cell(name, fault, drive, during, draws));
        println!("| {} | {} |", fault.label, cells.join(" | "));
    }
}

fn cell(name: &str, fault: &Fault, drive: Drive, during: bool, draws: u64) -> String {
    let believed = motor(name);
    let doubts = Doubts::USUAL;
    let coming = Break {
        targets: fault.targets,
        percent: fault.percent,
        from_s: during.then_some(DURING_S),
    };
    let outcomes: Vec<(Outcome, f64)> = (0..draws)
        .into_par_iter()
        .filter_map(|k| {
            let run = run(&believed, drive, &doubts, Some(&coming), 500_000_000 + k);
            let begins = if during { run.fault_s } else { run.on_s };
            let outcome = judge(&believed, &run, &doubts, true).ok()?;
            Some((outcome, begins))
        })
        .collect();
    let found = outcomes.iter().filter(|(o, _)| !o.early);
    let delay = |(o, begins): &(Outcome, f64)| o.alarm_s.map(|t| 1e3 * (t - begins));
    let mut delays: Vec<f64> = found.filter_map(delay).collect();
    delays.sort_by(f64::total_cmp);
    let fast = delays.iter().filter(|delay| **delay <= 150.0).count();
    let named: Vec<_> = outcomes.iter().filter_map(|(o, _)| o.named).collect();
    let is_right = |named: &Named| match named {
        Named::Fault(found) => found.cause == fault.right,
        Named::Untold => false,
    };
    let right = named.iter().filter(|named| is_right(named)).count();
    let Some(median) = delays.get(delays.len() / 2) else {
        return format!("0 of {}", outcomes.len());
    };
    format!(
        "{} of {}, {fast} in 150 ms, {median:.0} ms, right {right} of {}",
        delays.len(),
        outcomes.len(),
        named.len()
    )
}
