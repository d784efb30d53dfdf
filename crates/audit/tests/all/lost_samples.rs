//! Samples that are missing although the times go on evenly, and what is none of them. All signals are closed forms.

use crate::synthetic::{Noise, expectation};
use audit::{Audit, Code, Finding, audit};
use recording::{Channel, Metadata, Recording};
use std::f64::consts::TAU;

/// Amplitude and angle of a rotating set at a time, s.
type Form<'f> = &'f dyn Fn(f64) -> (f64, f64);

struct Signals<'f> {
    rate_hz: f64,
    seconds: f64,
    /// Standard deviation over amplitude.
    noise: f64,
    volt: Option<Form<'f>>,
    amp: Option<Form<'f>>,
    /// Added to each voltage, of the phase's own angle and the time.
    ripple: &'f dyn Fn(f64, f64) -> f64,
}

fn grid(t: f64) -> (f64, f64) {
    (326.6, TAU * 50.0 * t)
}

fn loaded(t: f64) -> (f64, f64) {
    (6.75, TAU * 50.0 * t - 0.7)
}

impl Default for Signals<'_> {
    fn default() -> Self {
        Signals {
            rate_hz: 5000.0,
            seconds: 3.0,
            noise: 0.001,
            volt: Some(&grid),
            amp: Some(&loaded),
            ripple: &|_, _| 0.0,
        }
    }
}

impl Signals<'_> {
    /// The audit of the samples that `keeps` leaves, their times even.
    fn audited(&self, keeps: impl Fn(usize) -> bool) -> Audit {
        let mut noise = Noise::new(3);
        let all = 0..(self.seconds * self.rate_hz) as usize;
        let times: Vec<f64> = all
            .filter(|k| keeps(*k))
            .map(|k| k as f64 / self.rate_hz)
            .collect();
        let even = (0..times.len()).map(|k| k as f64 / self.rate_hz).collect();
        let mut recording = Recording::new("x", even, Metadata::default()).expect("a clock");
        let sets = [
            (Channel::VOLTAGES, self.volt),
            (Channel::CURRENTS, self.amp),
        ];
        for (channels, form) in sets {
            let Some(form) = form else { continue };
            for (phase, channel) in channels.into_iter().enumerate() {
                let value = |t: &f64| {
                    let (size, angle) = form(*t);
                    let angle = angle - TAU / 3.0 * phase as f64;
                    let ripple = match channels == Channel::VOLTAGES {
                        true => (self.ripple)(angle, *t),
                        false => 0.0,
                    };
                    size * (angle.cos() + self.noise * noise.draw()) + ripple
                };
                let values = times.iter().map(value).collect();
                recording.set(channel, values).expect("a channel");
            }
        }
        audit(&recording, &expectation())
    }

    #[track_caller]
    fn assert_none(&self) {
        let audit = self.audited(|_| true);
        assert!(lost(&audit).is_none(), "{:#?}", audit.findings);
    }
}

fn lost(audit: &Audit) -> Option<&Finding> {
    audit.findings.iter().find(|f| f.code == Code::LostSamples)
}

/// Rows that go one by one, in twos and threes, further apart than a detector reaches: each is counted.
#[test]
fn every_loss_is_counted_and_many_refuse() {
    for rate_hz in [1000.0, 5000.0, 10_000.0] {
        for samples in 1..=3 {
            let signals = Signals {
                rate_hz,
                ..Signals::default()
            };
            let audit = signals.audited(|k| k % 211 >= samples || k < 211);
            let losses = (3.0 * rate_hz) as usize / 211;
            let found = lost(&audit).expect("lost samples");
            // The last three periods may be in no block.
            let unseen = 1.0 + (0.06 * rate_hz / 211.0).floor();
            let missed = losses as f64 - found.value;
            assert!((0.0..=unseen).contains(&missed), "{found:?} {losses}");
            assert!(!audit.supported && found.detail.contains("whole samples"));
            let others = audit
                .findings
                .iter()
                .filter(|f| f.code != Code::LostSamples);
            assert!(others.into_iter().all(|f| f.code == Code::ChannelMissing));
        }
    }
}

#[test]
fn a_few_losses_refuse_nothing_and_a_single_one_is_not_told() {
    let few = |at: &'static [usize]| Signals::default().audited(move |k| !at.contains(&k));
    let found = few(&[3000, 8000, 12_000]);
    let found = lost(&found).expect("lost samples");
    assert_eq!((found.value, found.refuses), (3.0, false));
    assert!(
        found.detail.contains("3 times") && found.detail.contains("0.6000 s"),
        "{found:?}"
    );
    assert!(lost(&few(&[8000])).is_none());
}

#[test]
fn currents_or_voltages_alone_tell_many_losses() {
    for (volt, amp) in [(true, false), (false, true)] {
        let signals = Signals {
            volt: volt.then_some(&grid as Form<'_>),
            amp: amp.then_some(&loaded as Form<'_>),
            ..Signals::default()
        };
        let found = signals.audited(|k| k % 211 != 7);
        assert!(
            lost(&found).is_some_and(|f| f.refuses),
            "{:#?}",
            found.findings
        );
        assert!(lost(&signals.audited(|k| k % 3001 != 7)).is_none());
        signals.assert_none();
    }
}

#[test]
fn times_that_show_the_loss_are_a_gap() {
    let mut recording = Recording::new(
        "x",
        (0..15_000_u32)
            .filter(|k| k % 211 != 7)
            .map(|k| f64::from(k) / 5000.0)
            .collect(),
        Metadata::default(),
    )
    .expect("a clock");
    for (phase, channel) in Channel::CURRENTS.into_iter().enumerate() {
        let wave = |t: &f64| 6.0 * (TAU * (50.0 * t - phase as f64 / 3.0)).cos();
        let values = recording.t().iter().map(wave).collect();
        recording.set(channel, values).expect("a channel");
    }
    let audit = audit(&recording, &expectation());
    assert!(lost(&audit).is_none() && audit.findings.iter().any(|f| f.code == Code::Gap));
}

#[test]
fn noise_and_low_rates_lose_nothing() {
    for rate_hz in [500.0, 650.0, 1000.0, 5000.0, 20_000.0] {
        for noise in [0.0, 0.001, 0.005, 0.01, 0.02] {
            let signals = Signals {
                rate_hz,
                noise,
                ..Signals::default()
            };
            signals.assert_none();
        }
    }
}

#[test]
fn steps_dips_and_ramps_lose_nothing() {
    let at = |t: f64| (t * 5.0).floor() as i32;
    let steps: [(Form<'_>, Form<'_>); 4] = [
        // Load: the current's size and lag follow within milliseconds.
        (&grid, &|t| {
            let slow = 1.0 - (-(t % 0.5) / 0.005).exp();
            let (from, to) = if t % 1.0 < 0.5 {
                (1.4, 0.7)
            } else {
                (0.7, 1.4)
            };
            (6.75, TAU * 50.0 * t - from - (to - from) * slow)
        }),
        // Supply: steps and dips of the voltage.
        (
            &|t| (if at(t) % 2 == 0 { 326.6 } else { 200.0 }, TAU * 50.0 * t),
            &loaded,
        ),
        // Phase steps of the grid by two samples and by half of one, the currents go on.
        (
            &|t| (326.6, TAU * 50.0 * t + TAU / 100.0 * 2.0 * f64::from(at(t))),
            &|t| {
                let slow = 1.0 - (-(t % 0.2) / 0.01).exp();
                let phase = f64::from(at(t)) - 1.0 + slow;
                (6.75, TAU * 50.0 * t + TAU / 100.0 * 2.0 * phase - 0.7)
            },
        ),
        // An inverter that runs up from 5 to 65 Hz.
        (
            &|t| (20.0 + 110.0 * t, TAU * (5.0 * t + 10.0 * t * t)),
            &|t| (6.0, TAU * (5.0 * t + 10.0 * t * t) - 0.7),
        ),
    ];
    for (volt, amp) in steps {
        let signals = Signals {
            volt: Some(volt),
            amp: Some(amp),
            ..Signals::default()
        };
        signals.assert_none();
    }
}

/// Alone the voltages of a grid whose phase steps are no losses either: half steps are among them.
#[test]
fn phase_steps_of_any_size_are_no_losses() {
    let signals = Signals {
        volt: Some(&|t| {
            let step = (t * 5.0).floor();
            (326.6, TAU * 50.0 * t + 0.11 * step + 0.03 * step * step)
        }),
        amp: None,
        ..Signals::default()
    };
    signals.assert_none();
}

#[test]
fn a_start_from_standstill_loses_nothing() {
    let signals = Signals {
        volt: Some(&|t| (if t < 0.5 { 0.0 } else { 326.6 }, TAU * 50.0 * t)),
        amp: Some(&|t| match t < 0.5 {
            true => (0.0, 0.0),
            false => (6.75 + 30.0 * (-(t - 0.5) / 0.3).exp(), TAU * 50.0 * t - 1.2),
        }),
        ..Signals::default()
    };
    signals.assert_none();
}

/// Two levels at 2 kHz, harmonics of a rectifier's size, and a notch six times a period.
#[test]
fn pulses_harmonics_and_notches_lose_nothing() {
    let pulses = |angle: f64, t: f64| {
        let carrier = 2.0 * (t * 2000.0).fract() - 1.0;
        let level = if 0.8 * angle.cos() > carrier {
            400.0
        } else {
            -400.0
        };
        level - 326.6 * angle.cos()
    };
    let harmonics =
        |angle: f64, _: f64| 16.0 * (5.0 * angle).cos() + 10.0 * (7.0 * angle).cos() + 5.0;
    let notches = |angle: f64, _: f64| {
        let inside = (6.0 * angle / TAU).rem_euclid(1.0) < 0.08;
        if inside { -60.0 * angle.cos() } else { 0.0 }
    };
    let ripples: [&dyn Fn(f64, f64) -> f64; 3] = [&pulses, &harmonics, &notches];
    for ripple in ripples {
        for rate_hz in [1000.0, 5000.0, 20_000.0] {
            for amp in [Some(&loaded as Form<'_>), None] {
                let signals = Signals {
                    rate_hz,
                    amp,
                    ripple,
                    ..Signals::default()
                };
                signals.assert_none();
            }
        }
    }
}
