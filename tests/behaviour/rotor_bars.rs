//! Broken rotor bars: found by the sidebands of the current, and told from a load that swings.

use std::f64::consts::TAU;

use crate::common::{in_project, motor};
use monitor::{Cage, Lamp, Monitor, MonitorConfig, MonitorState, RawSample, Report, Sidebands};
use motor::dynamic::clarke;
use motor::motor_file::{EffectEntry, Frame};
use num_complex::Complex64;
use scenario::simulate::{SimSample, Simulation};
use scenario::{Fault, Scenario};

const MOTOR: &str = "motors/peer-2k2.toml";
/// Pole pairs and supply frequency of it.
const N_P: f64 = 2.0;
const HZ: f64 = 50.0;

/// The shipped scenario with another asymmetry of the cage, percent; 0 is a whole cage.
fn scenario(bars_percent: f64) -> Scenario {
    let path = in_project("sim-host/scenarios/broken-bars.toml");
    let mut scenario = Scenario::read(path).expect("it is shipped");
    let bars = |percent| Fault::percent("bars", percent, Frame::RotorFlux).expect("known");
    scenario.faults = Vec::from_iter((bars_percent > 0.0).then(|| bars(bars_percent)));
    scenario
}

/// Samples, and what a monitor that knows nothing of bars in its motor file says about them.
fn run(scenario: &Scenario) -> (Vec<SimSample>, Vec<Report>) {
    let config =
        MonitorConfig::from_motor_file(&motor(MOTOR), scenario.t_sample()).expect("shipped");
    let monitor = Monitor::new(config).expect("valid");
    let mut state = MonitorState::default();
    let samples: Vec<SimSample> = Simulation::new(scenario).expect("the motor runs").collect();
    let raw = samples.iter().map(|sample| RawSample {
        voltage_codes: sample.measured.voltage_codes,
        current_codes: sample.measured.current_codes,
        encoder_count: sample.measured.encoder_count,
        ..RawSample::default()
    });
    let reports = raw
        .filter_map(|raw| monitor.update_raw(&mut state, &raw))
        .collect();
    (samples, reports)
}

fn normalised(block: &Sidebands) -> f32 {
    Cage::UNKNOWN.limits(1.0, N_P as f32).normalised(block)
}

fn counts(block: &Sidebands) -> bool {
    normalised(block) >= 1.0
}

fn blocks(reports: &[Report]) -> Vec<Sidebands> {
    reports
        .iter()
        .filter_map(|report| report.rotor.sidebands)
        .collect()
}

/// Amplitude of the true current vector that turns at `hz`, over the last five seconds under a Hann window: sidebands
/// stand three hertz from the fundamental, fifteen of its bins.
fn component(
    samples: &[SimSample],
    vector: impl Fn(&SimSample) -> Complex64,
    hz: f64,
) -> Complex64 {
    let last = &samples[samples.len() - 50_000..];
    let weight = |k: usize| 1.0 - (TAU * k as f64 / last.len() as f64).cos();
    let turned =
        |(k, sample)| vector(sample) * Complex64::from_polar(weight(k), -TAU * hz * sample.t);
    last.iter().enumerate().map(turned).sum::<Complex64>() / last.len() as f64
}

/// The same from the spectrum of the true current, without the monitor: share of the active current at `(1 - 2 s) f`.
fn share_in_the_spectrum(samples: &[SimSample]) -> f64 {
    let last = &samples[samples.len() - 50_000..];
    let omega_mech = last
        .iter()
        .map(|sample| sample.truth.omega_mech)
        .sum::<f64>()
        / last.len() as f64;
    let slip = 1.0 - omega_mech * N_P / (TAU * HZ);
    let current = |sample: &SimSample| clarke(sample.truth.i_s_abc);
    let voltage = |sample: &SimSample| clarke(sample.truth.u_s_abc);
    let u = component(samples, voltage, HZ);
    let active = (component(samples, current, HZ) * u.conj() / u.norm()).re;
    component(samples, current, (1.0 - 2.0 * slip) * HZ).norm() / active
}

/// Three parts in a hundred: the last step of a block, up to 0.6 of 25 rad too far, lets two parts of the other sideband in.
#[test]
fn the_sideband_is_that_of_the_spectrum_and_lights_fault() {
    for percent in [5.0, 10.0] {
        let (samples, reports) = run(&scenario(percent));
        let truth = share_in_the_spectrum(&samples);
        let found = blocks(&reports);
        let last = found.last().expect("blocks");
        println!(
            "{percent} %: {:.3} % measured, {:.3} % in the spectrum",
            100.0 * last.lower,
            100.0 * truth
        );
        assert!(
            (f64::from(last.lower) / truth - 1.0).abs() < 0.03,
            "{last:?} {truth}"
        );
        assert!(last.may_be_bars());
        let end = reports.last().expect("reports");
        assert!(end.rotor.is_broken && end.lamps.fault == Lamp::On);
    }
}

#[test]
fn a_whole_cage_has_no_sidebands_and_an_unloaded_one_is_not_tested() {
    let (_, reports) = run(&scenario(0.0));
    let found = blocks(&reports);
    let (first, others) = found.split_first().expect("blocks");
    assert!(normalised(first) < 0.5, "the load step: {first:?}");
    for block in others {
        assert!(normalised(block) < 0.1, "{block:?}");
    }
    let mut unloaded = scenario(20.0);
    unloaded.load = Default::default();
    let (_, reports) = run(&unloaded);
    assert_eq!(blocks(&reports), []);
    assert!(reports.iter().all(|report| !report.rotor.is_broken));
}

/// Once a turn of the shaft a seventh of the rated torque: no bars, however much it shakes the current.
#[test]
fn a_load_that_pulsates_with_the_shaft_is_kept_apart() {
    let mut pulsating = scenario(0.0);
    let torque = [("pulsation_cos_nm", 2.0), ("pulsation_sin_nm", 0.0)];
    pulsating.motor.effects = vec![EffectEntry::with_numbers("load-pulsation", torque)];
    let (_, reports) = run(&pulsating);
    assert!(!blocks(&reports).is_empty());
    assert!(reports.iter().all(|report| !report.rotor.is_broken));
    pulsating.faults = scenario(10.0).faults;
    let (_, reports) = run(&pulsating);
    assert!(
        reports.last().expect("reports").rotor.is_broken,
        "bars are found beside it"
    );
}

/// Load steps every 0.7 s for eight seconds: whatever falls into a block, none is taken for bars.
#[test]
fn steps_of_the_load_are_no_bars() {
    let text = r#"
        motor = "peer-2k2.toml"
        duration_s = 8.0
        start = "running"
        [load]
        profile = [PROFILE]
    "#;
    let point = |k: u32| {
        format!(
            "{{ at_s = {:.1}, torque_percent = {} }}",
            0.7 * f64::from(k),
            50 + 60 * (k % 2)
        )
    };
    let profile: Vec<String> = (0..11).map(point).collect();
    let text = text.replace("PROFILE", &profile.join(", "));
    let stepping = Scenario::parse(&text, "steps", &in_project("motors")).expect("valid");
    let (_, reports) = run(&stepping);
    assert!(!blocks(&reports).is_empty());
    for block in blocks(&reports) {
        assert!(!counts(&block), "{block:?}");
    }
}
