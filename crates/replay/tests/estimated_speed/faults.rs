//! Smallest sensor and phase faults that a calibrated motor shows with and without a speed channel.

use std::path::Path;

use motor::MotorFile;
use rayon::prelude::*;
use recording::{Channel, Metadata, Recording};
use replay::VerdictState;
use replay::check::check;
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

/// One run: the fault comes while the motor runs, at a load and voltage by the seed.
fn run(seed: u32, fault: &str, size: f64) -> Recording {
    let healthy = size == 0.0;
    let load = 50 + (seed * 29) % 71;
    let voltage = 380 + (seed * 17) % 41;
    let mut text = format!(
        "motor = \"peer-2k2.toml\"\nstart = \"running\"\nduration_s = 1.8\nseed = {seed}\n[supply]\nvoltage_line_rms_volt = {voltage}\n\
         unbalance_percent = {:.1}\n[load]\nfriction_percent = 0\nactive = true\nconstant_percent = {load}\n[sensors]\ntorque = false\n",
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
    let bare = Recording::new("bare", recording.t().to_vec(), Metadata::default()).unwrap();
    recording
        .channels()
        .filter(|(channel, _)| *channel != Channel::SPEED)
        .fold(bare, |bare, (channel, x)| {
            bare.with_channel(channel, x.to_vec()).unwrap()
        })
}

/// Share of the runs with FAULT, with and without the speed.
fn seen(motor: &MotorFile, fault: &str, size: f64, draws: u32) -> [f64; 2] {
    let counts = (1..=draws).into_par_iter().map(|seed| {
        let recording = run(seed, fault, size);
        [recording.clone(), without_speed(&recording)].map(|recording| {
            let checked = check(&recording, motor, &mut |_| {}).unwrap();
            u32::from(checked.verdict.state == VerdictState::Fault)
        })
    });
    let [with, without] = counts.reduce(|| [0, 0], |a, b| [a[0] + b[0], a[1] + b[1]]);
    [with, without].map(|count| f64::from(count) / f64::from(draws))
}

/// Without a speed sensor and phase faults keep their smallest sizes within a step of the plan, and the healthy motor stays dark.
#[test]
fn sensor_and_phase_faults_need_no_speed() {
    let draws = super::cases(3) as u32;
    let motor = MotorFile::read(format!("{MOTORS}/peer-2k2-calibrated.toml")).unwrap();
    assert_eq!(seen(&motor, "", 0.0, draws), [0.0, 0.0]);
    for (fault, sizes) in FAULTS {
        let mut shares: Vec<[f64; 2]> = Vec::new();
        for size in sizes {
            shares.push(seen(&motor, fault, *size, draws));
            if shares
                .last()
                .is_some_and(|both| both.iter().all(|share| *share >= 0.99))
            {
                break;
            }
        }
        let first = |which: usize| shares.iter().position(|share| share[which] >= 0.99);
        let size =
            |place: Option<usize>| place.map_or("none".to_owned(), |k| format!("{:+} %", sizes[k]));
        println!(
            "| `{fault}` | {} | {} | {} |",
            size(first(0)),
            size(first(1)),
            shares
                .iter()
                .zip(sizes)
                .map(|([a, b], size)| format!("{size:+}: {:.0}, {:.0}", 100.0 * a, 100.0 * b))
                .collect::<Vec<_>>()
                .join("; ")
        );
        let [with, without] = [0, 1].map(|which| first(which).unwrap_or(sizes.len()));
        assert!(without <= with + 1, "{fault}: {shares:?}");
    }
}
