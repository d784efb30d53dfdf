//! What recorders do: stand still, refresh slowly, catch spikes, sample in turn, run by two clocks.

use crate::common::{Folder, quiet};
use crate::synthetic::{Noise, Signals, assert_codes, assert_one, audited, expectation};
use audit::{Audit, Circuit, Code, Expectation, audit};
use formats::{read_recording, write_recording};
use recording::{Channel, Mapping, Recording};
use std::f64::consts::TAU;

/// Written and read again, as a file of somebody else would be.
fn reread(recording: &Recording, name: &str) -> Recording {
    let folder = Folder::new(name);
    let path = folder.path("recording.csv");
    write_recording(&path, recording).expect("room");
    read_recording(&path, &Mapping::default(), &mut quiet()).expect("readable")
}

#[test]
fn a_recorder_that_stands_still_from_mid_file_is_named() {
    for from in [4_000, 10_000, 17_000] {
        let audit = audited(|s| {
            let each = s.v.iter_mut().chain(&mut s.i).chain([&mut s.speed]);
            each.for_each(|x| {
                let held = x[from];
                x[from..].fill(held);
            });
        });
        let frozen = audit.findings.iter().find(|f| f.code == Code::Frozen);
        let frozen = frozen.unwrap_or_else(|| panic!("{from}: {audit:#?}"));
        assert!(
            (frozen.value - (20_000 - from) as f64 * 1e-4).abs() < 2e-4,
            "{frozen:?}"
        );
        assert!((frozen.from_s.unwrap() - from as f64 * 1e-4).abs() < 1e-9);
        // More than half of the file is no recording any more.
        assert_eq!(audit.supported, from >= 10_000, "{from}");
    }
}

/// Whatever value it stands at, be it that of a peak, nothing else comes of it.
#[test]
fn a_recorder_that_stands_still_at_a_peak_does_not_clip() {
    for from in (15_000..15_200).step_by(17) {
        let audit = audited(|s| {
            let each = s.v.iter_mut().chain(&mut s.i).chain([&mut s.speed]);
            each.for_each(|x| {
                let held = x[from];
                x[from..].fill(held);
            });
        });
        assert_codes(&audit, &[Code::Frozen]);
    }
}

#[test]
fn a_supply_that_is_off_does_not_freeze_a_recorder() {
    let audit = audited(|s| {
        for x in s.v.iter_mut().chain(&mut s.i) {
            x[15_000..].fill(0.0);
        }
    });
    assert!(
        audit.findings.iter().all(|f| f.code != Code::Frozen),
        "{audit:#?}"
    );
}

/// Keeps each value for some rows.
fn hold(x: &mut [f64], rows: usize) {
    for k in 0..x.len() {
        x[k] = x[k - k % rows];
    }
}

#[test]
fn values_of_a_display_are_named_with_the_rows_they_last() {
    for rows in [10, 40, 200] {
        let audit = audited(|s| hold(&mut s.speed, rows));
        assert_one(&audit, Code::Held, "speed", rows as f64, 0.0, "display");
    }
    for rows in [10, 40] {
        let audit = audited(|s| s.i.iter_mut().for_each(|x| hold(x, rows)));
        let first = &audit.findings[0];
        assert_eq!(
            (first.code, first.channel.as_str()),
            (Code::Held, "ia ib ic"),
            "{rows}: {audit:#?}"
        );
        assert_eq!(first.value, rows as f64);
        assert!(!audit.supported);
    }
}

#[test]
fn a_file_with_more_rows_than_measurements_is_named_and_can_be_used() {
    let audit = audited(|s| {
        let each = s.v.iter_mut().chain(&mut s.i).chain([&mut s.speed]);
        each.for_each(|x| hold(x, 10));
    });
    let held: Vec<&str> = audit
        .findings
        .iter()
        .filter(|f| f.code == Code::Held)
        .map(|f| f.channel.as_str())
        .collect();
    assert_eq!(held, ["va vb vc ia ib ic", "speed"], "{audit:#?}");
    assert!(audit.supported);
}

/// Effective values of a meter: positive, refreshed twice a second.
#[test]
fn effective_values_of_a_slow_meter_are_refused() {
    let mut noise = Noise::new(5);
    let audit = audited(|s| {
        for x in s.v.iter_mut().chain(&mut s.i) {
            let size = if x[0].abs() > 20.0 { 230.0 } else { 3.4 };
            x.iter_mut()
                .for_each(|x| *x = size * (1.0 + 0.003 * noise.draw()));
            hold(x, 500);
        }
    });
    assert!(!audit.supported);
    assert!(
        audit.findings.iter().any(|f| f.code == Code::RmsValues),
        "{audit:#?}"
    );
}

/// A resolution is no refresh: steps of a coarse converter, an encoder's count, a slow warming.
#[test]
fn a_coarse_channel_is_not_held() {
    for step in [0.5, 2.0] {
        let audit = audited(|s| {
            s.speed
                .iter_mut()
                .for_each(|x| *x = step * (*x / step).round())
        });
        assert_codes(&audit, &[]);
    }
    let drifting = audited(|s| {
        let slow = |k: usize| 150.0 - 0.1 * (k as f64 / 150.0).floor();
        s.speed = (0..s.t.len()).map(slow).collect();
    });
    assert_codes(&drifting, &[]);
}

#[test]
fn spikes_of_the_speed_are_bridged_and_named() {
    let mut noise = Noise::new(31);
    let mut signals = Signals::healthy(7);
    let mut count = 0;
    for x in &mut signals.speed {
        if noise.uniform() < 0.025 {
            *x = 4e5 * (2.0 * noise.uniform() - 1.0);
            count += 1;
        }
    }
    let recording = reread(&signals.recording(), "spikes");
    let audit = audit(&recording, &expectation());
    assert_one(
        &audit,
        Code::Spikes,
        "speed",
        f64::from(count),
        1.0,
        "bridged",
    );
    let speed = recording.speed().unwrap();
    assert!(speed.iter().all(|w| (148.0..160.0).contains(w)));
}

#[test]
fn one_outlier_in_any_channel_does_not_refuse_a_file() {
    for k in 0..7 {
        for size in [1e3, -1e9] {
            let mut signals = Signals::healthy(3);
            let channel = match k {
                0..3 => &mut signals.v[k],
                3..6 => &mut signals.i[k - 3],
                _ => &mut signals.speed,
            };
            channel[7_777] = if k < 3 { 10.0 * size } else { size };
            let audit = audit(&reread(&signals.recording(), "outlier"), &expectation());
            assert_codes(&audit, &[Code::Spikes]);
            assert!(
                audit.supported && audit.findings[0].value == 1.0,
                "{audit:#?}"
            );
        }
    }
}

/// The healthy signals with each channel sampled some time after its row; the currents also by a faster clock.
fn late(delays_s: [f64; 6], ppm: f64, seed: u64) -> Audit {
    let mut noise = Noise::new(seed);
    let mut signals = Signals::healthy(seed);
    let lag = |t: f64| {
        if t < 1.0 {
            (6.75, 40.0_f64)
        } else {
            (4.24, 87.0)
        }
    };
    for k in 0..3 {
        let phase = -(k as f64) * TAU / 3.0;
        for (j, t) in signals.t.iter().enumerate() {
            let at = t + delays_s[k];
            signals.v[k][j] = 326.6 * (TAU * 50.0 * at + phase).cos() + 1.2 * noise.draw();
            let at = t * (1.0 + 1e-6 * ppm) + delays_s[3 + k];
            let (size, degrees) = lag(*t);
            signals.i[k][j] = size * (TAU * 50.0 * at + phase - degrees.to_radians()).cos()
                + 0.012 * noise.draw();
        }
    }
    audit(&signals.recording(), &expectation())
}

#[test]
fn channels_sampled_in_turn_get_their_delays_proposed() {
    for step in [5.0, 11.55, 16.0] {
        for order in [
            [0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
            [0.0, 2.0, 4.0, 1.0, 3.0, 5.0],
        ] {
            let audit = late(order.map(|k| 1e-6 * step * k), 0.0, 7);
            let found: Vec<_> = audit
                .findings
                .iter()
                .filter(|f| f.code == Code::Skew)
                .collect();
            assert_eq!(found.len(), 1, "{step} {order:?}: {audit:#?}");
            let expected = step * order[1];
            assert!(
                (found[0].value - expected).abs() < 0.05 * expected,
                "{expected}: {found:?}"
            );
            let flag = format!("--delay vb={:.2}us", found[0].value);
            assert!(
                found[0].detail.contains(&flag) && !found[0].refuses,
                "{found:?}"
            );
        }
    }
}

/// Gains, a displaced neutral and an unbalanced supply are no delays.
#[test]
fn gains_and_unbalance_propose_no_delay() {
    let mut noise = Noise::new(77);
    for _ in 0..40 {
        let gains: Vec<f64> = (0..6).map(|_| 1.0 + 0.01 * noise.draw()).collect();
        let audit = audited(|s| {
            let each = s.v.iter_mut().chain(&mut s.i).zip(&gains);
            each.for_each(|(x, gain)| x.iter_mut().for_each(|x| *x *= gain));
        });
        assert!(
            audit.findings.iter().all(|f| f.code != Code::Skew),
            "{gains:?} {audit:#?}"
        );
    }
}

/// Seconds of the signals with one load, the currents by a clock of their own.
fn two_clocks(ppm: f64, seconds: f64, slip_walk: f64) -> Audit {
    let n = (seconds * 5_000.0) as usize;
    let mut noise = Noise::new(19);
    let mut signals = Signals::healthy(1);
    signals.t = (0..n).map(|k| k as f64 / 5_000.0).collect();
    let clock = signals.t.clone();
    // A load that grows turns the current by what its slip says: 40 degrees at 4.1 %, some degrees for each per mille.
    let turn = |t: f64| -slip_walk * 250.0 * t / seconds;
    for k in 0..3 {
        let phase = -(k as f64) * TAU / 3.0;
        let volt = |t: &f64| 326.6 * (TAU * 50.0 * t + phase).cos() + 1.2 * noise.draw();
        signals.v[k] = clock.iter().map(volt).collect();
        let amp = |t: &f64| {
            let angle = TAU * 50.0 * t * (1.0 + 1e-6 * ppm) + phase - 0.7 - turn(*t).to_radians();
            6.75 * angle.cos() + 0.05 * noise.draw()
        };
        signals.i[k] = clock.iter().map(amp).collect();
    }
    signals.speed = clock
        .iter()
        .map(|t| 150.64 - 157.08 * slip_walk * t / seconds + 0.2 * noise.draw())
        .collect();
    audit(&signals.recording(), &expectation())
}

#[test]
fn two_clocks_are_named_with_their_difference() {
    for (ppm, seconds) in [(100.0, 2.0), (-100.0, 5.0), (20.0, 10.0), (100.0, 60.0)] {
        let audit = two_clocks(ppm, seconds, 0.0);
        assert_codes(&audit, &[Code::ClockDrift]);
        let found = &audit.findings[0];
        assert!(
            (found.value - ppm).abs() < 0.05 * ppm.abs(),
            "{ppm}: {found:?}"
        );
        assert!(found.refuses);
    }
    assert_codes(&two_clocks(0.0, 10.0, 0.0), &[]);
}

#[test]
fn a_load_that_grows_slowly_is_no_drift() {
    for slip_walk in [0.0005, 0.001, 0.003, 0.01] {
        for sign in [1.0, -1.0] {
            let audit = two_clocks(0.0, 10.0, sign * slip_walk);
            assert!(
                audit.findings.iter().all(|f| f.code != Code::ClockDrift),
                "{audit:#?}"
            );
        }
    }
}

/// 2.2 kW with 3.7 ohm; 1.5 (L_m/L_s)^2/R_r of the example machine.
#[test]
fn a_speed_above_the_field_of_a_motor_that_drives_its_load_is_named() {
    let circuit = Circuit {
        stator_ohm: 3.7,
        slip_watt_per_volt2: 1.5 * (0.234_f64 / 0.245).powi(2) / 2.3,
    };
    let known = Expectation {
        circuit: Some(circuit),
        ..expectation()
    };
    let scaled = |scale: f64| {
        let mut signals = Signals::healthy(7);
        // No load throughout: 6.75 A at 40 degrees become 4.24 A at 87.
        let n = signals.t.len() / 2;
        let tail = |x: &Vec<f64>| x[n..].to_vec();
        signals.t = tail(&signals.t);
        signals.v = [0, 1, 2].map(|k| tail(&signals.v[k]));
        signals.i = [0, 1, 2].map(|k| tail(&signals.i[k]));
        signals.speed = tail(&signals.speed).iter().map(|w| scale * w).collect();
        audit(&signals.recording(), &known)
    };
    assert_codes(&scaled(1.0), &[]);
    let audit = scaled(1.01);
    assert_one(
        &audit,
        Code::SpeedImplausible,
        "speed",
        -1.0,
        0.02,
        "--scale speed=FACTOR",
    );
    assert!(
        audit
            .findings
            .iter()
            .all(|f| f.channel != Channel::CURRENTS[0].to_string())
    );
}
