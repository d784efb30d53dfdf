//! Clipping against waveforms of every kind: none is called clipped that is not, and what is cut off is found.
//!
//! `FULL=1 cargo test -p audit --release --test all clipping -- --nocapture` runs ten times as many and prints the figures.

use crate::synthetic::{Noise, assert_codes, audited};
use audit::{Code, Expectation, audit};
use recording::{Channel, Metadata, Recording, Sensors};
use std::f64::consts::TAU;

/// What an instrument makes of a waveform of amplitude about 1.
#[derive(Clone, Copy, Debug)]
struct Instrument {
    rate_hz: f64,
    /// Step of the converter; 0: none.
    step: f64,
    /// Noise ahead of the range's end and behind it.
    noise: [f64; 2],
    /// Level of either end of the range.
    range: [f64; 2],
    declared: bool,
}

/// Sums of harmonics: order, size, phase; then the mean.
#[derive(Clone, Debug)]
struct Wave {
    hz: f64,
    parts: Vec<(f64, f64, f64)>,
    mean: f64,
    swing: f64,
}

impl Wave {
    fn at(&self, t: f64, phase: f64) -> f64 {
        let size = 1.0 + self.swing * (TAU * 1.3 * t).sin();
        let part = |(order, share, angle): &(f64, f64, f64)| {
            share * (order * (TAU * self.hz * t + phase) + angle).cos()
        };
        self.mean + size * self.parts.iter().map(part).sum::<f64>()
    }

    fn random(noise: &mut Noise) -> Wave {
        let most = pick(noise, &[0.0, 0.02, 0.05, 0.1]);
        let first = TAU * noise.uniform();
        let mut parts = vec![(1.0, 1.0, first)];
        for order in [2.0, 3.0, 4.0, 5.0, 7.0, 11.0, 13.0] {
            if noise.uniform() < 0.6 {
                let share = most * noise.uniform() * if order > 7.0 { 0.3 } else { 1.0 };
                // Half of them stand so that they flatten or sharpen the peak.
                let at_peak = order * first
                    + if noise.uniform() < 0.5 {
                        0.0
                    } else {
                        TAU / 2.0
                    };
                let angle = if noise.uniform() < 0.5 {
                    TAU * noise.uniform()
                } else {
                    at_peak
                };
                parts.push((order, share, angle));
            }
        }
        let drift = if noise.uniform() < 0.5 {
            0.0
        } else {
            1e-3 * (noise.uniform() - 0.5)
        };
        Wave {
            hz: pick(noise, &[50.0, 60.0, 50.0, 49.98, 50.01, 25.0, 16.7]) * (1.0 + drift),
            parts,
            mean: pick(noise, &[0.0, 0.01, 0.05, 0.1]) * (noise.uniform() - 0.5),
            swing: if noise.uniform() < 0.3 {
                0.2 * noise.uniform()
            } else {
                0.0
            },
        }
    }
}

fn pick(noise: &mut Noise, from: &[f64]) -> f64 {
    from[(noise.uniform() * from.len() as f64) as usize % from.len()]
}

/// Three currents of the waveform, as the instrument shows them for some time.
fn recording(wave: &Wave, instrument: &Instrument, seconds: f64, noise: &mut Noise) -> Recording {
    let n = (seconds * instrument.rate_hz) as usize;
    let t: Vec<f64> = (0..n).map(|k| k as f64 / instrument.rate_hz).collect();
    let scale = 7.3;
    let mut metadata = Metadata::default();
    if instrument.declared {
        metadata.sensors = Sensors {
            current_full_scale_amp: Some(20.0 * scale),
            noise_sigma_fraction_of_full_scale: Some(
                (instrument.noise[0] + instrument.noise[1]) / 20.0,
            ),
            ..Sensors::default()
        };
    }
    let mut recording = Recording::new("wave.csv", t.clone(), metadata).expect("a clock");
    for (k, channel) in Channel::CURRENTS.into_iter().enumerate() {
        let phase = -(k as f64) * TAU / 3.0;
        let shown = |t: &f64| {
            let ahead = wave.at(*t, phase) + instrument.noise[0] * noise.draw();
            let [low, high] = instrument.range;
            let behind = ahead.clamp(low, high) + instrument.noise[1] * noise.draw();
            let code = |x: f64| instrument.step * (x / instrument.step).round();
            scale
                * if instrument.step > 0.0 {
                    code(behind)
                } else {
                    behind
                }
        };
        let values = t.iter().map(shown).collect();
        recording = recording.with_channel(channel, values).expect("a current");
    }
    recording
}

/// Channels that the audit calls clipped.
fn clipped(recording: &Recording) -> usize {
    let audit = audit(recording, &Expectation::default());
    let clipping = audit
        .findings
        .iter()
        .filter(|finding| finding.code == Code::Clipping);
    clipping.count()
}

fn repetitions() -> usize {
    if std::env::var_os("FULL").is_some() {
        10
    } else {
        1
    }
}

#[test]
fn no_waveform_of_a_motor_is_called_clipped() {
    let mut noise = Noise::new(17);
    let cases = 400 * repetitions();
    for case in 0..cases {
        let wave = Wave::random(&mut noise);
        let bits = 8.0 + (9.0 * noise.uniform()).floor();
        let full_scale = 1.2 + 8.8 * noise.uniform() * noise.uniform();
        let exact = noise.uniform() < 0.2;
        let round_rate = noise.uniform() < 0.5;
        let instrument = Instrument {
            rate_hz: if round_rate {
                pick(&mut noise, &[1e3, 2e3, 5e3, 1e4, 2e4, 5e4])
            } else {
                10f64.powf(3.0 + 1.7 * noise.uniform())
            },
            step: if exact {
                0.0
            } else {
                2.0 * full_scale / 2f64.powf(bits)
            },
            noise: [
                pick(&mut noise, &[0.0, 0.0, 0.0005, 0.002, 0.01, 0.02]),
                0.0,
            ],
            range: [f64::NEG_INFINITY, f64::INFINITY],
            declared: noise.uniform() < 0.5,
        };
        let seconds = (15_000.0 / instrument.rate_hz).min(0.3 + 0.7 * noise.uniform());
        let found = clipped(&recording(&wave, &instrument, seconds, &mut noise));
        assert_eq!(found, 0, "case {case}: {wave:?} {instrument:?}");
    }
    println!("{cases} waveforms of three phases, none called clipped");
}

/// The two idle currents that were called clipped far below their declared full scale.
#[test]
fn an_idle_current_with_harmonics_is_not_clipped() {
    let first = [(5.0, 0.05), (3.0, 0.034), (7.0, 0.024)];
    let second = [(2.0, 0.01), (5.0, 0.04), (7.0, 0.03)];
    for orders in [first, second] {
        for turn in 0..8 {
            for mean in [0.0, 0.03] {
                for sharpening in [0.0, 0.5, 1.0] {
                    let angle = TAU * f64::from(turn) / 8.0;
                    let part = |(order, share): &(f64, f64)| {
                        (*order, *share, order * angle + sharpening * TAU / 2.0)
                    };
                    let mut parts: Vec<(f64, f64, f64)> = orders.iter().map(part).collect();
                    parts.push((1.0, 1.0, angle));
                    let wave = Wave {
                        hz: 50.0,
                        parts,
                        mean,
                        swing: 0.0,
                    };
                    let instrument = Instrument {
                        rate_hz: 10_000.0,
                        step: 0.005,
                        noise: [0.002, 0.0],
                        range: [f64::NEG_INFINITY, f64::INFINITY],
                        declared: true,
                    };
                    let recording = recording(&wave, &instrument, 1.0, &mut Noise::new(3));
                    assert_eq!(clipped(&recording), 0, "{wave:?}");
                }
            }
        }
    }
}

/// Fifth and seventh harmonic that cancel the second and the fourth derivative of the peak: as flat as such a current gets.
#[test]
fn the_flattest_peak_that_two_harmonics_can_make_is_not_clipped() {
    let (fifth, seventh) = (-0.08, 0.020_41);
    for hz in [50.0, 49.99, 50.013, 60.0] {
        for rate_hz in [1e3, 2e3, 5e3, 1e4, 2e4, 5e4] {
            for step in [0.0, 2e-4, 1e-3, 5e-3] {
                for sigma in [0.0, 0.001] {
                    let wave = Wave {
                        hz,
                        parts: vec![(1.0, 1.0, 0.3), (5.0, fifth, 1.5), (7.0, seventh, 2.1)],
                        mean: 0.0,
                        swing: 0.0,
                    };
                    let instrument = Instrument {
                        rate_hz,
                        step,
                        noise: [sigma, 0.0],
                        range: [f64::NEG_INFINITY, f64::INFINITY],
                        declared: false,
                    };
                    let recording = recording(&wave, &instrument, 0.6, &mut Noise::new(5));
                    assert_eq!(clipped(&recording), 0, "{wave:?} {instrument:?}");
                }
            }
        }
    }
}

#[test]
fn dropped_rows_do_not_clip() {
    let mut noise = Noise::new(23);
    for share in [0.02, 0.2, 0.5] {
        let audit = audited(|s| {
            let kept: Vec<bool> = s.t.iter().map(|_| noise.uniform() >= share).collect();
            let thin = |x: &mut Vec<f64>| {
                let mut keep = kept.iter();
                x.retain(|_| *keep.next().expect("as long"));
            };
            thin(&mut s.t);
            thin(&mut s.speed);
            s.v.iter_mut().chain(&mut s.i).for_each(thin);
        });
        let codes: Vec<Code> = audit.findings.iter().map(|finding| finding.code).collect();
        assert_eq!(codes, [Code::Gap], "{share}");
    }
}

/// Share of the channels that are found clipped, of a waveform with up to 3 % fifth harmonic whose peaks lose a share.
fn found(cut: f64, instrument: &Instrument, one_sided: bool, seed: u64) -> f64 {
    let mut noise = Noise::new(seed);
    let tries = 4 * repetitions();
    let mut count = 0;
    for _ in 0..tries {
        let wave = Wave {
            hz: 50.0 + 0.1 * (noise.uniform() - 0.5),
            parts: vec![
                (1.0, 1.0, TAU * noise.uniform()),
                (5.0, 0.03 * noise.uniform(), TAU * noise.uniform()),
            ],
            mean: 0.0,
            swing: 0.0,
        };
        let peak = (0..2000)
            .map(|k| wave.at(f64::from(k) * 1e-5, 0.0))
            .fold(0.0, f64::max);
        let limit = (1.0 - cut) * peak;
        let low = if one_sided { f64::NEG_INFINITY } else { -limit };
        let cut_off = Instrument {
            range: [low, limit],
            ..*instrument
        };
        count += clipped(&recording(&wave, &cut_off, 0.6, &mut noise));
    }
    count as f64 / (3 * tries) as f64
}

/// The cuts that must be found: share of the amplitude, samples per second, bits over 1.5 times the level, noise ahead of the
/// end of the range and behind it, as shares of the amplitude.
#[test]
fn what_is_cut_off_is_found() {
    let cases = [
        (0.02, 10_000.0, 12, [0.0, 0.0]),
        (0.02, 10_000.0, 12, [0.002, 0.0]),
        (0.02, 10_000.0, 12, [0.01, 0.0]),
        (0.05, 10_000.0, 10, [0.002, 0.0]),
        (0.05, 5_000.0, 12, [0.002, 0.0]),
        (0.1, 10_000.0, 8, [0.01, 0.0]),
        (0.1, 10_000.0, 12, [0.0, 0.0005]),
        (0.2, 5_000.0, 12, [0.002, 0.0]),
        (0.2, 10_000.0, 12, [0.0, 0.002]),
        (0.3, 5_000.0, 10, [0.0, 0.002]),
        (0.3, 2_000.0, 12, [0.01, 0.0]),
        (0.3, 50_000.0, 16, [0.0, 0.0]),
    ];
    for (cut, rate_hz, bits, noise) in cases {
        for one_sided in [false, true] {
            let instrument = Instrument {
                rate_hz,
                step: 3.0 * (1.0 - cut) / 2f64.powi(bits),
                noise,
                range: [0.0, 0.0],
                declared: false,
            };
            let share = found(cut, &instrument, one_sided, 41);
            println!(
                "cut {cut} at {rate_hz} Hz, {bits} bits, noise {noise:?}, one side {one_sided}: {share:.2}"
            );
            assert!(
                share >= 0.75,
                "{cut} {instrument:?} one-sided {one_sided}: {share}"
            );
        }
    }
}

/// Either end alone, and what is said of it.
#[test]
fn each_polarity_is_looked_at() {
    for sign in [1.0, -1.0] {
        let audit = audited(|s| {
            s.metadata.sensors = Sensors::default();
            s.i[1]
                .iter_mut()
                .for_each(|x| *x = sign * (sign * *x).min(5.0));
        });
        // Cutting one side off leaves a mean and a sum as well.
        let first = &audit.findings[0];
        assert_eq!((first.code, first.channel.as_str()), (Code::Clipping, "ib"));
        assert!((first.value - 5.0).abs() < 0.01, "{first:?}");
    }
    assert_codes(&audited(|_| {}), &[]);
}
