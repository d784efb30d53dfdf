//! Units other than the declared ones, and line voltages taken for phase voltages.

use crate::context::Context;
use crate::finding::{Code, Finding, digits, names};
use crate::measure::blocks::Block;
use crate::measure::statistics::{median, quantile};
use recording::Channel;
use std::f64::consts::TAU;
use std::ops::Range;

/// Measured over rated phase voltage when line voltages were taken for phase voltages: 1.73 times a
/// supply of 80 to 120 %.
const LINE_RATIO: Range<f64> = 1.4..2.1;
/// Measured over rated amplitude beyond which a voltage or current has another unit.
const FAR: f64 = 50.0;
/// Measured over rated torque beyond which it has another unit.
const FAR_TORQUE: f64 = 30.0;
/// A speed over synchronous speed, divided by a unit's factor, of a motor that runs.
const RUNNING: Range<f64> = 0.85..1.06;

pub(crate) fn check(context: &mut Context<'_>) -> Vec<Finding> {
    let found = [
        voltage(context),
        current(context),
        speed(context),
        torque(context),
        clock(context),
    ];
    found.into_iter().flatten().collect()
}

/// Measured over rated amplitude, times the factor of a unit, that a running motor can have.
const PLAUSIBLE: Range<f64> = 0.1..10.0;

/// Ratio of an amplitude to a rated one, in words of a unit: the factor's decimal prefix.
fn prefix(ratio: f64, unit: &str) -> String {
    if ratio > 1.0 {
        format!("m{unit}")
    } else {
        format!("k{unit}")
    }
}

fn far(ratio: f64, far: f64) -> bool {
    ratio > far || (ratio > 0.0 && ratio < 1.0 / far)
}

fn voltage(context: &Context<'_>) -> Option<Finding> {
    let rated = context.expectation.voltage_amplitude()?;
    let settled = context
        .sound(Channel::VOLTAGES)
        .then(|| context.settled(Channel::VOLTAGES))?;
    let ratio = median(settled.iter().map(|(_, three)| three.amplitude()))? / rated;
    if LINE_RATIO.contains(&ratio) {
        return Some(line_voltages(ratio));
    }
    far(ratio, FAR).then(|| {
        wrong(
            &Channel::VOLTAGES,
            ratio,
            &prefix(ratio, "V"),
            "rated voltage",
        )
    })
}

fn line_voltages(ratio: f64) -> Finding {
    Finding::new(Code::LineVoltages, names(&Channel::VOLTAGES), ratio, "x rated phase voltage")
        .detail(format!(
            "va vb vc are {ratio:.2} times the rated phase voltage: they are line voltages (1.73). Add \
             --line-voltages, or name the columns vab vbc vca. (If they are phase voltages, the nameplate's \
             line voltage is too low.)"
        ))
        .refusing()
}

fn current(context: &Context<'_>) -> Option<Finding> {
    let rated = context.expectation.current_amplitude()?;
    let settled = context
        .sound(Channel::CURRENTS)
        .then(|| context.settled(Channel::CURRENTS))?;
    let ratio = median(settled.iter().map(|(_, three)| three.amplitude()))? / rated;
    far(ratio, FAR).then(|| {
        wrong(
            &Channel::CURRENTS,
            ratio,
            &prefix(ratio, "A"),
            "rated current",
        )
    })
}

/// A ratio far from 1 in the decimal unit that is nearer.
pub(crate) fn in_its_unit(ratio: f64) -> f64 {
    match ratio > 1.0 {
        true => 1e-3 * ratio,
        false => 1e3 * ratio,
    }
}

fn wrong(channels: &[Channel], ratio: f64, unit: &str, rated: &str) -> Finding {
    let flags: Vec<String> = channels
        .iter()
        .map(|channel| format!("--unit {channel}={unit}"))
        .collect();
    let scaled = in_its_unit(ratio);
    // A unit that the nameplate contradicts is not proposed.
    let remedy = match PLAUSIBLE.contains(&scaled) || channels == [Channel::TORQUE] {
        true => format!(
            "the unit is probably {unit} (then {} times). Add {}.",
            digits(scaled, 2),
            flags.join(" ")
        ),
        false => "no decimal unit makes it fit. Look at the scale of the sensor (--sensor) and at the nameplate.".to_owned(),
    };
    Finding::new(Code::Unit, names(channels), ratio, "x")
        .detail(format!(
            "{} {} {} times the {rated}: {remedy}",
            names(channels),
            if channels.len() == 1 { "is" } else { "are" },
            digits(ratio, 3)
        ))
        .refusing()
}

/// Speed over synchronous speed, and the units that would make a running motor's of it.
fn speed(context: &Context<'_>) -> Option<Finding> {
    let ratio = relative_speed(context)?;
    let units = [
        ("rpm", 60.0 / TAU),
        ("rev/s", 1.0 / TAU),
        ("deg/s", 360.0 / TAU),
    ];
    let (unit, factor) = units
        .into_iter()
        .find(|(_, factor)| RUNNING.contains(&(ratio / factor)))?;
    Some(
        Finding::new(Code::Unit, Channel::SPEED, factor, "x")
            .detail(format!(
                "speed is {ratio:.3} times the synchronous speed, as if it were in {unit}: add --unit speed={unit}."
            ))
            .refusing(),
    )
}

/// Median speed over synchronous speed while the motor certainly runs: steadily, at a good part of
/// its flux, without the current of a blocked rotor; `None` if that is never certain.
pub(crate) fn relative_speed(context: &Context<'_>) -> Option<f64> {
    let pole_pairs = f64::from(context.expectation.pole_pairs?);
    let running = context
        .blocks
        .iter()
        .filter(|block| block.steady && runs(context, block));
    median(running.filter_map(|block| Some(block.speed?.abs() * pole_pairs / block.omega)))
}

/// Half the rated flux at less than 1.5 times the rated current: not a blocked rotor.
pub(crate) fn runs(context: &Context<'_>, block: &Block) -> bool {
    const FLUX: f64 = 0.5;
    const CURRENT: f64 = 1.5;
    let known = || {
        let flux = context.expectation.voltage_amplitude()? / context.expectation.omega()?;
        let voltage = block.voltages.as_ref()?.amplitude() / block.omega;
        let current = block.currents.as_ref()?.amplitude();
        Some(voltage > FLUX * flux && current < CURRENT * context.expectation.current_amplitude()?)
    };
    known().unwrap_or(false)
}

fn torque(context: &Context<'_>) -> Option<Finding> {
    let rated = context.expectation.torque_nm?;
    let torque = context.recording.torque()?;
    let ratio = quantile(torque.iter().map(|x| x.abs()), 0.99)? / rated;
    (ratio > FAR_TORQUE).then(|| wrong(&[Channel::TORQUE], ratio, "mNm", "rated torque"))
}

/// A supply far from the rated frequency: the clock counts something else.
fn clock(context: &Context<'_>) -> Option<Finding> {
    let ratio = context.omega()? / context.expectation.omega()?;
    let unit = [("ms", 1e-3), ("us", 1e-6)];
    let (unit, factor) = unit
        .into_iter()
        .find(|(_, factor)| (0.5..2.0).contains(&(ratio / factor)))?;
    Some(
        Finding::new(Code::Unit, "t", factor, "x")
            .detail(format!("The supply has {} times the rated frequency: t is probably in {unit}; add --unit t={unit}.", digits(ratio, 3)))
            .refusing(),
    )
}
