//! What motors do in normal operation, simulated: no finding, whatever the manoeuvre.

use crate::synthetic::{Noise, expectation};
use audit::{Audit, Code, audit};
use motor::dynamic::{Dynamic, DynamicState, phases};
use motor::{Mechanics, TParams};
use num_complex::Complex64;
use recording::{Channel, Metadata, Recording, Sensors, Supply};
use std::f64::consts::TAU;

/// Samples per second of the recordings.
const RATE_HZ: f64 = 10_000.0;
/// Rated amplitude of the phase voltage, V.
const RATED: f64 = 326.6;

/// A manoeuvre: what is asked of supply and load.
struct Run {
    seconds: f64,
    /// Stator voltage vector, V, at a time, s.
    supply: fn(f64) -> Complex64,
    /// Load torque, N m, at a time, s, and a speed, rad/s.
    load: fn(f64, f64) -> f64,
    kind: Supply,
    /// Whether noise of 0.2 % of full scale and 12 bits are added and declared.
    noisy: bool,
}

fn machine() -> Dynamic {
    let params = TParams {
        r_s: 3.7,
        r_r: 2.296_875,
        l_ls: 0.010_735,
        l_lr: 0.010_735,
        l_m: 0.234_265,
    };
    let mechanics = Mechanics {
        n_p: 2.0,
        inertia: 0.015,
        friction: 0.001,
        load_friction: 0.0,
    };
    Dynamic::new(&params, &mechanics)
}

const FULL_SCALES: [f64; 3] = [600.0, 60.0, 200.0];

impl Run {
    fn recording(&self) -> Recording {
        let (model, mut state) = (machine(), DynamicState::rest());
        let n = (self.seconds * RATE_HZ) as usize;
        let h = 1.0 / RATE_HZ;
        let mut columns = vec![Vec::new(); 7];
        let mut noise = Noise::new(1);
        for k in 0..n {
            let t = k as f64 * h;
            let (u, i) = ((self.supply)(t), model.current(t, &state, (self.supply)(t)));
            let row = [phases(u).as_slice(), &phases(i), &[state.omega_mech]].concat();
            for (j, (column, x)) in columns.iter_mut().zip(row).enumerate() {
                column.push(if self.noisy {
                    measured(x, FULL_SCALES[j / 3], &mut noise)
                } else {
                    x
                });
            }
            for part in 0..5 {
                model.step(
                    &mut state,
                    t + h * f64::from(part) / 5.0,
                    h / 5.0,
                    self.supply,
                    self.load,
                );
            }
        }
        let t = (0..n).map(|k| k as f64 * h).collect();
        let mut recording = Recording::new("run.csv", t, self.metadata()).unwrap();
        let channels = Channel::VOLTAGES
            .into_iter()
            .chain(Channel::CURRENTS)
            .chain([Channel::SPEED]);
        for (channel, column) in channels.zip(columns) {
            recording = recording.with_channel(channel, column).unwrap();
        }
        recording
    }

    fn metadata(&self) -> Metadata {
        let [voltage, current, speed] = FULL_SCALES.map(Some);
        let sensors = Sensors {
            voltage_full_scale_volt: voltage,
            current_full_scale_amp: current,
            speed_full_scale_rad_s: speed,
            noise_sigma_fraction_of_full_scale: Some(0.002),
            adc_bits: Some(12),
            ..Sensors::default()
        };
        let sensors = if self.noisy {
            sensors
        } else {
            Sensors::default()
        };
        Metadata {
            supply: self.kind,
            sensors,
            ..Metadata::default()
        }
    }

    fn audited(&self) -> Audit {
        audit(&self.recording(), &expectation())
    }
}

fn measured(x: f64, full_scale: f64, noise: &mut Noise) -> f64 {
    let step = 2.0 * full_scale / 4096.0;
    let noisy = x + 0.002 * full_scale * noise.draw();
    (step * (noisy / step).round()).clamp(-full_scale, full_scale - step)
}

fn grid(t: f64) -> Complex64 {
    Complex64::from_polar(RATED, TAU * 50.0 * t + 0.3)
}

fn no_load(_: f64, _: f64) -> f64 {
    0.0
}

#[track_caller]
fn assert_quiet(name: &str, run: Run) {
    for noisy in [false, true] {
        let audit = Run { noisy, ..run }.audited();
        assert!(
            audit.findings.is_empty(),
            "{name}, noisy {noisy}: {:#?}",
            audit.findings
        );
    }
}

fn on_grid(seconds: f64, supply: fn(f64) -> Complex64, load: fn(f64, f64) -> f64) -> Run {
    Run {
        seconds,
        supply,
        load,
        kind: Supply::Grid,
        noisy: false,
    }
}

#[test]
fn a_start_with_load_steps() {
    assert_quiet(
        "steps",
        on_grid(2.0, grid, |t, _| if t > 1.0 { 14.6 } else { 0.0 }),
    );
}

#[test]
fn a_start_alone_without_any_steady_time() {
    assert_quiet("start", on_grid(0.2, grid, no_load));
    assert_quiet("heavy start", on_grid(0.3, grid, |_, w| 6e-4 * w * w));
}

#[test]
fn one_steady_load() {
    let late = |t: f64| grid(t);
    let run = on_grid(2.0, late, |_, _| 14.6);
    for noisy in [false, true] {
        let whole = Run { noisy, ..run }.recording();
        let steady = whole.slice(10_000..20_000).unwrap();
        let audit = audit(&steady, &expectation());
        assert!(
            audit.findings.is_empty(),
            "noisy {noisy}: {:#?}",
            audit.findings
        );
    }
}

#[test]
fn a_supply_that_is_cut_off() {
    // Terminals shorted by the supply's own zero: currents and flux decay, the shaft coasts.
    assert_quiet(
        "cut",
        on_grid(3.0, |t| if t < 1.0 { grid(t) } else { 0.0.into() }, no_load),
    );
}

#[test]
fn a_weak_and_a_strong_supply() {
    assert_quiet("70 %", on_grid(2.0, |t| 0.7 * grid(t), |_, _| 3.0));
    assert_quiet("115 %", on_grid(2.0, |t| 1.15 * grid(t), |_, _| 3.0));
}

#[test]
fn a_load_that_drives_the_motor() {
    assert_quiet(
        "driven",
        on_grid(2.0, grid, |t, _| if t > 0.5 { -10.0 } else { 0.0 }),
    );
    assert_quiet(
        "driven throughout",
        on_grid(2.0, grid, |_, w| if w > 150.0 { -12.0 } else { 0.0 }),
    );
}

#[test]
fn a_blocked_rotor() {
    // A load that stops every movement: viscous beyond measure.
    assert_quiet("blocked", on_grid(0.5, |t| 0.25 * grid(t), |_, w| 40.0 * w));
}

fn ramp(t: f64) -> Complex64 {
    let (frequency, angle) = match t {
        t if t < 2.0 => (25.0 * t, TAU * 12.5 * t * t),
        _ => (50.0, TAU * (50.0 * t - 50.0)),
    };
    Complex64::from_polar(RATED * (frequency / 50.0).max(0.03), angle)
}

#[test]
fn an_inverter_that_ramps_up() {
    let run = Run {
        kind: Supply::Inverter,
        ..on_grid(4.0, ramp, |t, _| if t > 3.0 { 10.0 } else { 0.0 })
    };
    assert_quiet("ramp", run);
}

#[test]
fn an_inverter_that_reverses() {
    // From +50 Hz through standstill to -50 Hz between 1 s and 3 s.
    fn reverse(t: f64) -> Complex64 {
        let (frequency, angle) = match t {
            t if t < 1.0 => (50.0, 50.0 * t),
            t if t < 3.0 => (50.0 - 50.0 * (t - 1.0), 50.0 * t - 25.0 * (t - 1.0).powi(2)),
            _ => (-50.0, 150.0 - 100.0 - 50.0 * (t - 3.0)),
        };
        Complex64::from_polar(RATED * (frequency.abs() / 50.0).max(0.03), TAU * angle)
    }
    let run = Run {
        kind: Supply::Inverter,
        ..on_grid(4.0, reverse, no_load)
    };
    assert_quiet("reversal", run);
}

#[test]
fn an_inverter_at_low_frequency() {
    let run = Run {
        kind: Supply::Inverter,
        ..on_grid(
            3.0,
            |t| Complex64::from_polar(45.0, TAU * 5.0 * t),
            |_, _| 3.0,
        )
    };
    assert_quiet("5 Hz", run);
}

/// Two-level pulses, sampled as they come: the fundamental is still found. The carrier is no divisor of
/// the sampling rate: where it is, sampling makes a true mean of the pulses' edges.
#[test]
fn an_inverter_whose_pulses_are_recorded() {
    fn pulses(t: f64) -> Complex64 {
        let carrier = 4.0 * ((2487.0 * t).fract() - 0.5).abs() - 1.0;
        let leg = |k: f64| {
            let wanted = 0.9 * (TAU * (50.0 * t - k / 3.0)).cos();
            if wanted > carrier { 300.0 } else { -300.0 }
        };
        motor::dynamic::clarke([leg(0.0), leg(1.0), leg(2.0)])
    }
    let run = Run {
        kind: Supply::Inverter,
        ..on_grid(2.0, pulses, |_, _| 5.0)
    };
    assert_quiet("pulses", run);
}

/// Effects that explain has to find are not findings of the audit.
#[test]
fn a_speed_scale_of_one_percent_too_little_stays_a_question_for_the_model() {
    let run = on_grid(2.0, grid, |t, _| if t > 1.0 { 14.6 } else { 0.0 });
    let recording = run.recording();
    let scaled = recording
        .speed()
        .unwrap()
        .iter()
        .map(|w| 0.99 * w)
        .collect();
    let audit = audit(
        &recording.with_channel(Channel::SPEED, scaled).unwrap(),
        &expectation(),
    );
    assert!(audit.findings.is_empty(), "{:#?}", audit.findings);
}

#[test]
fn a_recording_that_ends_before_three_periods_is_refused_not_guessed() {
    let audit = on_grid(0.05, grid, no_load).audited();
    let codes: Vec<Code> = audit.findings.iter().map(|finding| finding.code).collect();
    assert_eq!(codes, [Code::NotLocked]);
    assert!(!audit.supported);
}
