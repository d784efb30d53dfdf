use super::*;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;
use recording::{Channel, Metadata};
use std::f64::consts::TAU;

/// One signal behind six channels.
#[derive(Clone, Copy)]
struct Bench {
    hertz: f64,
    seconds: f64,
    gain: [f64; CHANNELS],
    late_s: [f64; CHANNELS],
    /// rad.
    turned: [f64; CHANNELS],
    /// Of full scale.
    noise: f64,
    full_scale: [f64; 2],
    volt: f64,
    amp: f64,
    seed: u64,
}

const GOOD: Bench = Bench {
    hertz: 50.0,
    seconds: 10.0,
    gain: [1.004, 0.997, 1.0, 0.992, 1.006, 1.001],
    late_s: [93.5e-6, 92.3e-6, 91.1e-6, 88.1e-6, 86.9e-6, 85.7e-6],
    turned: [0.0; CHANNELS],
    noise: 0.7 / 2048.0,
    full_scale: [630.8, 20.1],
    volt: 325.0,
    amp: 10.0,
    seed: 3,
};

impl Bench {
    fn recording(&self) -> Recording {
        let mut random = Pcg64::seed_from_u64(self.seed);
        let count = (self.seconds * 1e4) as usize;
        let t: Vec<f64> = (0..count).map(|k| k as f64 * 1e-4).collect();
        let mut recording =
            Recording::new("bench.csv", t.clone(), Metadata::default()).expect("sound");
        let channels = Channel::VOLTAGES.into_iter().chain(Channel::CURRENTS);
        for (k, channel) in channels.enumerate() {
            let (size, full_scale) = match k < 3 {
                true => (self.volt, self.full_scale[0]),
                false => (self.amp, self.full_scale[1]),
            };
            let noise = Normal::new(0.0, self.noise * full_scale).expect("positive");
            let step = full_scale / 2048.0;
            let shown = |t: &f64| {
                let angle = TAU * self.hertz * (t - self.late_s[k]) + self.turned[k];
                // A third harmonic, as a laboratory's supply has.
                let wave = angle.cos() + 0.01 * (3.0 * angle).cos();
                let x = size * self.gain[k] * wave + noise.sample(&mut random);
                ((x / step).round() * step).clamp(-full_scale, full_scale)
            };
            let values = t.iter().map(shown).collect::<Vec<_>>();
            recording = recording.with_channel(channel, values).expect("sound");
        }
        recording
    }
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

/// Against the numbers that the signals were made with; 4.5 standard errors of 24 numbers are passed once in 6000.
#[test]
fn gains_and_delays_are_found_within_their_errors() {
    let found = find(&[GOOD.recording()], &Setup::default()).expect("a good bench");
    for group in [0..3, 3..6] {
        let log = mean(
            &GOOD.gain[group.clone()]
                .iter()
                .map(|g| g.ln())
                .collect::<Vec<_>>(),
        );
        for k in group {
            let (one, truth) = (found.gain[k], log.exp() / GOOD.gain[k]);
            assert!(one.error < 6e-5, "{k}: {one:?}");
            assert!(
                (one.value - truth).abs() < 4.5 * one.error,
                "{k}: {one:?} {truth}"
            );
        }
    }
    let common = mean(&GOOD.late_s[3..]);
    for (k, late) in GOOD.late_s.iter().enumerate() {
        let one = found.delay_s[k];
        assert!(one.error < 0.2e-6, "{k}: {one:?}");
        assert!(
            (one.value - (late - common)).abs() < 4.5 * one.error,
            "{k}: {one:?}"
        );
    }
    assert_eq!(found.rotation_rad, None);
    assert!((found.frequencies_hz[0] - 50.0).abs() < 1e-4);
}

/// 50 Hz at 10 kHz without noise: every cycle is rounded alike, the blocks do not scatter, and the errors are not 0.
#[test]
fn rounding_in_step_with_the_supply_is_part_of_the_errors() {
    let bench = Bench { noise: 0.0, ..GOOD };
    let found = find(&[bench.recording()], &Setup::default()).expect("a good bench");
    let common = mean(&GOOD.late_s[3..]);
    for (one, late) in found.delay_s.iter().zip(GOOD.late_s) {
        assert!(one.error > 0.05e-6 && one.error < 0.2e-6, "{one:?}");
        assert!(
            (one.value - (late - common)).abs() < 4.5 * one.error,
            "{one:?}"
        );
    }
}

#[test]
fn a_meter_fixes_the_scale_and_a_known_roll_off_is_taken_out() {
    let setup = Setup {
        true_volt: Some(325.0 / 2.0_f64.sqrt()),
        true_amp: Some(10.0 / 2.0_f64.sqrt()),
        roll_off_s: 83.7e-6,
        ..Setup::default()
    };
    let turn = TAU * 50.0 * 83.7e-6;
    let bench = Bench {
        gain: GOOD.gain.map(|gain| gain * (1.0 - 0.5 * turn * turn)),
        ..GOOD
    };
    let found = find(&[bench.recording()], &setup).expect("a good bench");
    for (one, gain) in found.gain.iter().zip(GOOD.gain) {
        // (w T)^4 is 5e-7.
        assert!(
            (one.value * gain - 1.0).abs() < 4.5 * one.error + 1e-6,
            "{one:?} {gain}"
        );
    }
}

#[test]
fn two_frequencies_tell_a_rotation_from_a_delay() {
    let mut turned = [0.0; CHANNELS];
    turned[1] = 0.01;
    let at = |hertz: f64, seed: u64| {
        Bench {
            hertz,
            turned,
            seed,
            ..GOOD
        }
        .recording()
    };
    let found = find(&[at(25.0, 4), at(60.0, 5)], &Setup::default()).expect("a good bench");
    let rotation = found.rotation_rad.expect("two frequencies");
    assert!(
        (rotation[1].value - 0.01).abs() < 4.5 * rotation[1].error,
        "{rotation:?}"
    );
    assert!(
        rotation[0].value.abs() < 4.5 * rotation[0].error,
        "{rotation:?}"
    );
    let late = GOOD.late_s[1] - mean(&GOOD.late_s[3..]);
    assert!((found.delay_s[1].value - late).abs() < 4.5 * found.delay_s[1].error);
    // With one frequency the same rotation is taken for 32 us.
    let one = find(&[at(50.0, 6)], &Setup::default()).expect("a good bench");
    assert!((one.delay_s[1].value - late + 0.01 / (TAU * 50.0)).abs() < 1e-6);
}

#[test]
fn the_load_s_own_lag_is_taken_out() {
    let lag = 0.4e-6;
    let mut late_s = GOOD.late_s;
    late_s[3..].iter_mut().for_each(|late| *late += lag);
    let bench = Bench { late_s, ..GOOD };
    let setup = Setup {
        load_time_constant_s: lag,
        ..Setup::default()
    };
    let found = find(&[bench.recording()], &setup).expect("a good bench");
    let truth = GOOD.late_s[0] - mean(&GOOD.late_s[3..]);
    let one = found.delay_s[0];
    assert!(
        (one.value - truth).abs() < 4.5 * one.error,
        "{one:?} {truth}"
    );
}

fn refusal(bench: Bench) -> String {
    let refused = find(&[bench.recording()], &Setup::default());
    refused.expect_err("refused").to_string()
}

#[test]
fn what_is_no_such_bench_is_refused_with_the_remedy() {
    let turned = |turns: [f64; CHANNELS]| Bench {
        turned: turns.map(|turns| turns * TAU),
        seconds: 2.0,
        ..GOOD
    };
    let third = 1.0 / 3.0;
    let cases = [
        (
            turned([0.0, -third, third, 0.0, -third, third]),
            "three phases",
        ),
        (
            turned([0.0, 0.5, 0.0, 0.0, 0.0, 0.0]),
            "vb is the other way round",
        ),
        (turned([0.0, 0.0, 0.0, -0.1, -0.1, -0.1]), "not resistive"),
        (
            Bench {
                seconds: 0.5,
                ..GOOD
            },
            "record ten seconds",
        ),
        (
            Bench {
                hertz: 120.0,
                ..GOOD
            },
            "120.0 Hz",
        ),
        (
            Bench {
                volt: 0.0,
                noise: 0.0,
                ..GOOD
            },
            "lead all three voltage inputs to one phase",
        ),
        (
            Bench {
                noise: 0.05,
                seconds: 1.2,
                ..GOOD
            },
            "record longer",
        ),
        (
            Bench {
                volt: 700.0,
                ..GOOD
            },
            "lower the signal",
        ),
        (
            Bench {
                gain: [1.0, 1.0, 0.01, 1.0, 1.0, 1.0],
                ..GOOD
            },
            "vc does not show the signal",
        ),
        (
            Bench {
                gain: [1.0, 1.0, 1.3, 1.0, 1.0, 1.0],
                ..GOOD
            },
            "check its range",
        ),
    ];
    for (bench, words) in cases {
        let message = refusal(bench);
        assert!(message.contains(words), "{words}: {message}");
    }
}

#[test]
fn recordings_that_contradict_each_other_are_refused() {
    let mut gain = GOOD.gain;
    gain[4] *= 1.005;
    let other = Bench {
        gain,
        seed: 9,
        ..GOOD
    };
    let refused = find(&[GOOD.recording(), other.recording()], &Setup::default());
    let message = refused.expect_err("refused").to_string();
    assert!(message.contains("gain of"), "{message}");
}
