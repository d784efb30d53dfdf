//! Judging in motion, counted: false alarms of healthy transients, and faults that come while the machine moves.
//!
//! `cargo run --release -p studies --example transients -- healthy 6`, `faults 10`, `doubts 4`.

mod drive;
mod judge;

use drive::{Break, DRIVES, Doubts, Drive, run};
use judge::{Outcome, judge};
use motor::MotorFile;
use rayon::prelude::*;

const MOTORS: [&str; 8] = [
    "assumed-300w",
    "assumed-300w-calibrated",
    "peer-2k2",
    "peer-2k2-calibrated",
    "peer-2k2-saturating-calibrated",
    "chalmers-4kw-calibrated",
    "itsc-075hp",
    "imc-18k5",
];

fn motor(name: &str) -> MotorFile {
    let path = format!("{}/../motors/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let mut motor = MotorFile::read(path).expect("it ships");
    if motor.load == motor::motor_file::LoadKind::Friction {
        motor.load = motor::motor_file::LoadKind::Measured;
    }
    motor
}

fn healthy(draws: u64, doubts: &Doubts, label: &str, motors: &[&str]) {
    println!("{label}");
    let (mut all, mut alarms) = (0, 0);
    for name in motors {
        let believed = motor(name);
        for drive in DRIVES {
            let outcomes: Vec<Outcome> = (0..draws)
                .into_par_iter()
                .map(|k| {
                    let run = run(&believed, drive, doubts, None, 1000 * drive as u64 + k);
                    judge(&believed, &run, doubts, false)
                })
                .filter_map(|outcome| match outcome {
                    Ok(outcome) => Some(outcome),
                    Err(error) => {
                        println!("{name} {}: {error}", drive.name());
                        None
                    }
                })
                .collect();
            all += outcomes.len();
            let lit = outcomes.iter().filter(|o| o.alarm_s.is_some()).count();
            alarms += lit;
            let most = |f: fn(&Outcome) -> f32| outcomes.iter().map(f).fold(0.0, f32::max);
            let sum = |f: fn(&Outcome) -> u32| outcomes.iter().map(f).sum::<u32>();
            let mut rows = [0.0_f64; 2];
            let mut n = 0.0;
            for (r, judged) in outcomes.iter().flat_map(|o| &o.rows) {
                if *judged {
                    n += 1.0;
                    rows[0] += r[..4].iter().map(|x| f64::from(x * x)).sum::<f64>() / 4.0;
                    rows[1] += f64::from(r[4] * r[4]);
                }
            }
            let reasons: Vec<_> = outcomes.iter().flat_map(|o| o.reasons.iter().map(|(r, n)| format!("{r:?} {n}"))).take(4).collect();
            println!(
                "{name:32} {:32} alarms {lit} T {:.1} chi2 {:.0} judged {} of {} E {:.3} % Q {:.2} % steady {} {:?} {:?}",
                drive.name(),
                most(|o| o.largest),
                most(|o| o.largest_square),
                sum(|o| o.judged),
                sum(|o| o.cycles),
                100.0 * (rows[0] / n).sqrt(),
                100.0 * (rows[1] / n).sqrt(),
                outcomes.iter().filter(|o| o.steady_s.is_some()).count(),
                outcomes.iter().find_map(|o| o.named),
                reasons,
            );
        }
    }
    println!("{alarms} of {all} with an alarm");
}

use scenario::{Asymmetry, Parameter, Probe, Target};
use drive::DURING_S;

const FAULTS: [(&str, &[Target], f64); 11] = [
    ("Rs +15 %", &[Target::Parameter(Parameter::Rs)], 15.0),
    ("Rs +30 %", &[Target::Parameter(Parameter::Rs)], 30.0),
    ("Rr +15 %", &[Target::Parameter(Parameter::Rr)], 15.0),
    ("ia 3 %", &[Target::Probe(Probe::Current(0))], 3.0),
    ("ib 10 %", &[Target::Probe(Probe::Current(1))], 10.0),
    ("va 2 %", &[Target::Probe(Probe::Voltage(0))], 2.0),
    ("ia dead", &[Target::Probe(Probe::Current(0))], -100.0),
    ("vb dead", &[Target::Probe(Probe::Voltage(1))], -100.0),
    ("speed 1 %", &[Target::Probe(Probe::Speed)], 1.0),
    ("Rsb +30 %", &[Target::Asymmetry(Asymmetry::Series(1))], 30.0),
    ("Bl +25 %", &[Target::Parameter(Parameter::Bl)], 25.0),
];

fn faults(draws: u64, drive: Drive, during: bool, doubts: &Doubts, motors: &[&str]) {
    println!("{} {}", drive.name(), if during { "comes in" } else { "there before" });
    for name in motors {
        let believed = motor(name);
        for (label, targets, percent) in FAULTS {
            let fault = Break { name: label, targets, percent, from_s: during.then_some(DURING_S) };
            let outcomes: Vec<(Outcome, f64)> = (0..draws)
                .into_par_iter()
                .filter_map(|k| {
                    let run = run(&believed, drive, doubts, Some(&fault), 500_000 + k);
                    let begin = if during { run.fault_s } else { run.on_s };
                    judge(&believed, &run, doubts, true).ok().map(|o| (o, begin))
                })
                .collect();
            let mut delays: Vec<f64> = outcomes.iter().filter(|(o, _)| !o.early).filter_map(|(o, b)| o.alarm_s.map(|t| 1e3 * (t - b))).collect();
            delays.sort_by(f64::total_cmp);
            let steady = outcomes.iter().filter(|(o, _)| o.steady_s.is_some()).count();
            let early = outcomes.iter().filter(|(o, _)| o.early).count();
            println!(
                "{name:32} {label:10} found {}/{} early {early} median {:.0} ms; steady {steady}; {:?}",
                delays.len(),
                outcomes.len(),
                delays.get(delays.len() / 2).copied().unwrap_or(f64::NAN),
                outcomes.iter().map(|(o, _)| o.named.map(|n| format!("{n:?}").replace("Departure", ""))).collect::<Vec<_>>(),
            );
        }
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize| arguments.get(k).and_then(|x| x.parse().ok()).unwrap_or(2);
    match arguments.first().map(String::as_str) {
        Some("plain") => healthy(number(1), &Doubts { bends: false, wrong: 0.0, ..Doubts::USUAL }, "plain", &MOTORS[2..4]),
        Some("linear") => healthy(number(1), &Doubts { bends: false, ..Doubts::USUAL }, "linear", &MOTORS),
        Some("healthy") => healthy(number(1), &Doubts::USUAL, "usual", &MOTORS),
        Some("warm") => healthy(number(1), &Doubts { warm_k: 100.0, ..Doubts::USUAL }, "warm", &MOTORS),
        Some("one") => {
            let believed = motor(&arguments[1]);
            let drive = DRIVES[arguments[2].parse::<usize>().unwrap()];
            let d = if arguments.len() > 4 { Doubts { bends: false, wrong: 0.0, ..Doubts::USUAL } } else { Doubts::USUAL };
            let r = run(&believed, drive, &d, None, 1000 * drive as u64 + arguments[3].parse::<u64>().unwrap());
            println!("{:?}", r.scenario.effects);
            let _ = judge(&believed, &r, &d, false);
        }
        Some("doubts") => {
            let n = number(1);
            let u = Doubts::USUAL;
            healthy(n, &Doubts { undeclared_iron: 0.15, ..u }, "iron of 0.15 that is not declared", &["peer-2k2-calibrated", "assumed-300w"]);
            healthy(n, &Doubts { offset: 0.005, ..u }, "offset of 0.5 % of full scale in current a", &["peer-2k2-calibrated", "assumed-300w", "imc-18k5"]);
            healthy(n, &Doubts { late_s: 5e-6, ..u }, "currents 5 us late", &["peer-2k2-calibrated", "assumed-300w", "imc-18k5"]);
            healthy(n, &Doubts { backwards: true, ..u }, "backwards", &["peer-2k2-saturating-calibrated", "assumed-300w", "imc-18k5"]);
            healthy(n, &Doubts { noise: 0.005, ..u }, "noise 0.5 %", &["peer-2k2-calibrated", "assumed-300w", "imc-18k5"]);
        }
        Some("press") => faults(number(1), Drive::Press, true, &Doubts::USUAL, &MOTORS),
        Some("start") => faults(number(1), Drive::DirectStart, false, &Doubts::USUAL, &MOTORS),
        _ => println!("say what"),
    }
}
