//! Channels that look like the volts of a sensor: proposed with the evidence, never applied.

use crate::context::Context;
use crate::finding::{Code, Finding, digits, names};
use crate::measure::statistics::median;
use recording::{Channel, Quantity, Target};

/// Current clamps that are sold, with the amperes of a volt.
const CLAMPS: [(&str, f64); 6] = [
    ("1V/A", 1.0),
    ("100mV/A", 10.0),
    ("50mV/A", 20.0),
    ("10mV/A", 100.0),
    ("5mV/A", 200.0),
    ("1mV/A", 1000.0),
];
/// Dividers and differential probes, with the volts of a volt.
const DIVIDERS: [(&str, f64); 7] = [
    ("10:1", 10.0),
    ("20:1", 20.0),
    ("50:1", 50.0),
    ("100:1", 100.0),
    ("200:1", 200.0),
    ("500:1", 500.0),
    ("1000:1", 1000.0),
];
/// Measured over rated current that a running motor does not fall below: its magnetizing current is larger.
const NO_LOAD: f64 = 0.15;
/// Measured over rated current of a motor in steady running, as the nameplate allows.
const CURRENTS: std::ops::RangeInclusive<f64> = 0.2..=1.3;
/// Measured over rated voltage of a supply.
const VOLTAGES: std::ops::RangeInclusive<f64> = 0.85..=1.15;

/// Proposes sensors of the currents and the voltages.
pub(crate) fn check(context: &Context<'_>) -> Vec<Finding> {
    let current = context.expectation.current_amplitude();
    let voltage = context.expectation.voltage_amplitude();
    let clamps = current.and_then(|rated| {
        let ratio = ratio(context, Channel::CURRENTS, rated)?;
        let fits = fitting(&CLAMPS, ratio, CURRENTS);
        (ratio < NO_LOAD).then(|| proposal(Channel::CURRENTS, ratio, &fits, "i"))?
    });
    let dividers = voltage.and_then(|rated| {
        let ratio = ratio(context, Channel::VOLTAGES, rated)?;
        proposal(
            Channel::VOLTAGES,
            ratio,
            &fitting(&DIVIDERS, ratio, VOLTAGES),
            "v",
        )
    });
    clamps.into_iter().chain(dividers).collect()
}

/// Whether channels, named as in a finding, usually have this ratio to the rated amplitude.
pub(crate) fn is_usual(channels: &str, ratio: f64) -> bool {
    match channels == names(&Channel::VOLTAGES) {
        true => VOLTAGES.contains(&ratio),
        false => CURRENTS.contains(&ratio),
    }
}

/// Measured over rated amplitude of three channels that are sound and have no sensor yet.
fn ratio(context: &Context<'_>, three: [Channel; 3], rated: f64) -> Option<f64> {
    let reading = &context.recording.reading;
    let has_sensor = |channel: Channel| {
        let map = reading.columns.get(&Target::Channel(channel));
        map.is_some_and(|map| map.sensor.is_some())
    };
    if !context.sound(three) || three.into_iter().any(has_sensor) {
        return None;
    }
    let settled = context.settled(three);
    median(settled.iter().map(|(_, three)| three.amplitude())).map(|amplitude| amplitude / rated)
}

/// The sensors that the nameplate does not contradict.
fn fitting(
    sensors: &[(&'static str, f64)],
    ratio: f64,
    allowed: std::ops::RangeInclusive<f64>,
) -> Vec<(&'static str, f64)> {
    let scaled = sensors.iter().map(|(name, factor)| (*name, ratio * factor));
    scaled
        .filter(|(_, ratio)| allowed.contains(ratio))
        .filter(|_| !allowed.contains(&ratio))
        .collect()
}

fn proposal(
    three: [Channel; 3],
    ratio: f64,
    fits: &[(&'static str, f64)],
    all: &str,
) -> Option<Finding> {
    let (first, _) = fits.first()?;
    let what = if three[0].quantity() == Quantity::Current {
        "clamp"
    } else {
        "probe"
    };
    let each: Vec<String> = fits
        .iter()
        .map(|(name, x)| format!("a {what} of {name} (then {x:.2} times)"))
        .collect();
    let flag = format!("--sensor {all}={first}");
    let detail = format!(
        "{} are {} times the rated amplitude: they look like the output of {}. Nothing was changed; where the plate \
         of the sensor says so, add {flag}.",
        names(&three),
        digits(ratio, 3),
        each.join(" or ")
    );
    Some(Finding::new(Code::SensorScale, names(&three), ratio, "x").detail(detail))
}
