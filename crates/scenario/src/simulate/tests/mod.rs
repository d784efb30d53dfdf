//! The simulated motor and its instruments against what the scenario says.

mod asymmetry;
mod chain;
mod coast_down;
mod instruments;
mod switching;

use super::*;
use crate::tests::{folder, parse};
use crate::{Fault, PlantKind, Scenario, SensorSpec, Start};
use formats::read_recording;
use monitor::{Converter, RawSample};
use motor::dynamic::clarke;
use parity::linear_plant::LinearParams;
use recording::Channel;
use std::f64::consts::TAU;

/// The assumed motor, running, with perfect instruments.
fn ideal(duration_s: f64) -> Scenario {
    let mut scenario = parse(&format!("start = \"running\"\nduration_s = {duration_s}"));
    scenario.sensors = scenario.sensors.ideal();
    scenario
}

fn run(scenario: &Scenario) -> Vec<SimSample> {
    Simulation::new(scenario).expect("runs").collect()
}

fn faulty(scenario: &Scenario, name: &str, percent: f64, frame: Frame) -> Scenario {
    Scenario {
        faults: vec![Fault::percent(name, percent, frame).expect("known")],
        ..scenario.clone()
    }
}

fn rms(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    (values.map(|x| x * x).sum::<f64>() / count).sqrt()
}

/// RK4 at 100 us settles 1e-7 from the exact steady state, its own error at this frequency.
#[test]
fn a_motor_that_starts_running_stays_there() {
    for plant in [PlantKind::Full, PlantKind::Linear] {
        let samples = run(&Scenario {
            plant,
            ..ideal(1.0)
        });
        let first = samples[0].dq(Frame::RotorFlux);
        for sample in &samples {
            let now = sample.dq(Frame::RotorFlux);
            assert!((now.i_d - first.i_d).abs() < 1e-6 && (now.i_q - first.i_q).abs() < 1e-6);
            assert!((sample.truth.omega_mech - samples[0].truth.omega_mech).abs() < 1e-5);
        }
    }
}

#[test]
fn a_start_from_rest_ends_at_the_running_point() {
    let started = Scenario {
        start: Start::Standstill,
        ..ideal(2.0)
    };
    let (rest, running) = (run(&started), run(&ideal(2.0)));
    assert_eq!(rest[0].truth.omega_mech, 0.0);
    let (a, b) = (rest[20_000].truth, running[20_000].truth);
    assert!((a.omega_mech - b.omega_mech).abs() < 1e-6);
    for k in 0..3 {
        assert!((a.i_s_abc[k] - b.i_s_abc[k]).abs() < 1e-6);
    }
}

#[test]
fn the_linear_plant_shows_its_own_steady_state_at_the_terminals() {
    let scenario = Scenario {
        plant: PlantKind::Linear,
        ..ideal(0.1)
    };
    let file = &scenario.motor;
    let v_q = file.nameplate.phase_voltage_amplitude();
    let healthy = LinearParams::new(&file.parameters, &file.mechanics, 1.05);
    let mut changed = healthy;
    changed.l_r *= 0.5;
    for (params, scenario) in [
        (healthy, scenario.clone()),
        (changed, faulty(&scenario, "Lr", -50.0, Frame::Voltage)),
    ] {
        let expected = params.steady_state(v_q);
        for sample in run(&scenario) {
            let dq = sample.dq(Frame::Voltage);
            assert!((dq.i_q - expected.i_q).abs() < 1e-9 && (dq.i_d - 1.05).abs() < 1e-9);
            assert!((dq.u_q - v_q).abs() < 1e-9 && dq.u_d.abs() < 1e-9);
            let omega_el = 2.0 * sample.truth.omega_mech;
            assert!((omega_el - expected.omega_el).abs() < 1e-8);
        }
    }
}

/// The published way: one d-q component changes, the other stays, in the frame that was asked for.
#[test]
fn a_d_q_sensor_fault_touches_one_component_only() {
    let healthy = run(&ideal(0.1));
    for frame in [Frame::Voltage, Frame::RotorFlux] {
        let currents = run(&faulty(&ideal(0.1), "Iq", 50.0, frame));
        let voltages = run(&faulty(&ideal(0.1), "Vq", -50.0, frame));
        for k in 0..healthy.len() {
            let (good, i, v) = (
                healthy[k].dq(frame),
                currents[k].dq(frame),
                voltages[k].dq(frame),
            );
            assert!((i.i_q - 1.5 * good.i_q).abs() < 1e-12 && (i.i_d - good.i_d).abs() < 1e-12);
            assert!((v.u_q - 0.5 * good.u_q).abs() < 1e-12 && (v.u_d - good.u_d).abs() < 1e-12);
            assert_eq!(currents[k].truth, healthy[k].truth);
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_samples_and_another_seed_others() {
    let noisy = |seed| {
        let mut scenario = ideal(0.2);
        scenario.sensors = SensorSpec::of(&scenario.motor);
        scenario
            .sensors
            .instrument
            .noise_sigma_fraction_of_full_scale = 0.002;
        run(&Scenario { seed, ..scenario })
    };
    assert_eq!(noisy(7), noisy(7));
    assert_ne!(noisy(7)[100].measured, noisy(8)[100].measured);
    assert_eq!(noisy(7)[100].truth, noisy(8)[100].truth);
}

/// 0.2 % of full scale and 12 bits: sigma^2 = (0.002 F)^2 + (2 F/4096)^2/12; 3 % is six standard errors of
/// 20000 samples.
#[test]
fn noise_and_resolution_are_as_declared() {
    let mut scenario = ideal(2.0);
    scenario.sensors = SensorSpec::of(&scenario.motor);
    scenario
        .sensors
        .instrument
        .noise_sigma_fraction_of_full_scale = 0.002;
    let samples = run(&scenario);
    let step = 2.0 / 4096.0;
    let sigma = (0.002_f64.powi(2) + step * step / 12.0).sqrt();
    let own = scenario.sensors.instrument;
    for k in 0..3 {
        let i = samples
            .iter()
            .map(|s| s.measured.i_s_abc[k] - s.truth.i_s_abc[k]);
        let u = samples
            .iter()
            .map(|s| s.measured.u_s_abc[k] - s.truth.u_s_abc[k]);
        assert!((rms(i) / (sigma * own.current_full_scale_amp) - 1.0).abs() < 0.03);
        assert!((rms(u) / (sigma * own.voltage_full_scale_volt) - 1.0).abs() < 0.03);
    }
    let amp = own.amp_per_code();
    for sample in &samples {
        let codes = sample.measured.i_s_abc[0] / amp;
        assert!((codes - codes.round()).abs() < 1e-9, "between two codes");
    }
}

/// The board's converter turns the simulated codes into the simulated values, calibration included.
#[test]
fn codes_and_values_agree_with_the_boards_converter() {
    let mut scenario = ideal(0.05);
    scenario.motor.sensors.voltage_gain = [1.0, 1.02, 0.97];
    scenario.motor.sensors.current_offset_amp = [0.2, 0.0, -0.3];
    scenario.sensors = SensorSpec::of(&scenario.motor);
    let config = monitor::MonitorConfig::from_motor_file(&scenario.motor, 1e-4).expect("shipped");
    let converter: Converter = config.converter;
    for sample in run(&scenario) {
        let shown = sample.measured;
        let converted = converter.convert(&RawSample {
            voltage_codes: shown.voltage_codes,
            current_codes: shown.current_codes,
            encoder_count: shown.encoder_count,
            ..RawSample::default()
        });
        let (u, i) = (
            converted.u_s_abc.expect("there"),
            converted.i_s_abc.expect("there"),
        );
        // Single precision of 400 V and 15 A.
        assert!((f64::from(u.b) - shown.u_s_abc[1]).abs() < 1e-4);
        assert!((f64::from(i.a) - shown.i_s_abc[0]).abs() < 4e-6);
        // Half a code, corrected by the gain.
        assert!((shown.u_s_abc[1] - sample.truth.u_s_abc[1]).abs() < 0.52 * 800.0 / 4096.0);
        assert!((shown.i_s_abc[2] - sample.truth.i_s_abc[2]).abs() < 0.51 * 30.0 / 4096.0);
    }
}

#[test]
fn single_sensors_fail_alone_and_in_time() {
    let scenario = Scenario::read(folder().join("sensor-faults.toml")).expect("shipped");
    let mut ideal = scenario.clone();
    ideal.sensors = ideal.sensors.ideal();
    for sample in run(&ideal) {
        let (shown, truth) = (sample.measured, sample.truth);
        let expected = match sample.t {
            t if (2.0..3.5).contains(&t) => [0.0, truth.i_s_abc[1], truth.i_s_abc[2]],
            t if (8.0..9.5).contains(&t) => {
                [truth.i_s_abc[0], truth.i_s_abc[1], truth.i_s_abc[2] + 0.3]
            }
            _ => truth.i_s_abc,
        };
        let gain = if (5.0..6.5).contains(&sample.t) {
            0.9
        } else {
            1.0
        };
        for (k, expected) in expected.into_iter().enumerate() {
            assert!((shown.i_s_abc[k] - expected).abs() < 1e-12);
            let u = truth.u_s_abc[k] * if k == 1 { gain } else { 1.0 };
            assert!((shown.u_s_abc[k] - u).abs() < 1e-10);
        }
    }
}

#[test]
fn the_encoder_counts_the_shafts_turns() {
    let scenario = parse("start = \"running\"\nduration_s = 1.0\n[sensors]\nspeed = \"encoder\"");
    let samples = run(&scenario);
    let (first, last) = (samples[0], samples[10_000]);
    let turns = (last.truth.theta_mech - first.truth.theta_mech) / TAU;
    let counts = (turns * 4096.0).floor() as i64;
    assert_eq!(last.measured.encoder_count, counts as u16);
    // One count in 10 ms.
    let resolution = TAU / 4096.0 / 0.01;
    assert!((last.measured.omega_mech - last.truth.omega_mech).abs() <= resolution);
    let dead = run(&faulty(&scenario, "speed", -100.0, Frame::Voltage));
    assert_eq!(dead[10_000].measured.encoder_count, 0);
    assert_eq!(dead[10_000].truth, last.truth);
}

#[test]
fn supply_steps_keep_the_phase_and_hit_their_values() {
    let scenario = Scenario::read(folder().join("supply-steps.toml")).expect("shipped");
    let samples = run(&scenario);
    let amplitude = |t: f64| clarke(samples[(t * 1e4) as usize].truth.u_s_abc).norm();
    let rated = 400.0 * (2.0_f64 / 3.0).sqrt();
    for (t, share) in [
        (0.5, 1.0),
        (1.0, 0.8),
        (1.9999, 0.8),
        (2.5, 1.1),
        (3.25, 1.0),
        (4.0, 0.9),
    ] {
        assert!((amplitude(t) / (share * rated) - 1.0).abs() < 1e-12, "{t}");
    }
    let fastest = TAU * 50.0 * 1e-4;
    for pair in samples.windows(2) {
        let turned = clarke(pair[1].truth.u_s_abc) / clarke(pair[0].truth.u_s_abc);
        let expected = if pair[0].t >= 3.5 {
            0.9 * fastest
        } else {
            fastest
        };
        let slack = if (3.0..3.5).contains(&pair[0].t) {
            0.11 * fastest
        } else {
            1e-9
        };
        assert!((turned.arg() - expected).abs() < slack, "{}", pair[0].t);
    }
}

#[test]
fn unbalance_and_harmonics_have_their_size() {
    let scenario = Scenario::read(folder().join("unbalanced-supply.toml")).expect("shipped");
    let samples = run(&Scenario {
        duration_s: 1.0,
        ..scenario
    });
    // A second holds 60 whole periods: the sums are exact projections.
    let component = |order: f64| {
        let turned = samples[..10_000].iter().map(|s| {
            let back = Complex64::from_polar(1.0, -order * TAU * 60.0 * s.t);
            clarke(s.truth.u_s_abc) * back
        });
        turned.sum::<Complex64>() / 10_000.0
    };
    let fundamental = component(1.0);
    assert!((fundamental.norm() - 179.629).abs() < 1e-3);
    for (order, share, angle_deg) in [(-1.0, 0.02, 30.0_f64), (-5.0, 0.04, 0.0), (7.0, 0.02, 0.0)] {
        let expected = Complex64::from_polar(share, angle_deg.to_radians());
        assert!(
            (component(order) / fundamental.norm() - expected).norm() < 1e-9,
            "{order}"
        );
    }
}

#[test]
fn the_published_experiment_runs_side_by_side() {
    let scenario = Scenario::read(folder().join("paper-experiment.toml")).expect("shipped");
    let pairs: Vec<_> = SideBySide::new(&scenario).expect("runs").collect();
    // From 0.5 s to 5.0 s every 20 ms, both ends included.
    assert_eq!(pairs.len(), 226);
    for pair in &pairs {
        assert!((pair.faulty.t / 0.02 - (pair.faulty.t / 0.02).round()).abs() < 1e-9);
        let present = (2.0..3.5).contains(&pair.faulty.t);
        assert_eq!((pair.healthy.faulty, pair.faulty.faulty), (false, present));
        if pair.faulty.t <= 2.0 {
            assert_eq!(pair.healthy.measured, pair.faulty.measured);
        }
    }
    let settled = pairs
        .iter()
        .find(|pair| pair.faulty.t > 3.4)
        .expect("there");
    let slower = settled.healthy.truth.omega_mech - settled.faulty.truth.omega_mech;
    assert!(
        slower > 0.1,
        "a higher stator resistance costs speed: {slower}"
    );
}

#[test]
fn effects_act_inside_the_motor() {
    let text = "start = \"standstill\"\nduration_s = 2.0\n";
    let plain = run(&parse(text));
    let windage = "[[effects]]\nname = \"windage\"\nwindage_nm_s2 = 1e-5\n";
    let loaded = run(&parse(&format!("{text}{windage}")));
    let (a, b) = (plain[20_000].truth, loaded[20_000].truth);
    assert!(
        a.omega_mech - b.omega_mech > 0.5,
        "{} {}",
        a.omega_mech,
        b.omega_mech
    );
    let extra = b.tau_em - b.tau_load - 0.0008 * b.omega_mech;
    assert!(
        (extra / (1e-5 * b.omega_mech.powi(2)) - 1.0).abs() < 1e-3,
        "{extra}"
    );
}

#[test]
fn a_load_beyond_breakdown_cannot_be_running() {
    let scenario = parse("start = \"running\"\nduration_s = 1\n[load]\nconstant_percent = 400");
    let error = Simulation::new(&scenario)
        .expect_err("too much")
        .to_string();
    assert!(error.contains("start = \"standstill\""), "{error}");
}

#[test]
fn a_passive_load_holds_a_shaft_without_chattering() {
    let scenario =
        parse("duration_s = 0.5\n[supply]\nswitch_on_s = 0.2\n[load]\nconstant_percent = 600");
    for sample in run(&scenario) {
        let omega = sample.truth.omega_mech;
        assert!(sample.t > 0.2 || omega == 0.0);
        // Ten newton metres against a peak of six: the shaft yields within the band of standstill.
        assert!(omega.abs() < 0.1, "{omega} at {}", sample.t);
    }
}

#[test]
fn a_recording_reads_back_as_it_was_written() {
    let scenario = Scenario::read(folder().join("direct-on-line-start.toml")).expect("shipped");
    let scenario = Scenario {
        duration_s: 0.3,
        ..scenario
    };
    let written = record(&scenario, |_| {}).expect("records");
    let path = std::env::temp_dir().join(format!("simulated-{}.csv.gz", std::process::id()));
    formats::write_recording(&path, &written).expect("written");
    let read =
        read_recording(&path, &recording::Mapping::default(), &mut |_| {}).expect("readable");
    assert_eq!(read.metadata, written.metadata);
    for channel in [
        Channel::VOLTAGES[0],
        Channel::CURRENTS[2],
        Channel::SPEED,
        Channel::TORQUE,
    ] {
        assert_eq!(read.channel(channel), written.channel(channel));
    }
    assert_eq!(read.t(), written.t());
    std::fs::remove_file(&path).expect("removed");
    std::fs::remove_file(recording::sidecar_path(&path)).expect("removed");
}

/// Counts are a difference over 10 ms: of a motor that runs there is one from the first sample on, also behind a fault of the speed.
#[test]
fn an_encoder_shows_the_speed_of_a_running_motor_at_once() {
    let motor = Scenario::read(folder().join("unbalanced-supply.toml"))
        .expect("shipped")
        .motor;
    let mut scenario = Scenario::of(motor, 0.02);
    scenario.sensors.speed = crate::SpeedSensor::Encoder;
    let pulses = f64::from(scenario.sensors.instrument.encoder_pulses_per_revolution);
    // Two ends of 10 ms, a count at each.
    let resolved = 2.0 * TAU / (4.0 * pulses) / 0.01;
    let half = faulty(&scenario, "wr", -50.0, Frame::Voltage);
    for (scenario, gain) in [(&scenario, 1.0), (&half, 0.5)] {
        for sample in run(scenario) {
            let expected = gain * sample.truth.omega_mech;
            let shown = sample.measured.omega_mech;
            assert!(
                (shown - expected).abs() <= resolved,
                "{}: {shown} {expected}",
                sample.t
            );
        }
    }
}
