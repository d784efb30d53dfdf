//! What `explain` says of healthy motors in random operation: shipped motors, random supplies, loads, speeds and recorders, and a
//! motor file that is right. Anything but "adequate" is wrong, except the lateness of an encoder's counts, which is there.
//!
//! `cargo run --release -p studies --example operation -- --cases 60 --first 1`; `--show N` prints the scenario of a case.
//! With `--machines` the circuits and inertias of the motors are drawn around those of their files, and the motor files are right about that.
//! `--save N` writes recording and motor file of a case into the working folder, for `drivemon explain`.
//! With `--bare` the recordings say nothing of their instruments: neither noise nor ranges nor bits, as those of most recorders.

use discovery::{ExplainReport, Verdict, explain};
use motor::MotorFile;
use rand::seq::IndexedRandom;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use recording::{Recording, Sensors, Source};
use scenario::Scenario;
use scenario::simulate::record;
use std::fmt::Write as _;
use std::path::Path;

const MOTORS: [&str; 6] = [
    "assumed-300w",
    "chalmers-4kw",
    "peer-2k2",
    "peer-2k2-saturating",
    "imc-18k5",
    "itsc-075hp",
];
/// Harmonic orders of a supply.
const ORDERS: [i32; 8] = [-5, 7, -11, 13, -17, 19, 3, -3];

/// A scenario as its file says it.
struct Operation {
    seed: u64,
    text: String,
    encoder: bool,
}

/// What is asked of every case.
#[derive(Clone, Copy)]
struct Asked {
    bare: bool,
    machines: bool,
}

impl Operation {
    fn random(seed: u64) -> Self {
        let mut rng = Pcg64::seed_from_u64(seed);
        let motor = pick(&mut rng, &MOTORS);
        let seconds = pick(&mut rng, &[2.0, 4.0, 6.0]);
        let running = rng.random_bool(0.67);
        let rate = pick(&mut rng, &[2000, 5000, 10_000, 10_000, 20_000]);
        let start = if running { "running" } else { "standstill" };
        // A motor that was recorded from its second second on has settled with all its effects.
        let from = if running && rng.random_bool(0.5) {
            1.0
        } else {
            0.0
        };
        let mut text = format!(
            "motor = \"../motors/{motor}.toml\"\nseed = {seed}\nduration_s = {:?}\nstart = \"{start}\"\n\
             sample_rate_hz = {rate}\nrecord_from_s = {from:?}\n",
            seconds + from
        );
        text += &supply(&mut rng, seconds, running);
        text += &load(&mut rng, seconds);
        let speed = pick(&mut rng, &["tachometer", "tachometer", "encoder", "none"]);
        // Without a speed what the motor carries must be recorded.
        let torque = speed == "none" || rng.random_bool(0.5);
        if !torque {
            // Nothing but the motor file tells a load of friction: it must be right.
            for other in ["50", "150"] {
                let of = |percent: &str| format!("friction_percent = {percent}\n");
                text = text.replace(&of(other), &of("100"));
            }
        }
        let noise = pick(&mut rng, &[0.0003, 0.001, 0.002, 0.005]);
        let bits = pick(&mut rng, &[12, 12, 14, 16]);
        let _ = write!(
            text,
            "[sensors]\nnoise_sigma_fraction_of_full_scale = {noise}\nadc_bits = {bits}\nspeed = \"{speed}\"\ntorque = {torque}\n"
        );
        Operation {
            seed,
            text,
            encoder: speed == "encoder",
        }
    }
}

fn pick<T: Copy>(rng: &mut Pcg64, from: &[T]) -> T {
    *from.choose(rng).expect("not empty")
}

fn supply(rng: &mut Pcg64, seconds: f64, running: bool) -> String {
    let mut text = "[supply]\n".to_owned();
    if rng.random_bool(0.6) {
        let (percent, angle) = (rng.random_range(0.0..3.0), rng.random_range(-180.0..180.0));
        let _ = write!(
            text,
            "unbalance_percent = {percent:.2}\nunbalance_angle_deg = {angle:.0}\n"
        );
    }
    if !running && rng.random_bool(0.5) {
        let _ = writeln!(text, "switch_on_s = {:.3}", rng.random_range(0.0..0.3));
    }
    let mut step = |from: f64, to: f64, percent: f64, ramp: f64| {
        let at = rng.random_range(from..to) * seconds;
        format!("{{ at_s = {at:.3}, voltage_percent = {percent:.1}, ramp_s = {ramp} }}")
    };
    let steps = [step(0.3, 0.5, 88.0, 0.3), step(0.8, 0.9, 104.0, 0.0)];
    match rng.random_range(0..4) {
        0 => text += &format!("steps = [{}]\n", steps.join(", ")),
        1 => text += &format!("steps = [{}]\n", steps[1]),
        _ => {}
    }
    if rng.random_bool(0.6) {
        let many = rng.random_range(1..5);
        for order in ORDERS
            .choose_multiple(rng, many)
            .copied()
            .collect::<Vec<_>>()
        {
            let (percent, angle) = (rng.random_range(0.3..4.0), rng.random_range(-180.0..180.0));
            let _ = write!(
                text,
                "[[supply.harmonics]]\norder = {order}\npercent = {percent:.2}\nangle_deg = {angle:.0}\n"
            );
        }
    }
    text
}

fn load(rng: &mut Pcg64, seconds: f64) -> String {
    match rng.random_range(0..4) {
        0 => format!(
            "[load]\nfriction_percent = {}\n",
            pick(rng, &[50, 100, 150])
        ),
        1 => format!(
            "[load]\nconstant_percent = {:.0}\n",
            rng.random_range(5.0..110.0)
        ),
        _ => {
            let n = rng.random_range(2..6);
            let point = |k: i32| {
                let (at, percent) = (
                    seconds * f64::from(k) / f64::from(n),
                    rng.random_range(0.0..120.0),
                );
                format!("{{ at_s = {at:.2}, torque_percent = {percent:.0} }}")
            };
            let points: Vec<String> = (0..n).map(point).collect();
            let between = pick(rng, &["step", "linear"]);
            format!(
                "[load]\nprofile = [{}]\ninterpolation = \"{between}\"\n",
                points.join(", ")
            )
        }
    }
}

/// Another machine of the same kind.
fn scatter(motor: &mut MotorFile, seed: u64) {
    let mut rng = Pcg64::seed_from_u64(seed ^ 0x5EED);
    let mut by = |range: f64| rng.random_range(-range.ln()..range.ln()).exp();
    let circuit = &mut motor.parameters;
    circuit.r_s *= by(1.4);
    circuit.r_r *= by(1.4);
    let leakage = by(1.4);
    circuit.l_ls *= leakage;
    circuit.l_lr *= leakage;
    circuit.l_m *= by(1.25);
    motor.mechanics.inertia *= by(4.0);
}

/// The motor and its recording.
fn recorded(operation: &Operation, asked: Asked) -> Result<(MotorFile, Recording), String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut scenario =
        Scenario::parse(&operation.text, "random.toml", folder).map_err(|e| e.to_string())?;
    if asked.machines {
        scatter(&mut scenario.motor, operation.seed);
    }
    let mut recorded = record(&scenario, |_| {}).map_err(|e| e.to_string())?;
    if asked.bare {
        recorded.metadata.sensors = Sensors::default();
    }
    Ok((scenario.motor, recorded))
}

fn save(seed: u64, asked: Asked) -> Result<(), String> {
    let (motor, recorded) = recorded(&Operation::random(seed), asked)?;
    std::fs::write(format!("motor-{seed}.toml"), motor.to_toml()).map_err(|e| e.to_string())?;
    let path = format!("operation-{seed}.csv.gz");
    formats::write_recording(path.as_ref(), &recorded).map_err(|e| e.to_string())
}

/// What was said, and whether it is right.
fn judged(operation: &Operation, asked: Asked) -> (String, bool) {
    let answer = || -> Result<ExplainReport, String> {
        let (motor, recorded) = recorded(operation, asked)?;
        explain(&[Source::Recording(recorded)], &motor, &mut |_, _| {}).map_err(|e| e.to_string())
    };
    match answer() {
        // A motor that cannot carry its load is no recording.
        Err(error) => (format!("not asked: {error}"), true),
        Ok(report) => {
            let late = |name: &str| operation.encoder && name == "speed-delay";
            let right = match report.verdict {
                Verdict::Adequate | Verdict::Unsupported => true,
                // One change of the speed proves nothing; what would explain it is named.
                Verdict::Unknown => {
                    let rest = report.unexplained.as_ref();
                    rest.and_then(|rest| rest.sufficient_lead())
                        .is_some_and(late)
                }
                _ => !report.steps.is_empty() && report.steps.iter().all(|step| late(&step.effect)),
            };
            (report.summary, right)
        }
    }
}

fn number(name: &str) -> Option<u64> {
    let mut arguments = std::env::args().skip_while(|x| x != name).skip(1);
    arguments.next()?.parse().ok()
}

fn main() {
    if let Some(seed) = number("--show") {
        print!("{}", Operation::random(seed).text);
        return;
    }
    let told = |name: &str| std::env::args().any(|x| x == name);
    let asked = Asked {
        bare: told("--bare"),
        machines: told("--machines"),
    };
    if let Some(seed) = number("--save") {
        save(seed, asked).unwrap_or_else(|error| eprintln!("{error}"));
        return;
    }
    let (cases, first) = (
        number("--cases").unwrap_or(60),
        number("--first").unwrap_or(1),
    );
    let all: Vec<(u64, String, bool)> = (first..first + cases)
        .into_par_iter()
        .map(|seed| {
            let operation = Operation::random(seed);
            let (said, right) = judged(&operation, asked);
            eprintln!("{seed}: {}{said}", if right { "" } else { "WRONG: " });
            (seed, said, right)
        })
        .collect();
    let unasked = all
        .iter()
        .filter(|(_, said, _)| said.starts_with("not asked"))
        .count();
    let wrong: Vec<&(u64, String, bool)> = all.iter().filter(|(_, _, right)| !right).collect();
    println!(
        "{} healthy recordings, {} said wrongly to miss something",
        all.len() - unasked,
        wrong.len()
    );
    for (seed, said, _) in wrong {
        println!("  {seed}: {said}");
    }
}
