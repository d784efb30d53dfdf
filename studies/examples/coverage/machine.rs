//! A random motor, what is believed of it, and a recording by a random recorder.

use monitor::Cause;
use motor::MotorFile;
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use recording::{Channel, Recording};
use scenario::Scenario;
use scenario::simulate::record;

/// Standard deviations with which beliefs are wrong: resistances and inductances, inertia (logarithms).
const WRONG: [f64; 2] = [0.1, 0.2];
/// Standard deviation of a channel's gain, of the torque's, and of the speed's.
const GAINS: [f64; 3] = [0.003, 0.005, 1e-4];

/// A machine with its recording.
pub struct Case {
    pub truth: MotorFile,
    pub believed: MotorFile,
    pub recording: Recording,
    pub words: String,
}

/// Ratings of a random motor.
struct Ratings {
    power: f64,
    voltage_line: f64,
    frequency: f64,
    pole_pairs: u32,
    current: f64,
    torque: f64,
}

/// Parameters in the order of the motor file.
type Parameters = [f64; 6];

/// What a case is asked about.
#[derive(Clone, Copy, Debug)]
pub enum Question {
    /// Random beliefs, any operation.
    Any,
    /// The same, but no recording is longer than a minute.
    Short,
    /// The same, but every recording lasts ten minutes.
    Long,
    /// The motor is as believed and carries a constant load.
    Healthy,
    /// One parameter, by its place, is so many times what is believed, in an operation that shows it.
    Changed(usize, f64),
}

impl Case {
    /// The machine of a seed.
    pub fn new(seed: u64, question: Question) -> Self {
        let mut rng = Pcg64::seed_from_u64(seed);
        let ratings = Ratings::random(&mut rng);
        let mut truth = ratings.parameters(&mut rng);
        let mut believed = ratings.beliefs(&truth, &mut rng);
        let instrument = instrument(&ratings, &mut rng);
        let mut operation = Operation::random(&mut rng);
        match question {
            Question::Any => {}
            Question::Short => operation = operation.no_longer_than_a_minute(),
            Question::Long => operation = operation.of_ten_minutes(),
            Question::Healthy => {
                believed = truth;
                operation = operation.constant();
            }
            Question::Changed(which, factor) => {
                believed = truth;
                truth[which] *= factor;
                // A constant speed shows no inertia.
                operation = match which == INERTIA {
                    true => operation.steps(),
                    false => operation.constant(),
                };
            }
        }
        let [truth, believed] = [truth, believed].map(|p| ratings.motor_file(&p, &instrument));
        let scenario = scenario_of(&operation.scenario(&ratings, seed), &truth, seed);
        let recorded = record(&scenario, |_| {}).expect("a recording");
        let motor = |text: &str| MotorFile::parse(text, "random.toml").expect("a motor");
        Case {
            words: format!(
                "{:.1} kW {} pole pairs, {}",
                ratings.power / 1e3,
                ratings.pole_pairs,
                operation.words()
            ),
            recording: with_gains(&recorded, &mut rng),
            truth: motor(&truth),
            believed: motor(&believed),
        }
    }

    /// True value of a nominal parameter, in the unit of the motor file.
    pub fn truth_of(&self, name: &str) -> f64 {
        value_of(&self.truth, name)
    }

    /// Believed value of a nominal parameter.
    pub fn believed_of(&self, name: &str) -> f64 {
        value_of(&self.believed, name)
    }
}

impl Ratings {
    fn random(rng: &mut Pcg64) -> Self {
        let power: f64 = 300.0 * (150f64).powf(rng.random_range(0.0..1.0));
        let pole_pairs = [1, 2, 2, 3][rng.random_range(0..4)];
        let (voltage_line, frequency) =
            [(400.0, 50.0), (230.0, 50.0), (460.0, 60.0), (220.0, 60.0)][rng.random_range(0..4)];
        let efficiency = 0.72 + 0.055 * (power / 300.0).log10();
        let power_factor = 0.70 + 0.07 * (power / 300.0).log10();
        let slip = 0.06 - 0.02 * (power / 300.0).log10();
        let speed = std::f64::consts::TAU * frequency / f64::from(pole_pairs) * (1.0 - slip);
        Ratings {
            power,
            voltage_line,
            frequency,
            pole_pairs,
            current: power / efficiency / power_factor / voltage_line / 3f64.sqrt(),
            torque: power / speed,
        }
    }

    /// A motor of usual per-unit parameters, small ones with larger resistances.
    fn parameters(&self, rng: &mut Pcg64) -> Parameters {
        let base = self.voltage_line / 3f64.sqrt() / self.current;
        let henry = base / (std::f64::consts::TAU * self.frequency);
        let small = (self.power / 300.0).powf(-0.25);
        let leakage = rng.random_range(0.06..0.12) * henry;
        let synchronous = std::f64::consts::TAU * self.frequency / f64::from(self.pole_pairs);
        let energy = self.power * rng.random_range(0.05..0.3);
        [
            rng.random_range(0.05..0.10) * small * base,
            rng.random_range(0.05..0.09) * small * base,
            leakage,
            rng.random_range(1.4..2.6) * henry,
            2.0 * energy / synchronous.powi(2),
            rng.random_range(0.005..0.03) * self.torque / synchronous,
        ]
    }

    /// The parameters as somebody believes them.
    fn beliefs(&self, truth: &Parameters, rng: &mut Pcg64) -> Parameters {
        let mut off = |sd: f64| {
            let normal: f64 = StandardNormal.sample(rng);
            (sd * normal).exp()
        };
        let mut believed = *truth;
        for (k, p) in believed.iter_mut().enumerate().take(5) {
            *p *= off(WRONG[usize::from(k == 4)]);
        }
        let synchronous = std::f64::consts::TAU * self.frequency / f64::from(self.pole_pairs);
        believed[5] = rng.random_range(0.005..0.03) * self.torque / synchronous;
        believed
    }

    fn motor_file(&self, p: &Parameters, instrument: &str) -> String {
        let [r_s, r_r, l, l_m, inertia, friction] = p;
        let Ratings {
            power,
            voltage_line,
            frequency,
            pole_pairs,
            current,
            torque,
        } = self;
        format!(
            "name = \"random\"\n[nameplate]\npole_pairs = {pole_pairs}\npower_watt = {power}\n\
             voltage_line_rms_volt = {voltage_line:?}\ncurrent_rms_amp = {current}\nfrequency_hz = {frequency:?}\n\
             torque_nm = {torque}\nconnection = \"star\"\n[parameters]\nstator_resistance_ohm = {r_s}\n\
             rotor_resistance_ohm = {r_r}\nstator_leakage_henry = {l}\nrotor_leakage_henry = {l}\n\
             magnetizing_inductance_henry = {l_m}\ninertia_kg_m2 = {inertia}\nfriction_nm_s = {friction}\n\
             load_friction_nm_s = 0.0\n[load]\nkind = \"measured\"\n[sensors]\n{instrument}"
        )
    }
}

/// Ranges, noise and resolution of a random recorder.
fn instrument(ratings: &Ratings, rng: &mut Pcg64) -> String {
    let range = |rated: f64, factor: f64| rated * factor;
    let noise = 5e-4 * 10f64.powf(rng.random_range(0.0..1.0));
    let speed = std::f64::consts::TAU * ratings.frequency / f64::from(ratings.pole_pairs);
    format!(
        "voltage_full_scale_volt = {}\ncurrent_full_scale_amp = {}\nspeed_full_scale_rad_s = {}\ntorque_full_scale_nm = {}\n\
         noise_sigma_fraction_of_full_scale = {noise}\nadc_bits = {}\n",
        range(ratings.voltage_line, rng.random_range(1.0..1.6)),
        range(ratings.current, rng.random_range(11.0..16.0)),
        range(speed, rng.random_range(1.2..2.0)),
        range(ratings.torque, rng.random_range(3.0..6.0)),
        [12, 14, 16][rng.random_range(0..3)],
    )
}

/// Place of the inertia among the parameters.
const INERTIA: usize = 4;

/// What the motor does.
struct Operation {
    kind: &'static str,
    duration: f64,
    rate: f64,
    loads: Vec<f64>,
}

impl Operation {
    fn random(rng: &mut Pcg64) -> Self {
        let kind = ["constant", "steps", "start"][rng.random_range(0..3)];
        // Long recordings are slower ones.
        let (duration, rate) = [
            (2.0, 10e3),
            (4.0, 10e3),
            (8.0, 5e3),
            (20.0, 5e3),
            (60.0, 2e3),
            (600.0, 1e3),
        ][[0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 4, 5][rng.random_range(0..12)]];
        let loads = match kind {
            "constant" => vec![rng.random_range(0.1..1.1)],
            "steps" => (0..6).map(|_| rng.random_range(0.0..1.2)).collect(),
            _ => vec![0.0, rng.random_range(0.2..1.1), rng.random_range(0.0..1.1)],
        };
        Operation {
            kind,
            duration,
            rate,
            loads,
        }
    }

    /// At its first load all the time, a minute at most.
    fn constant(mut self) -> Self {
        self.loads.truncate(1);
        if self.kind == "start" {
            self.loads = vec![0.8];
        }
        self.kind = "constant";
        self.no_longer_than_a_minute()
    }

    /// From load to load.
    fn steps(mut self) -> Self {
        self.kind = "steps";
        self.loads = vec![0.2, 1.0, 0.5, 0.9, 0.1, 0.7];
        self.no_longer_than_a_minute()
    }

    fn no_longer_than_a_minute(mut self) -> Self {
        if self.duration > 60.0 {
            (self.duration, self.rate) = (60.0, 2e3);
        }
        self
    }

    /// Ten minutes, at a rate of the short ones: a tenth of it where that would be 10 kHz.
    fn of_ten_minutes(mut self) -> Self {
        self.rate = if self.rate > 5e3 { 1e3 } else { self.rate };
        self.duration = 600.0;
        self
    }

    fn words(&self) -> String {
        format!("{} {} s at {} Hz", self.kind, self.duration, self.rate)
    }

    fn scenario(&self, ratings: &Ratings, seed: u64) -> String {
        let start = if self.kind == "start" {
            "standstill"
        } else {
            "running"
        };
        let parts = self.loads.len() as f64;
        let point = |(k, load): (usize, &f64)| {
            format!(
                "{{ at_s = {}, torque_nm = {} }}",
                k as f64 * self.duration / parts,
                load * ratings.torque
            )
        };
        let profile: Vec<String> = self.loads.iter().enumerate().map(point).collect();
        format!(
            "motor = \"motor.toml\"\nduration_s = {:?}\nstart = \"{start}\"\nsample_rate_hz = {:?}\nseed = {seed}\n\
             [load]\nfriction_percent = 0\nactive = true\nprofile = [{}]\n[sensors]\ntorque = true\n",
            self.duration,
            self.rate,
            profile.join(", ")
        )
    }
}

/// The scenario of a text, with its motor file beside it.
fn scenario_of(text: &str, motor: &str, seed: u64) -> Scenario {
    let folder = std::env::temp_dir().join(format!("coverage-{}-{seed}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    std::fs::write(folder.join("motor.toml"), motor).expect("a motor file");
    let scenario = Scenario::parse(text, "random scenario", &folder).expect("a scenario");
    std::fs::remove_dir_all(&folder).expect("the temporary folder");
    scenario
}

/// The recording with every channel off by its class.
fn with_gains(recording: &Recording, rng: &mut Pcg64) -> Recording {
    let empty = Recording::new(
        recording.name(),
        recording.t().to_vec(),
        recording.metadata.clone(),
    );
    recording
        .channels()
        .fold(empty.expect("a clock"), |rec, (channel, x)| {
            let sd = match channel {
                Channel::SPEED => GAINS[2],
                Channel::TORQUE => GAINS[1],
                _ => GAINS[0],
            };
            let normal: f64 = StandardNormal.sample(rng);
            let gain = 1.0 + sd * normal;
            rec.with_channel(channel, x.iter().map(|x| gain * x).collect())
                .expect("a channel")
        })
}

fn value_of(motor: &MotorFile, name: &str) -> f64 {
    let (p, m) = (&motor.parameters, &motor.mechanics);
    match name {
        "stator_resistance_ohm" => p.r_s,
        "rotor_resistance_ohm" => p.r_r,
        "stator_leakage_henry" => p.l_ls,
        "magnetizing_inductance_henry" => p.l_m,
        "inertia_kg_m2" => m.inertia,
        _ => m.friction + m.load_friction,
    }
}

/// Name in the motor file of what `calibrate` fits.
pub fn name_of(cause: Cause) -> &'static str {
    match cause {
        Cause::StatorResistance => "stator_resistance_ohm",
        Cause::RotorResistance => "rotor_resistance_ohm",
        Cause::MagnetizingInductance => "magnetizing_inductance_henry",
        Cause::Leakage => "stator_leakage_henry",
        _ => "friction_nm_s",
    }
}
