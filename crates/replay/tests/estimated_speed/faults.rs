//! Smallest sensor and phase faults that a calibrated motor shows with and without a speed channel.

use std::path::Path;

use motor::MotorFile;
use rayon::prelude::*;
use recording::{Channel, Recording};
use replay::VerdictState;
use replay::check::check;
use replay::speed::{SpeedSource, with_estimated_speed};
use scenario::Scenario;
use scenario::simulate::record;

const MOTORS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../motors");
/// Faults of docs/detection.md with the steps of its plan, percent.
const FAULTS: [(&str, &[f64]); 5] = [
    ("ia", &[1.0, 2.0, 3.0, 6.0, 10.0]),
    ("ib", &[-1.0, -2.0, -3.0, -6.0, -10.0]),
    ("va", &[1.0, 2.0, 4.0, 6.0]),
    ("vb", &[-1.0, -2.0, -4.0, -6.0]),
    ("Rsc", &[10.0, 15.0, 20.0, 30.0, 50.0, 100.0]),
];

/// A motor as simulated, and as calibrated.
struct Pair {
    plant: &'static str,
    calibrated: &'static str,
    /// Line to line, rms, V.
    voltage_volt: u32,
    frequency_hz: u32,
}

const PAIRS: [Pair; 2] = [
    Pair {
        plant: "peer-2k2.toml",
        calibrated: "peer-2k2-calibrated.toml",
        voltage_volt: 400,
        frequency_hz: 50,
    },
    Pair {
        plant: "assumed-300w.toml",
        calibrated: "assumed-300w-calibrated.toml",
        voltage_volt: 220,
        frequency_hz: 60,
    },
];

/// One run: the fault comes while the motor runs, at a load and a voltage (95 to 105 %) by the seed.
fn run(pair: &Pair, seed: u32, fault: &str, size: f64) -> Recording {
    let healthy = size == 0.0;
    let load = 50 + (seed * 29) % 71;
    let voltage = pair.voltage_volt * (950 + (seed * 17) % 101) / 1000;
    let mut text = format!(
        "motor = \"{}\"\nstart = \"running\"\nduration_s = 1.8\nseed = {seed}\n[supply]\nvoltage_line_rms_volt = {voltage}\nfrequency_hz = {}\n\
         unbalance_percent = {:.1}\n[load]\nfriction_percent = 0\nactive = true\nconstant_percent = {load}\n[sensors]\ntorque = false\n",
        pair.plant,
        pair.frequency_hz,
        f64::from(seed % 11) / 10.0
    );
    if !healthy {
        text +=
            &format!("[[faults]]\nfault = \"{fault}\"\nchange_percent = {size}\nfrom_s = 0.6\n");
    }
    let scenario = Scenario::parse(&text, "run.toml", Path::new(MOTORS)).unwrap();
    record(&scenario, |_| {}).unwrap()
}

fn without_speed(recording: &Recording) -> Recording {
    let metadata = recording.metadata.clone();
    let bare = Recording::new("bare", recording.t().to_vec(), metadata).unwrap();
    recording
        .channels()
        .filter(|(channel, _)| *channel != Channel::SPEED)
        .fold(bare, |bare, (channel, x)| {
            bare.with_channel(channel, x.to_vec()).unwrap()
        })
}

/// Share of the runs with FAULT, with and without the speed.
fn seen(pair: &Pair, motor: &MotorFile, fault: &str, size: f64, draws: u32) -> [f64; 2] {
    let counts = (1..=draws).into_par_iter().map(|seed| {
        let recording = run(pair, seed, fault, size);
        [recording.clone(), without_speed(&recording)].map(|recording| {
            let checked = check(&recording, motor, &mut |_| {}).unwrap();
            u32::from(checked.verdict.state == VerdictState::Fault)
        })
    });
    let [with, without] = counts.reduce(|| [0, 0], |a, b| [a[0] + b[0], a[1] + b[1]]);
    [with, without].map(|count| f64::from(count) / f64::from(draws))
}

/// The first size that is seen in 99 of 100 runs, with and without the speed, as places in `sizes`.
fn smallest(pair: &Pair, motor: &MotorFile, fault: &str, sizes: &[f64], draws: u32) -> [usize; 2] {
    let mut shares: Vec<[f64; 2]> = Vec::new();
    for size in sizes {
        shares.push(seen(pair, motor, fault, *size, draws));
        let last = shares.last().expect("pushed above");
        if last.iter().all(|share| *share >= 0.99) {
            break;
        }
    }
    let first = |which: usize| shares.iter().position(|share| share[which] >= 0.99);
    let places = [0, 1].map(first);
    print_row(pair, fault, places, &shares, sizes);
    places.map(|place| place.unwrap_or(sizes.len()))
}

fn print_row(
    pair: &Pair,
    fault: &str,
    places: [Option<usize>; 2],
    shares: &[[f64; 2]],
    sizes: &[f64],
) {
    let [with, without] =
        places.map(|place| place.map_or("none".to_owned(), |k| format!("{:+} %", sizes[k])));
    let each: Vec<String> = shares
        .iter()
        .zip(sizes)
        .map(|([a, b], size)| format!("{size:+}: {:.0}, {:.0}", 100.0 * a, 100.0 * b))
        .collect();
    let each = each.join("; ");
    println!(
        "| {} | `{fault}` | {with} | {without} | {each} |",
        pair.plant
    );
}

/// Without a speed sensor and phase faults keep their smallest sizes within a step of the plan, and the healthy motor stays dark.
#[test]
fn sensor_and_phase_faults_need_no_speed() {
    let draws = super::cases(3) as u32;
    for pair in &PAIRS {
        let motor = MotorFile::read(format!("{MOTORS}/{}", pair.calibrated)).unwrap();
        assert_eq!(seen(pair, &motor, "", 0.0, draws), [0.0, 0.0]);
        for (fault, sizes) in FAULTS {
            let [with, without] = smallest(pair, &motor, fault, sizes, draws);
            assert!(without <= with + 1, "{}: {fault}", pair.plant);
        }
    }
}

/// Steps of a converter without noise leave lines everywhere: they are no slots of any cage.
#[test]
fn steps_of_a_converter_are_no_slot_harmonics() {
    for pair in &PAIRS {
        let recording = without_speed(&run(pair, 1, "", 0.0));
        let motor = MotorFile::read(format!("{MOTORS}/{}", pair.calibrated)).unwrap();
        let (_, speed) = with_estimated_speed(&recording, &motor).unwrap();
        assert_eq!(speed.rotor_bars, [0; 0], "{}", pair.plant);
        assert_eq!(speed.source, SpeedSource::Circuit);
    }
}
