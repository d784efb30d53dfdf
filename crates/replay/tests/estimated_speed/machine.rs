//! Random machines, what is believed of them, and recordings with slot harmonics that no part of the estimator made.

use std::f64::consts::TAU;

use motor::MotorFile;
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use recording::{Channel, Metadata, Recording};
use scenario::Scenario;
use scenario::simulate::record;

/// What a case shall have.
#[derive(Clone, Copy, Debug)]
pub struct Wish {
    /// Amplitude of the strongest slot harmonic over the fundamental current; 0: none, and no eccentricity.
    pub lines: f64,
    /// Whether the number of bars stands on the plate.
    pub bars_known: bool,
    /// Lines of a foreign origin in the currents: interharmonics at random places.
    pub foreign: usize,
}

/// A recording without a speed, what is believed, and the truth.
pub struct Case {
    pub recording: Recording,
    pub believed: MotorFile,
    pub slip: Vec<f64>,
    pub bars: u32,
    pub words: String,
}

impl Case {
    pub fn mean_slip(&self) -> f64 {
        self.slip.iter().sum::<f64>() / self.slip.len() as f64
    }

    pub fn new(seed: u64, wish: Wish) -> Case {
        let mut rng = Pcg64::seed_from_u64(seed);
        let machine = Machine::random(&mut rng);
        let recorder = Recorder::random(&mut rng);
        let load = load(&mut rng, recorder.duration);
        let truth = machine.motor(1.0);
        let text = format!(
            "motor = \"m.toml\"\nstart = \"running\"\nduration_s = {}\nsample_rate_hz = {}\nseed = {seed}\n[supply]\n\
             frequency_hz = {}\nunbalance_percent = {:.2}\n[[supply.harmonics]]\norder = -5\npercent = {:.2}\n\
             [[supply.harmonics]]\norder = 7\npercent = {:.2}\n[load]\nfriction_percent = 0\nactive = true\n{load}\n\
             [sensors]\nquantise = false\nnoise_sigma_fraction_of_full_scale = 0\ntorque = false\n",
            recorder.duration,
            recorder.rate,
            machine.frequency * rng.random_range(0.996..1.004),
            rng.random_range(0.0..1.5),
            rng.random_range(0.0..3.0),
            rng.random_range(0.0..2.0),
        );
        let folder =
            std::env::temp_dir().join(format!("estimated-speed-{}-{seed}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("m.toml"), &truth).unwrap();
        let scenario = Scenario::parse(&text, "s.toml", &folder).unwrap();
        let clean = record(&scenario, |_| {}).unwrap();
        std::fs::remove_dir_all(&folder).unwrap();
        let wrong: f64 = StandardNormal.sample(&mut rng);
        let kelvin: f64 = StandardNormal.sample(&mut rng);
        let wrong = (DEVIATION * wrong).exp() * (1.0 + 0.0039 * KELVIN * kelvin);
        let believed =
            MotorFile::parse(&machine.believed(wrong, wish.bars_known), "believed").unwrap();
        let plant = Plant::random(&mut rng, &machine, wish);
        let words = format!(
            "{:.1} kW p {} R {} {} Hz {} s {} noise {:.2} % {}",
            machine.power / 1e3,
            machine.pole_pairs,
            machine.bars,
            recorder.rate,
            recorder.duration,
            load.lines().next().unwrap_or(""),
            100.0 * recorder.noise,
            plant.words()
        );
        let (recording, slip) = plant.recorded(&clean, &machine, &recorder, &mut rng);
        Case {
            recording,
            believed,
            slip,
            bars: machine.bars,
            words,
        }
    }
}

/// Standard deviation of the logarithm of what is believed of the rotor resistance.
const DEVIATION: f64 = 0.1;

/// Standard deviation of the cage's temperature around that of the motor file, K.
const KELVIN: f64 = 23.0;

struct Machine {
    power: f64,
    frequency: f64,
    pole_pairs: u32,
    bars: u32,
    current: f64,
    text: String,
    r_r: f64,
}

impl Machine {
    fn random(rng: &mut Pcg64) -> Machine {
        let power: f64 = 300.0 * 150f64.powf(rng.random_range(0.0..1.0));
        let pole_pairs = [1, 2, 2, 3][rng.random_range(0..4)];
        let (voltage, frequency) =
            [(400.0, 50.0), (230.0, 50.0), (460.0, 60.0)][rng.random_range(0..3)];
        // Rotors of catalogues and textbooks for 24, 36 and 48 stator slots.
        let bars: u32 = match pole_pairs {
            1 => [16, 18, 20, 22, 28, 30][rng.random_range(0..6)],
            2 => [22, 26, 28, 30, 32, 34, 40, 44][rng.random_range(0..8)],
            _ => [26, 33, 34, 42, 44, 46, 48, 51][rng.random_range(0..8)],
        };
        let small = (power / 300.0).powf(-0.25);
        let efficiency = 0.72 + 0.055 * (power / 300.0).log10();
        let factor = 0.70 + 0.07 * (power / 300.0).log10();
        let current = power / efficiency / factor / voltage / 3f64.sqrt();
        let base = voltage / 3f64.sqrt() / current;
        let henry = base / (TAU * frequency);
        let synchronous = TAU * frequency / f64::from(pole_pairs);
        let leakage = rng.random_range(0.06..0.12) * henry;
        let r_r = rng.random_range(0.05..0.09) * small * base;
        let torque = power / (0.95 * synchronous);
        let text = format!(
            "name = \"random\"\n[nameplate]\npole_pairs = {pole_pairs}\npower_watt = {power}\nvoltage_line_rms_volt = {voltage:?}\n\
             current_rms_amp = {current}\nfrequency_hz = {frequency:?}\ntorque_nm = {torque}\nconnection = \"star\"\nBARS\n\
             [parameters]\nstator_resistance_ohm = {}\nrotor_resistance_ohm = RR\nstator_leakage_henry = {leakage}\n\
             rotor_leakage_henry = {leakage}\nmagnetizing_inductance_henry = {}\ninertia_kg_m2 = {}\nfriction_nm_s = 0.0\n\
             load_friction_nm_s = 0.0\n[load]\nkind = \"free\"\n[sensors]\nvoltage_full_scale_volt = {}\n\
             current_full_scale_amp = {}\nspeed_full_scale_rad_s = {}\ntorque_full_scale_nm = {}\n\
             noise_sigma_fraction_of_full_scale = 0.001\nadc_bits = 12\n",
            rng.random_range(0.05..0.10) * small * base,
            rng.random_range(1.4..2.6) * henry,
            2.0 * power * rng.random_range(0.05..0.3) / synchronous.powi(2),
            1.3 * voltage,
            6.0 * current,
            1.5 * synchronous,
            4.0 * torque,
        );
        Machine {
            power,
            frequency,
            pole_pairs,
            bars,
            current: current * 2f64.sqrt(),
            text,
            r_r,
        }
    }

    fn motor(&self, factor: f64) -> String {
        self.text
            .replace("BARS", "")
            .replace("RR", &format!("{:?}", self.r_r * factor))
    }

    fn believed(&self, wrong: f64, bars_known: bool) -> String {
        let bars = match bars_known {
            true => format!("rotor_bars = {}", self.bars),
            false => String::new(),
        };
        let r_r = self.r_r * wrong;
        let wide = (1.96 * DEVIATION).exp();
        let text = self
            .text
            .replace("BARS", &bars)
            .replace("RR", &format!("{r_r:?}"));
        format!(
            "{text}[uncertainty]\nrotor_resistance_ohm = [{:?}, {:?}]\n",
            r_r / wide,
            r_r * wide
        )
    }
}

struct Recorder {
    rate: f64,
    duration: f64,
    noise: f64,
}

impl Recorder {
    fn random(rng: &mut Pcg64) -> Recorder {
        let rate = [1e3, 2e3, 5e3, 10e3, 20e3][rng.random_range(0..5)];
        Recorder {
            rate,
            duration: [2.0, 4.0, 6.0, 10.0][rng.random_range(0..4)],
            noise: 1e-3 * 10f64.powf(rng.random_range(0.0..1.0)),
        }
    }
}

/// Constant, in steps, ramping or swinging.
fn load(rng: &mut Pcg64, duration: f64) -> String {
    let first = rng.random_range(5.0..110.0);
    let second = rng.random_range(5.0..110.0);
    let at = rng.random_range(0.3..0.7) * duration;
    match rng.random_range(0..4) {
        0 | 1 => format!("constant_percent = {first:.1}"),
        2 => format!(
            "profile = [{{at_s = 0, torque_percent = {first:.1}}}, {{at_s = {at:.2}, torque_percent = {second:.1}}}]"
        ),
        _ => {
            let points: Vec<String> = (0..(20.0 * duration) as usize)
                .map(|k| {
                    let t = 0.05 * k as f64;
                    let swing = 0.05 * first * (TAU * 1.7 * t).sin();
                    format!("{{at_s = {t:.2}, torque_percent = {:.2}}}", first + swing)
                })
                .collect();
            format!(
                "interpolation = \"linear\"\nprofile = [{}]",
                points.join(", ")
            )
        }
    }
}

/// One line: amplitude over the fundamental, multiple of the shaft's angle and of the supply's, way it turns, phase.
struct Line {
    amplitude: f64,
    shaft: f64,
    supply: f64,
    turns: f64,
    phase: f64,
}

/// Slots and eccentricity as the windings see them.
struct Plant {
    lines: Vec<Line>,
    /// Interharmonics: amplitude and frequency.
    foreign: Vec<[f64; 3]>,
}

impl Plant {
    fn random(rng: &mut Pcg64, machine: &Machine, wish: Wish) -> Plant {
        let mut lines = Vec::new();
        let bars = f64::from(machine.bars);
        for v in [1i32, -1, 3, -3, 5, -5, 7, -7] {
            let share = match v.abs() {
                1 => rng.random_range(0.3..1.0),
                _ if rng.random_range(0.0..1.0) < 0.5 => rng.random_range(0.1..0.7),
                _ => continue,
            };
            // The winding links fields of pole pairs p (6 k + 1) forwards, p (6 k - 1) backwards and others hardly at all.
            let field = (machine.bars as i32 + v * machine.pole_pairs as i32) as f64
                / f64::from(machine.pole_pairs);
            let (turns, linked) = match field.fract() == 0.0 {
                true => match (field as i32).rem_euclid(3) {
                    1 => (1.0, 1.0),
                    2 => (-1.0, 1.0),
                    _ => (1.0, 0.1),
                },
                // Linked by eccentricity alone.
                false => ([1.0, -1.0][rng.random_range(0..2)], 0.6),
            };
            lines.push(Line {
                amplitude: wish.lines * share * linked,
                shaft: turns * bars,
                supply: turns * f64::from(v),
                turns,
                phase: rng.random_range(0.0..TAU),
            });
        }
        // The strongest has the amplitude that was asked for.
        let strongest = lines.iter().map(|line| line.amplitude).fold(0.0, f64::max);
        lines
            .iter_mut()
            .for_each(|line| line.amplitude *= wish.lines / strongest.max(1e-300));
        for side in [1.0, -1.0] {
            lines.push(Line {
                amplitude: if wish.lines > 0.0 {
                    5e-3 * 10f64.powf(rng.random_range(-2.0..0.0))
                } else {
                    0.0
                },
                shaft: side,
                supply: 1.0,
                turns: 1.0,
                phase: rng.random_range(0.0..TAU),
            });
        }
        let foreign = (0..wish.foreign)
            .map(|_| {
                [
                    10f64.powf(rng.random_range(-3.3..-2.0)),
                    rng.random_range(60.0..1500.0),
                    rng.random_range(0.0..TAU),
                ]
            })
            .collect();
        Plant { lines, foreign }
    }

    fn words(&self) -> String {
        let strong = self
            .lines
            .iter()
            .filter(|line| line.shaft.abs() > 1.5 && line.amplitude > 0.0);
        strong
            .map(|line| {
                format!(
                    "{:+.0}:{:.2}%",
                    line.supply * line.turns,
                    100.0 * line.amplitude
                )
            })
            .collect::<Vec<_>>()
            .join(" ")
    }

    /// The recording with the lines, noise and twelve bits, without the speed; and the true slip at each sample.
    fn recorded(
        &self,
        clean: &Recording,
        machine: &Machine,
        recorder: &Recorder,
        rng: &mut Pcg64,
    ) -> (Recording, Vec<f64>) {
        let speed = clean.speed().unwrap();
        let (step, pairs) = (clean.t_sample(), f64::from(machine.pole_pairs));
        let [va, vb, vc] = clean.voltages().unwrap();
        let supply: Vec<f64> = unwrapped((0..va.len()).map(|k| {
            let (alpha, beta) = (
                (2.0 * va[k] - vb[k] - vc[k]) / 3.0,
                (vb[k] - vc[k]) / 3f64.sqrt(),
            );
            beta.atan2(alpha)
        }));
        // The supply's frequency by its whole turn: harmonics and unbalance average out over the recording.
        let omega = slope(&supply) / step;
        let mut shaft = 0.0;
        let mut recorded =
            Recording::new("recorded", clean.t().to_vec(), Metadata::default()).unwrap();
        let mut added = [Vec::new(), Vec::new(), Vec::new()];
        let fundamental = {
            let i = clean.currents().unwrap()[0];
            2f64.sqrt() * (i.iter().map(|x| x * x).sum::<f64>() / i.len() as f64).sqrt()
        };
        for (k, w) in speed.iter().enumerate() {
            let (mut alpha, mut beta) = (0.0, 0.0);
            let time = k as f64 * step;
            for line in &self.lines {
                let angle = line.shaft * shaft + line.supply * omega * time + line.phase;
                alpha += line.amplitude * fundamental * angle.cos();
                beta += line.amplitude * fundamental * angle.sin();
            }
            for [amplitude, hz, phase] in &self.foreign {
                alpha += amplitude * fundamental * (TAU * hz * time + phase).cos();
            }
            shaft += w * step;
            let axes = [
                alpha,
                -alpha / 2.0 + 3f64.sqrt() / 2.0 * beta,
                -alpha / 2.0 - 3f64.sqrt() / 2.0 * beta,
            ];
            added
                .iter_mut()
                .zip(axes)
                .for_each(|(phase, x)| phase.push(x));
        }
        let mut read = |x: f64, full_scale: f64, noise: f64| {
            let normal: f64 = StandardNormal.sample(rng);
            let lsb = full_scale / 2048.0;
            ((x + noise * normal) / lsb).round() * lsb
        };
        let rated_volts = clean.voltages().unwrap()[0]
            .iter()
            .fold(0.0, |a: f64, b| a.max(b.abs()));
        for (channel, x) in Channel::VOLTAGES.into_iter().zip(clean.voltages().unwrap()) {
            let values = x
                .iter()
                .map(|x| read(*x, 1.3 * rated_volts, recorder.noise * rated_volts))
                .collect();
            recorded = recorded.with_channel(channel, values).unwrap();
        }
        for ((channel, x), lines) in Channel::CURRENTS
            .into_iter()
            .zip(clean.currents().unwrap())
            .zip(&added)
        {
            let values = x
                .iter()
                .zip(lines)
                .map(|(x, line)| {
                    read(
                        x + line,
                        6.0 * machine.current,
                        recorder.noise * machine.current,
                    )
                })
                .collect();
            recorded = recorded.with_channel(channel, values).unwrap();
        }
        let slip = speed
            .iter()
            .map(|w| 1.0 - pairs * w / omega.abs())
            .collect();
        (recorded, slip)
    }
}

fn unwrapped(angles: impl Iterator<Item = f64>) -> Vec<f64> {
    let (mut last, mut total) = (None, 0.0);
    angles
        .map(|angle| {
            if let Some(before) = last {
                let change: f64 = angle - before;
                total += change - TAU * (change / TAU).round();
            }
            last = Some(angle);
            total
        })
        .collect()
}

/// Least squares, per step.
fn slope(x: &[f64]) -> f64 {
    let n = x.len() as f64;
    let middle = (n - 1.0) / 2.0;
    let mean = x.iter().sum::<f64>() / n;
    let sum: f64 = x
        .iter()
        .enumerate()
        .map(|(k, x)| (k as f64 - middle) * (x - mean))
        .sum();
    sum / (n * (n * n - 1.0) / 12.0)
}
