//! Motors beyond what their calibration saw, with effects that their motor files do not know: how often FAULT lights.
//!
//! `cargo run --release -p studies --example beyond_calibration -- MACHINES SEED [one] [without] [faults] [list]` draws motors around those that
//! ship, hides up to two effects in each, calibrates it as docs/calibrate.md asks at three loads up to a part of the rated one, and judges
//! it at other loads, voltages and frequencies. `one`: one recording at the largest load is all that the calibration gets. `without`: the motor file forgets
//! what the calibration saw. `faults`: the motors have faults, and FAULT is right. `list`: every FAULT.

use audit::{Expectation, audit};
use monitor::Monitor;
use motor::MotorFile;
use motor::dynamic::Harmonic;
use motor::motor_file::{EffectEntry, LoadKind};
use num_complex::Complex64;
use rand::seq::{IndexedRandom, SliceRandom};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use recording::Recording;
use replay::calibrate::{Surroundings, calibrate};
use replay::{Samples, VerdictState};
use scenario::simulate::record;
use scenario::{
    Asymmetry, Change, Fault, Load, LoadSpec, Parameter, Piecewise, Probe, Scenario, SensorSpec,
    Start, SupplySpec, Target,
};
use std::error::Error;

const MOTORS: [&str; 5] = [
    "assumed-300w",
    "itsc-075hp",
    "peer-2k2",
    "chalmers-4kw",
    "imc-18k5",
];
/// The largest load of the calibration, share of the rated torque.
const HIGHEST: [f64; 3] = [0.5, 0.75, 1.0];
/// Loads of the calibration, shares of the largest.
const CALIBRATED: [f64; 3] = [0.1, 0.5, 1.0];
/// What is judged: load, share of the largest of the calibration, and voltage and frequency, shares of the rated ones.
const JUDGED: [[f64; 3]; 14] = [
    [0.3, 1.0, 1.0],
    [0.9, 1.0, 1.0],
    [1.1, 1.0, 1.0],
    [1.25, 1.0, 1.0],
    [1.5, 1.0, 1.0],
    [2.0, 1.0, 1.0],
    [0.8, 0.98, 1.0],
    [0.8, 1.02, 1.0],
    [0.8, 0.95, 1.0],
    [0.8, 1.05, 1.0],
    [0.8, 0.9, 1.0],
    [0.8, 1.1, 1.0],
    [0.8, 0.8, 0.8],
    [0.8, 0.5, 0.5],
];
/// A motor that runs; longer than FAULT needs.
const SECONDS: f64 = 1.6;
/// Negative over positive sequence of the supply.
const UNBALANCE: f64 = 0.007;
/// Of full scale.
const NOISE: f64 = 0.001;

/// A machine, and what its motor file does not know.
struct Machine {
    motor: MotorFile,
    hidden: Vec<EffectEntry>,
    highest: f64,
    /// How much the resistances rise by the warmth of the rated load, share.
    warmth: f64,
}

impl Machine {
    fn draw(random: &mut Pcg64) -> Result<Self, Box<dyn Error>> {
        let name = MOTORS.choose(random).expect("not empty");
        let path = format!("{}/../motors/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let mut motor = MotorFile::read(path)?;
        let p = &mut motor.parameters;
        for value in [&mut p.r_s, &mut p.r_r, &mut p.l_m, &mut p.l_ls, &mut p.l_lr] {
            *value *= random.random_range(0.8..1.25);
        }
        motor.load = match random.random_bool(0.3) {
            true => LoadKind::Measured,
            false => LoadKind::Free,
        };
        motor.mechanics.load_friction = 0.0;
        motor.sensors.noise_sigma_fraction_of_full_scale = NOISE;
        // A recorder's ranges hold what the motor takes at twice its load.
        motor.sensors.current_full_scale_amp = 4.0 * motor.nameplate.current_amplitude();
        motor.effects.clear();
        motor.healthy = None;
        Ok(Machine {
            hidden: hidden(&motor, random),
            highest: *HIGHEST.choose(random).expect("not empty"),
            warmth: random.random_range(0.0..0.15),
            motor,
        })
    }

    /// The machine at a load, share of the rated torque.
    fn recorded(
        &self,
        [load, volt, hertz]: [f64; 3],
        fault: Option<&Broken>,
        seed: u64,
    ) -> Result<Recording, Box<dyn Error>> {
        let mut motor = self.motor.clone();
        motor.parameters.r_s *= 1.0 + self.warmth * (load * load).min(1.6);
        motor.parameters.r_r *= 1.0 + self.warmth * (load * load).min(1.6);
        let torque = load * motor.nameplate.torque_nm;
        let unbalance = Harmonic {
            order: -1.0,
            amplitude: Complex64::from_polar(UNBALANCE, 1.0),
        };
        let supply = SupplySpec {
            components: vec![unbalance],
            amplitude_volt: Piecewise::constant(volt * motor.nameplate.phase_voltage_amplitude()),
            frequency_hz: Piecewise::constant(hertz * motor.nameplate.frequency_hz),
            ..SupplySpec::rated(&motor.nameplate)
        };
        let scenario = Scenario {
            seed,
            supply,
            load: LoadSpec {
                friction_factor: 1.0,
                other: Load::Constant {
                    torque,
                    active: true,
                },
            },
            effects: self.hidden.clone(),
            faults: fault.map(|broken| broken.1.clone()).into_iter().collect(),
            sample_rate_hz: 5000.0,
            start: Start::Running,
            sensors: SensorSpec {
                torque: motor.load == LoadKind::Measured,
                ..SensorSpec::of(&motor)
            },
            ..Scenario::of(motor, SECONDS)
        };
        Ok(record(&scenario, |_| ())?)
    }

    /// `None` where a recording is not possible or the calibration refuses.
    fn calibrated(&self, asked: &Asked, random: &mut Pcg64) -> Option<MotorFile> {
        let shares = if asked.one {
            &CALIBRATED[2..]
        } else {
            &CALIBRATED
        };
        let recorded = |share| {
            let at = [share * self.highest, 1.0, 1.0];
            self.recorded(at, None, random.random()).ok()
        };
        let recordings: Option<Vec<Recording>> = shares.iter().map(recorded).collect();
        let calibrated = calibrate(&self.motor, &recordings?, &Surroundings::default());
        let mut motor = calibrated.ok()?.motor;
        if asked.without {
            motor.healthy.as_mut()?.range = None;
        }
        Some(motor)
    }

    fn names(&self) -> String {
        let names: Vec<&str> = self.hidden.iter().map(|e| e.name.as_str()).collect();
        match names.is_empty() {
            true => "nothing".to_owned(),
            false => names.join(" "),
        }
    }
}

/// Up to two effects, as small or large as they are in motors.
fn hidden(motor: &MotorFile, random: &mut Pcg64) -> Vec<EffectEntry> {
    let plate = &motor.nameplate;
    let volt = plate.phase_voltage_amplitude();
    let mut all = vec![
        EffectEntry::with_numbers(
            "leakage-saturation",
            [
                ("leakage_drop", random.random_range(0.02..0.25)),
                ("reference_current_amp", 3.0 * plate.current_amplitude()),
            ],
        ),
        EffectEntry::with_numbers(
            "magnetizing-saturation",
            [
                ("saturation", random.random_range(0.02..0.25)),
                ("saturation_exponent", 7.0),
            ],
        ),
        EffectEntry::with_numbers(
            "core-loss",
            [(
                "core_loss_resistance_ohm",
                1.5 * volt * volt / (random.random_range(0.003..0.03) * plate.power_watt),
            )],
        ),
        EffectEntry::with_numbers(
            "stray-load-loss",
            [(
                "stray_load_torque_nm",
                random.random_range(0.002..0.02) * plate.torque_nm,
            )],
        ),
        EffectEntry::with_numbers(
            "deep-bar",
            [
                ("resistance_rise", random.random_range(0.05..0.6)),
                ("leakage_drop", random.random_range(0.02..0.2)),
                ("slip_exponent", 1.0),
            ],
        ),
    ];
    all.shuffle(random);
    all.truncate(random.random_range(0..3));
    all
}

/// A fault and its name; from the first sample on.
struct Broken(&'static str, Fault);

fn faults() -> Vec<Broken> {
    let one = |name, target, factor| {
        let change = Change::Factor(factor);
        let (from_s, to_s) = (0.0, f64::INFINITY);
        let fault = Fault {
            target,
            change,
            from_s,
            to_s,
        };
        Broken(name, fault)
    };
    vec![
        one("one current +5 %", Target::Probe(Probe::Current(0)), 1.05),
        one("one voltage +5 %", Target::Probe(Probe::Voltage(0)), 1.05),
        one("speed -2 %", Target::Probe(Probe::Speed), 0.98),
        one(
            "resistance in phase b +50 %",
            Target::Asymmetry(Asymmetry::Series(1)),
            1.5,
        ),
        one("Lm -30 %", Target::Parameter(Parameter::Lm), 0.7),
    ]
}

/// What is asked.
#[derive(Clone, Copy)]
struct Asked {
    one: bool,
    without: bool,
    faults: bool,
    list: bool,
}

/// What was said of a machine under a condition.
struct Judged {
    at: [f64; 3],
    fault: &'static str,
    state: VerdictState,
    first: String,
}

/// A machine, and what was said of it; nothing where its calibration is refused.
type Told = (Machine, Option<Vec<Judged>>);

fn judged(seed: u64, asked: &Asked) -> Result<Told, Box<dyn Error>> {
    let mut random = Pcg64::seed_from_u64(seed);
    let machine = Machine::draw(&mut random)?;
    let Some(calibrated) = machine.calibrated(asked, &mut random) else {
        return Ok((machine, None));
    };
    let broken: Vec<Option<Broken>> = match asked.faults {
        true => faults().into_iter().map(Some).collect(),
        false => vec![None],
    };
    let mut all = Vec::new();
    for at in JUDGED {
        for broken in &broken {
            let [ratio, volt, hertz] = at;
            let real = [ratio * machine.highest, volt, hertz];
            // Beyond the breakdown torque no motor runs.
            let Ok(recording) = machine.recorded(real, broken.as_ref(), random.random()) else {
                continue;
            };
            let audit = audit(&recording, &Expectation::from(&calibrated));
            let monitor = Monitor::new(replay::config_for(&calibrated, &recording)?)?;
            let samples = Samples::new(&recording, &audit);
            let timeline = replay::replay(&monitor, &samples, &mut |_| {});
            let verdict = timeline.verdict(&[]);
            let first = verdict.candidates.first().map(|first| {
                let size = first.size_percent.unwrap_or(f64::NAN);
                format!("{:?} {:?} {size:.1} %", first.fault, first.phase)
            });
            all.push(Judged {
                at,
                fault: broken.as_ref().map_or("healthy", |broken| broken.0),
                state: verdict.state,
                first: first.unwrap_or_default(),
            });
        }
    }
    Ok((machine, Some(all)))
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize, default: u64| {
        let word = words.get(k).and_then(|word| word.parse().ok());
        word.unwrap_or(default)
    };
    let (machines, seed) = (number(0, 60), number(1, 1));
    let has = |word: &str| words.iter().any(|given| given == word);
    let asked = Asked {
        one: has("one"),
        without: has("without"),
        faults: has("faults"),
        list: has("list"),
    };
    let one = |k| judged(1_000_003 * seed + k, &asked).map_err(|error| error.to_string());
    let all: Result<Vec<Told>, String> = (0..machines).into_par_iter().map(one).collect();
    let all = all?;
    let refused = all.iter().filter(|(_, judged)| judged.is_none()).count();
    println!("{machines} machines, {refused} not calibrated\n");
    print(&all, &asked);
    Ok(())
}

fn print(all: &[Told], asked: &Asked) {
    let names: Vec<&str> = match asked.faults {
        true => faults().into_iter().map(|broken| broken.0).collect(),
        false => vec!["healthy"],
    };
    println!(
        "| load, of the largest calibrated | voltage | frequency | FAULT: {} |",
        names.join(" | ")
    );
    println!("|---|---|---|{}", "---|".repeat(names.len()));
    let said = || all.iter().flat_map(|(_, judged)| judged).flatten();
    for at in JUDGED {
        let [ratio, volt, hertz] = at;
        print!("| {ratio} | {volt} | {hertz} |");
        for name in &names {
            let here = || said().filter(|j| j.at == at && j.fault == *name);
            let lit = here().filter(|j| j.state == VerdictState::Fault);
            print!(" {} of {} |", lit.count(), here().count());
        }
        println!();
    }
    let lit = |j: &&Judged| asked.list && j.state == VerdictState::Fault;
    for (machine, judged) in all {
        for j in judged.iter().flatten().filter(lit) {
            println!(
                "{}, {:?}, hidden {}, calibrated to {}: {} at {:?}: {}",
                machine.motor.name,
                machine.motor.load,
                machine.names(),
                machine.highest,
                j.fault,
                j.at,
                j.first
            );
        }
    }
}
