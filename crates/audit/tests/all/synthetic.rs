//! A loaded, then unloaded motor on a grid, as closed forms with noise: healthy, to be spoilt by tests.
#![allow(dead_code)]

use audit::{Audit, Code, Expectation, audit};
use recording::{Channel, Metadata, Recording, Sensors, Supply};
use std::f64::consts::TAU;

/// Samples per second.
pub const RATE_HZ: f64 = 10_000.0;
/// Two seconds; the load goes at the first.
pub const SAMPLES: usize = 20_000;

/// Columns that a test may spoil before they become a recording.
#[derive(Clone)]
pub struct Signals {
    pub t: Vec<f64>,
    pub v: [Vec<f64>; 3],
    pub i: [Vec<f64>; 3],
    pub speed: Vec<f64>,
    pub metadata: Metadata,
}

/// The machine of the signals: 2.2 kW, 400 V, 50 Hz, 4 poles.
pub fn expectation() -> Expectation {
    Expectation {
        pole_pairs: Some(2),
        frequency_hz: Some(50.0),
        voltage_line_rms_volt: Some(400.0),
        current_rms_amp: Some(5.0),
        torque_nm: Some(14.6),
        circuit: None,
    }
}

/// Seeded noise: the sum of twelve uniform numbers less six, standard deviation 1.
pub struct Noise(u64);

impl Noise {
    pub fn new(seed: u64) -> Noise {
        Noise(seed)
    }

    pub fn draw(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    // splitmix64
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    }
}

impl Signals {
    /// Phase voltages of 326.6 V; 6.75 A at 40 degrees and a slip of 4.1 %, from 1 s on 4.24 A at
    /// 87 degrees and no slip: the settled figures of a simulated 2.2 kW motor. Noise 0.2 % of full scale.
    pub fn healthy(seed: u64) -> Signals {
        let mut noise = Noise::new(seed);
        let t: Vec<f64> = (0..SAMPLES).map(|k| k as f64 / RATE_HZ).collect();
        let load = |t: f64| {
            if t < 1.0 {
                (6.75, 40.0, 150.64)
            } else {
                (4.24, 87.0, 157.07)
            }
        };
        let phase = |k: usize| -(k as f64) * TAU / 3.0;
        let v = [0, 1, 2].map(|k| {
            t.iter()
                .map(|t| 326.6 * (TAU * 50.0 * t + phase(k)).cos() + 1.2 * noise.draw())
                .collect()
        });
        let i = [0, 1, 2].map(|k| {
            let current = |t: &f64| {
                let (amplitude, lag, _) = load(*t);
                amplitude * (TAU * 50.0 * t + phase(k) - f64::to_radians(lag)).cos()
                    + 0.12 * noise.draw()
            };
            t.iter().map(current).collect()
        });
        let speed = t.iter().map(|t| load(*t).2 + 0.4 * noise.draw()).collect();
        Signals {
            t,
            v,
            i,
            speed,
            metadata: metadata(),
        }
    }

    /// The recording.
    pub fn recording(self) -> Recording {
        let mut recording =
            Recording::new("synthetic.csv", self.t, self.metadata).expect("a clock");
        for (channel, x) in Channel::VOLTAGES.into_iter().zip(self.v) {
            recording = recording.with_channel(channel, x).expect("a voltage");
        }
        for (channel, x) in Channel::CURRENTS.into_iter().zip(self.i) {
            recording = recording.with_channel(channel, x).expect("a current");
        }
        recording
            .with_channel(Channel::SPEED, self.speed)
            .expect("a speed")
    }
}

fn metadata() -> Metadata {
    Metadata {
        supply: Supply::Grid,
        sensors: Sensors {
            voltage_full_scale_volt: Some(600.0),
            current_full_scale_amp: Some(60.0),
            speed_full_scale_rad_s: Some(200.0),
            noise_sigma_fraction_of_full_scale: Some(0.002),
            ..Sensors::default()
        },
        ..Metadata::default()
    }
}

/// The audit of the healthy signals after something was done to them.
pub fn audited(spoil: impl FnOnce(&mut Signals)) -> Audit {
    let mut signals = Signals::healthy(7);
    spoil(&mut signals);
    audit(&signals.recording(), &expectation())
}

/// Exactly these findings, in this order.
#[track_caller]
pub fn assert_codes(audit: &Audit, expected: &[Code]) {
    let codes: Vec<Code> = audit.findings.iter().map(|finding| finding.code).collect();
    assert_eq!(codes, expected, "{:#?}", audit.findings);
}

/// Exactly one finding, on a channel, of a value within a tolerance, with a word of its remedy.
#[track_caller]
pub fn assert_one(
    audit: &Audit,
    code: Code,
    channel: &str,
    value: f64,
    tolerance: f64,
    remedy: &str,
) {
    assert_codes(audit, &[code]);
    let finding = &audit.findings[0];
    assert_eq!(finding.channel, channel);
    assert!((finding.value - value).abs() <= tolerance, "{finding:?}");
    assert!(finding.detail.contains(remedy), "{}", finding.detail);
    assert_eq!(audit.supported, !finding.refuses);
}

/// Changes every sample of three channels.
pub fn each(x: &mut [Vec<f64>; 3], f: impl Fn(f64) -> f64) {
    x.iter_mut().flatten().for_each(|x| *x = f(*x));
}
