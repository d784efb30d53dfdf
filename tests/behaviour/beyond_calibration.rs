//! A motor whose iron saturates, calibrated at one voltage by a file that does not know it, in good order at other voltages and loads.

use crate::common::{in_project, monitored, motor};
use motor::MotorFile;
use recording::Recording;
use replay::VerdictState;
use replay::calibrate::{Surroundings, calibrate};
use scenario::simulate::record;
use scenario::{LoadSpec, Piecewise, Scenario, Start};

/// Of the rated voltage and torque; percent.
fn recorded(volt: f64, load: f64, fault: &str, seed: u32) -> Recording {
    let text = format!(
        "motor = \"motors/peer-2k2-saturating.toml\"\nduration_s = 1.6\nstart = \"running\"\nseed = {seed}\nsample_rate_hz = 5000\n\
         [supply]\nvoltage_line_rms_volt = {:?}\n[load]\nconstant_percent = {load:?}\nfriction_percent = 0\nactive = true\n\
         [sensors]\nnoise_sigma_fraction_of_full_scale = 0.001\ntorque = true\n{fault}",
        4.0 * volt
    );
    let scenario = Scenario::parse(&text, "saturating.toml", &in_project(".")).expect("valid");
    record(&scenario, |_| ()).expect("a motor that runs")
}

fn calibrated() -> MotorFile {
    let loads = [(10.0, 1), (50.0, 2), (100.0, 3)];
    let recordings = loads.map(|(load, seed)| recorded(100.0, load, "", seed));
    let calibrated = calibrate(
        &motor("motors/peer-2k2.toml"),
        &recordings,
        &Surroundings::default(),
    );
    calibrated.expect("healthy").motor
}

/// Voltage and load beyond those of the calibration, percent.
const BEYOND: [(f64, f64); 8] = [
    (95.0, 80.0),
    (105.0, 80.0),
    (90.0, 50.0),
    (110.0, 50.0),
    (100.0, 150.0),
    (108.0, 10.0),
    (100.0, -60.0),
    (105.0, -100.0),
];

#[test]
fn a_healthy_motor_is_healthy_where_its_calibration_saw_nothing_and_that_is_told() {
    let motor = calibrated();
    let range = motor.healthy.and_then(|healthy| healthy.range);
    let range = range.expect("voltages and speed were recorded");
    // Noise of 0.1 % of full scale in some hundred samples a window.
    let near = |x: f64, y: f64| assert!((x - y).abs() < 0.2, "{x} {y}");
    for end in [range.volt_per_hertz_percent, range.frequency_percent].concat() {
        near(end, 100.0);
    }
    for (k, (volt, load)) in BEYOND.into_iter().enumerate() {
        let (_, timeline) = monitored(&recorded(volt, load, "", 10 + k as u32), &motor);
        let verdict = timeline.verdict(&[]);
        assert_eq!(verdict.state, VerdictState::Healthy, "{volt} {load}");
        assert_eq!(timeline.beyond.windows, timeline.judged, "{volt} {load}");
        if volt != 100.0 {
            // The farthest of some hundred windows: noise as above, and the calibration's own.
            let off = (volt - 100.0).abs();
            assert!((timeline.beyond.volt_per_hertz_percent - off).abs() < 0.3);
        }
    }
    let (_, lowering) = monitored(&recorded(100.0, -60.0, "", 31), &motor);
    let fed_back = lowering.beyond.fed_back_percent;
    assert!((30.0..60.0).contains(&fed_back), "{:?}", lowering.beyond);
    let (_, within) = monitored(&recorded(100.0, 80.0, "", 30), &motor);
    assert_eq!(within.beyond.windows, 0, "{:?}", within.beyond);
}

/// What the range is for: the same motor file without it accuses a sensor.
#[test]
fn without_its_range_the_same_calibration_lights_fault() {
    let mut motor = calibrated();
    if let Some(healthy) = &mut motor.healthy {
        healthy.range = None;
    }
    let (_, timeline) = monitored(&recorded(108.0, 10.0, "", 15), &motor);
    assert_eq!(timeline.verdict(&[]).state, VerdictState::Fault);
}

/// A drive's start, faster than the oscillator follows: what it shows meanwhile is no dead sensor.
#[test]
fn a_ramp_that_the_oscillator_loses_is_no_fault() {
    let motor = motor("motors/assumed-300w-calibrated.toml");
    let plate = &motor.nameplate;
    for seed in 0_u32..40 {
        let phase_rad = 0.157 * f64::from(seed);
        let mut scenario = Scenario::of(motor.clone(), 2.7);
        let (volt, hertz) = (plate.phase_voltage_amplitude(), plate.frequency_hz);
        let low = 8.0 / hertz;
        scenario.supply.amplitude_volt = Piecewise::constant(volt * (low + 0.04));
        scenario.supply.frequency_hz = Piecewise::constant(8.0);
        scenario.supply.amplitude_volt.change(0.3, volt, 2.0);
        scenario.supply.frequency_hz.change(0.3, hertz, 2.0);
        scenario.supply.phase_rad = phase_rad;
        scenario.start = Start::Standstill;
        scenario.seed = u64::from(seed);
        scenario.sample_rate_hz = 5000.0;
        scenario.supply.switch_on_s = 0.1;
        scenario.load = LoadSpec::constant(0.45 * plate.torque_nm, false);
        let recording = record(&scenario, |_| ()).expect("a motor that starts");
        let (_, timeline) = monitored(&recording, &motor);
        let verdict = timeline.verdict(&[]);
        assert_ne!(
            verdict.state,
            VerdictState::Fault,
            "{phase_rad} rad: {verdict:?}"
        );
    }
}

/// Single channels and phases, and all voltage channels: a voltage that is only shown too low is no lower flux.
#[test]
fn faults_are_found_there_as_well() {
    let motor = calibrated();
    let all_voltages: String = ["va", "vb", "vc"]
        .map(|channel| gain(channel, 0.92))
        .concat();
    for fault in [gain("ia", 1.03), gain("vb", 1.05), all_voltages] {
        let (_, timeline) = monitored(&recorded(105.0, 80.0, &fault, 40), &motor);
        let verdict = timeline.verdict(&[]);
        assert_eq!(verdict.state, VerdictState::Fault, "{fault}");
    }
}

fn gain(channel: &str, gain: f64) -> String {
    format!("[[faults]]\nfault = \"{channel}\"\ngain = {gain:?}\n")
}
