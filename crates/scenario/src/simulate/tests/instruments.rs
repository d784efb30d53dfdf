//! Effects on the instruments change what is recorded, and only that.

use crate::Scenario;
use crate::simulate::{Simulation, record};
use crate::tests::parse;
use recording::{Channel, Recording};

/// The assumed motor, running, with perfect instruments and these effects.
fn scenario(effects: &str) -> Scenario {
    let text = format!(
        "start = \"running\"\nduration_s = 0.1\n[sensors]\nspeed = \"tachometer\"\n{effects}"
    );
    let mut scenario = parse(&text);
    scenario.sensors = scenario.sensors.ideal();
    scenario
}

fn effect(name: &str, numbers: &str) -> Recording {
    let text = format!("[[effects]]\nname = \"{name}\"\n{numbers}\n");
    record(&scenario(&text), |_| ()).expect("recorded")
}

/// Largest difference between a channel and what is expected of it from the plain recording.
fn off(shown: &Recording, channel: Channel, expected: impl Fn(&[f64], usize) -> f64) -> f64 {
    let plain = record(&scenario(""), |_| ()).expect("recorded");
    let (x, y) = (plain.channel(channel), shown.channel(channel));
    let (x, y) = (x.expect("there"), y.expect("there"));
    // The ends of a delayed signal are not known.
    let rows = 10..x.len() - 10;
    rows.map(|k| (expected(x, k) - y[k]).abs())
        .fold(0.0, f64::max)
}

/// Rounding of values of some hundred.
const ROUNDING: f64 = 1e-9;

#[test]
fn gains_and_offsets_show_in_their_channels_alone() {
    let [_, _, vc] = Channel::VOLTAGES;
    let [ia, ..] = Channel::CURRENTS;
    let gains = "voltage_gain_a = 1.0\nvoltage_gain_b = 1.0\nvoltage_gain_c = 1.05";
    let wrong = effect("phase-voltage-gain", gains);
    assert!(off(&wrong, vc, |x, k| 1.05 * x[k]) < ROUNDING);
    assert!(off(&wrong, Channel::VOLTAGES[0], |x, k| x[k]) < ROUNDING);
    assert!(off(&wrong, ia, |x, k| x[k]) < ROUNDING);
    let wrong = effect("current-gain", "current_gain = 1.02");
    assert!(off(&wrong, ia, |x, k| 1.02 * x[k]) < ROUNDING);
    assert!(off(&wrong, vc, |x, k| x[k]) < ROUNDING);
    let wrong = effect("speed-scale", "speed_scale = 0.99");
    assert!(off(&wrong, Channel::SPEED, |x, k| 0.99 * x[k]) < ROUNDING);
}

#[test]
fn a_delay_of_whole_samples_shifts_the_currents() {
    let wrong = effect("sample-delay", "delay_s = 2e-4");
    for channel in Channel::CURRENTS {
        assert!(off(&wrong, channel, |x, k| x[k - 2]) < ROUNDING);
    }
    assert!(off(&wrong, Channel::VOLTAGES[0], |x, k| x[k]) < ROUNDING);
}

#[test]
fn what_cannot_be_shown_is_refused_with_the_reason() {
    let mut encoder = scenario("[[effects]]\nname = \"speed-scale\"\nspeed_scale = 0.99\n");
    assert!(
        Simulation::new(&encoder)
            .expect_err("streams")
            .to_string()
            .contains("instruments")
    );
    encoder.sensors.speed = crate::SpeedSensor::Encoder;
    let error = record(&encoder, |_| ()).expect_err("an encoder");
    assert!(error.to_string().contains("tachometer"), "{error}");
}
