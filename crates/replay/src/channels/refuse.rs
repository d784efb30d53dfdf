//! Recordings that show no such set-up, or not well enough.

use std::f64::consts::PI;

use audit::{Code, Expectation, audit};
use recording::Recording;

use super::combine::{Relative, relative};
use super::{CHANNELS, Found, NAMES, Setup, Sine};
use crate::calibrate::Refusal;

/// Channels that see one signal are within 200 us of 100 Hz of each other: 0.13 rad.
const ONE_SIGNAL_RAD: f64 = 0.15;
/// A third of a turn and half a turn are told from each other.
const CLASS_RAD: f64 = 0.5;
/// Channels of one scale; more is a wrong full scale in the motor file or a divider.
const GAINS: [f64; 2] = [0.9, 1.1];
/// Standard errors that are worth writing down: a tenth of what lights a lamp.
const GAIN_ERROR: f64 = 5e-4;
const DELAY_ERROR_S: f64 = 0.5e-6;
/// Standard errors, and a share, by which two recordings may differ.
const ERRORS: f64 = 5.0;
const DIFFERENCE: f64 = 1e-3;

fn refused(recording: &str, reason: impl Into<String>) -> Refusal {
    Refusal {
        recording: recording.to_owned(),
        reason: reason.into(),
    }
}

/// Refuses what is not one signal on all channels, or is clipped.
pub(super) fn wrong_set_up(recording: &Recording, sine: &Sine) -> Result<(), Refusal> {
    let name = recording.name();
    let audit = audit(recording, &Expectation::default());
    if let Some(clipped) = audit.findings.iter().find(|f| f.code == Code::Clipping) {
        return Err(refused(
            name,
            format!("{}; lower the signal to half of full scale", clipped.detail),
        ));
    }
    let mean = sine.seen_from_the_first();
    for (k, (p, channel)) in mean.iter().zip(NAMES).enumerate() {
        let angle = p.arg();
        let size = p.norm() / mean[k / 3 * 3].norm();
        if !size.is_finite() || size < 0.1 {
            return Err(refused(
                name,
                format!("{channel} does not show the signal: all six channels must see it"),
            ));
        }
        if angle.abs() > ONE_SIGNAL_RAD {
            return Err(refused(name, wrong_angle(k, channel, angle)));
        }
        if !(GAINS[0]..=GAINS[1]).contains(&size) {
            return Err(refused(
                name,
                format!(
                    "{channel} shows {:.1} % of what {} does: more than a channel's tolerance; check its range and its wiring",
                    100.0 * size,
                    NAMES[k / 3 * 3]
                ),
            ));
        }
    }
    Ok(())
}

fn wrong_angle(k: usize, channel: &str, angle: f64) -> String {
    let degrees = angle.to_degrees();
    if (angle.abs() - PI).abs() < CLASS_RAD {
        return format!(
            "{channel} is the other way round ({degrees:.0} degrees): exchange its two wires, or turn its transducer"
        );
    }
    if (angle.abs() - 2.0 * PI / 3.0).abs() < CLASS_RAD {
        return format!(
            "{channel} stands {degrees:.0} degrees from va: these are three phases; lead all voltage inputs to one of them, and its current through all transducers"
        );
    }
    if k >= 3 {
        return format!(
            "{channel} stands {degrees:.1} degrees from the voltage: the load is not resistive; use a heater"
        );
    }
    format!(
        "{channel} stands {degrees:.1} degrees from va: no delay of a channel is as long as that"
    )
}

/// Refuses recordings that do not agree about a gain.
pub(super) fn contradictions(names: &[&str], sines: &[Sine], setup: &Setup) -> Result<(), Refusal> {
    let all: Vec<Relative> = sines.iter().map(|sine| relative(sine, setup)).collect();
    let Some((first, others)) = all.split_first() else {
        return Ok(());
    };
    for (name, other) in names.iter().skip(1).zip(others) {
        let pairs = first.log_gain.iter().zip(&other.log_gain);
        for ((a, b), channel) in pairs.zip(NAMES) {
            let apart = (a.value - b.value).abs();
            if apart > ERRORS * a.error.hypot(b.error) && apart > DIFFERENCE {
                return Err(refused(
                    name,
                    format!(
                        "the gain of {} differs by {:.2} % from that of {}: another set-up, another amplitude or another meter reading",
                        channel,
                        100.0 * apart,
                        names[0]
                    ),
                ));
            }
        }
    }
    Ok(())
}

/// Refuses what would not help a lamp.
pub(super) fn imprecise(names: &[&str], found: &Found) -> Result<(), Refusal> {
    let names = names.join(", ");
    let worst = |of: &[super::Estimate; CHANNELS]| {
        let errors = of.iter().map(|one| one.error);
        let worst = errors.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        worst.unwrap_or_default()
    };
    let (k, gain) = worst(&found.gain);
    if gain.is_nan() || gain > GAIN_ERROR {
        return Err(refused(
            &names,
            format!(
                "the gain of {} is known to {:.3} % only, 0.05 % are needed: record longer, with a signal near half of full scale",
                NAMES[k],
                100.0 * gain
            ),
        ));
    }
    let (k, delay) = worst(&found.delay_s);
    if delay.is_nan() || delay > DELAY_ERROR_S {
        return Err(refused(
            &names,
            format!(
                "the delay of {} is known to {:.2} us only, 0.5 us are needed: record longer, with a larger signal{}",
                NAMES[k],
                1e6 * delay,
                match found.rotation_rad {
                    Some(_) => ", or at frequencies farther apart",
                    None => "",
                }
            ),
        ));
    }
    Ok(())
}
