//! A supply whose frequency is not the motor's: an inverter, or a sampling rate that is not the recorder's.
//!
//! An inverter keeps the flux, voltage over frequency, or less of it. More than the rated flux at a lower frequency saturates any
//! motor: then the clock is to blame.

use crate::context::Context;
use crate::finding::{Code, Finding, names};
use crate::levels::unit::relative_speed;
use crate::measure::statistics::median;
use recording::{Channel, Supply};
use std::f64::consts::TAU;
use std::ops::Range;

/// Measured over rated frequency of a grid.
const SAME: Range<f64> = 0.95..1.05;
/// Measured over rated frequency beyond which the unit of the clock is another finding's.
const FAR: Range<f64> = 0.05..20.0;
/// Measured over rated flux that an inverter gives.
const FLUX: Range<f64> = 0.85..1.15;
/// Share of the steady blocks that have the same frequency, within so much of it.
const MOST: f64 = 0.9;
const FIXED: f64 = 0.01;
/// Fewest steady blocks.
const FEWEST: usize = 3;
/// Speed over synchronous speed of a motor that runs.
const RUNNING: Range<f64> = 0.75..1.15;

pub(crate) fn check(context: &mut Context<'_>) -> Option<Finding> {
    let rated = context.expectation.omega()?;
    let ratio = fixed(context)? / rated;
    let is_told = context.recording.metadata.supply == Supply::Inverter;
    if is_told || SAME.contains(&ratio) || !FAR.contains(&ratio) {
        return None;
    }
    let flux = voltage(context).map(|volt| volt / ratio);
    if flux.is_some_and(|flux| FLUX.contains(&flux)) {
        return None;
    }
    match flux.filter(|flux| *flux > FLUX.end) {
        Some(flux) => Some(wrong_clock(context, ratio, flux)),
        None => Some(other_supply(context, ratio)),
    }
}

/// The frequency that nearly all steady blocks share, rad/s.
fn fixed(context: &Context<'_>) -> Option<f64> {
    let steady = || context.blocks.iter().filter(|block| block.steady);
    let omega = median(steady().map(|block| block.omega))?;
    let same = steady().filter(|block| (block.omega / omega - 1.0).abs() < FIXED);
    let all = steady().count();
    (all >= FEWEST && same.count() as f64 >= MOST * all as f64).then_some(omega)
}

/// Measured over rated voltage.
fn voltage(context: &Context<'_>) -> Option<f64> {
    let rated = context.expectation.voltage_amplitude()?;
    let sound = context.sound(Channel::VOLTAGES);
    let settled = sound.then(|| context.settled(Channel::VOLTAGES))?;
    Some(median(settled.iter().map(|(_, three)| three.amplitude()))? / rated)
}

/// More flux than a motor takes. A speed that fits the rated frequency is no second mistake, and of no use.
fn wrong_clock(context: &mut Context<'_>, ratio: f64, flux: f64) -> Finding {
    if relative_speed(context).is_some_and(|speed| RUNNING.contains(&(speed * ratio))) {
        context.unsound.insert(Channel::SPEED);
    }
    let [hz, rated, rate] = frequencies(context, ratio);
    let detail = format!(
        "The supply has {hz:.1} Hz, the motor is made for {rated:.0} Hz, and would have {flux:.2} times its rated flux, which no \
         inverter gives it: the sampling rate is probably wrong. With --sample-rate {rate:.0} the supply has {rated:.0} Hz."
    );
    Finding::new(Code::SupplyFrequency, "t", hz, "Hz").detail(detail)
}

fn other_supply(context: &Context<'_>, ratio: f64) -> Finding {
    let [hz, rated, rate] = frequencies(context, ratio);
    let three = match context.sound(Channel::VOLTAGES) {
        true => Channel::VOLTAGES,
        false => Channel::CURRENTS,
    };
    let detail = format!(
        "The supply has {hz:.1} Hz, the motor is made for {rated:.0} Hz: either an inverter feeds it (say supply = \"inverter\" in the \
         sidecar), or the sampling rate is wrong: with --sample-rate {rate:.0} the supply has {rated:.0} Hz."
    );
    Finding::new(Code::SupplyFrequency, names(&three), hz, "Hz").detail(detail)
}

/// Found and rated frequency, and the sampling rate that makes them one, Hz.
fn frequencies(context: &Context<'_>, ratio: f64) -> [f64; 3] {
    let rated = context.expectation.omega().unwrap_or_default() / TAU;
    let rate = 1.0 / (context.recording.t_sample() * ratio);
    // The frequency of a supply is known to four digits.
    let digit = 10_f64.powf(rate.log10().floor() - 2.0).max(1.0);
    [ratio * rated, rated, digit * (rate / digit).round()]
}
