//! The clock: sample numbers at one rate, or time stamps.

use super::super::header::Unreadable;
use super::configuration::{Configuration, DataKind};
use super::data::Samples;
use recording::Error;

/// How far a declared rate may be from the true one: recorders write 4800 for 4807.
const ROUNDING: f64 = 2e-3;

/// The clock of the samples.
pub(super) struct Clock {
    /// Time of each sample, s, from 0.
    pub seconds: Vec<f64>,
    /// Why there is no clock: the rate and the time stamps contradict each other.
    pub contradiction: Option<Unreadable>,
}

/// The clock of the samples, by their rate or else by their stamps.
///
/// # Errors
/// Several rates, or neither a rate nor time stamps.
pub(super) fn seconds(
    name: &str,
    of: &Configuration,
    samples: &Samples,
    notes: &mut Vec<String>,
) -> Result<Clock, Error> {
    let Some(rate) = rate(name, of)? else {
        let seconds = by_stamp(name, of, samples)?;
        return Ok(Clock {
            seconds,
            contradiction: None,
        });
    };
    let seconds = by_number(samples, rate, notes);
    let contradiction = contradiction(&seconds, rate, of, samples);
    Ok(Clock {
        seconds,
        contradiction,
    })
}

/// The first sample whose stamp is not where the rate puts it.
///
/// Stamps count whole steps, and may have lost up to one at every sample; a rate may be rounded. Stamps that are absent or
/// never change say nothing.
fn contradiction(
    seconds: &[f64],
    rate: f64,
    of: &Configuration,
    samples: &Samples,
) -> Option<Unreadable> {
    let stamps = unwrapped(of, samples);
    let first = stamps.iter().position(|stamp| stamp.is_finite())?;
    if stamps
        .iter()
        .all(|stamp| !stamp.is_finite() || *stamp == stamps[first])
    {
        return None;
    }
    let elapsed = |k: usize| {
        (
            seconds[k] - seconds[first],
            (stamps[k] - stamps[first]) * of.stamp_s,
        )
    };
    let differs = |k: &usize| {
        let (by_rate, by_stamp) = elapsed(*k);
        let lost_steps = by_rate * rate * of.stamp_s;
        stamps[*k].is_finite()
            && (by_stamp - by_rate).abs() > ROUNDING * by_rate + 1.5 / rate + lost_steps
    };
    let k = (first..stamps.len()).find(differs)?;
    let (by_rate, by_stamp) = elapsed(k);
    Some(Unreadable {
        name: "t".to_owned(),
        why: format!(
            "the .cfg declares {rate} Hz, by which sample {} stands at {by_rate:.6} s, but its time stamp says {by_stamp:.6} s",
            k + 1
        ),
        remedy: "correct the rate (samp) or timemult in the .cfg, or say which it is: --sample-rate HZ",
    })
}

/// Stamps that go on where those of 32 bits begin again.
fn unwrapped(of: &Configuration, samples: &Samples) -> Vec<f64> {
    const RANGE: f64 = 4_294_967_296.0;
    let mut turns = 0.0;
    let mut previous = f64::NAN;
    let follow = |&stamp: &f64| {
        if of.kind != DataKind::Ascii && stamp < previous - 0.5 * RANGE {
            turns += 1.0;
        }
        previous = if stamp.is_finite() { stamp } else { previous };
        stamp + turns * RANGE
    };
    samples.stamps.iter().map(follow).collect()
}

/// The one rate; `None` where the stamps count.
fn rate(name: &str, of: &Configuration) -> Result<Option<f64>, Error> {
    let Some((first, end)) = of.rates.first() else {
        return Ok(None);
    };
    if let Some((other, _)) = of.rates.iter().find(|(rate, _)| rate != first) {
        let message =
            format!("the sampling rate changes: {first} Hz to sample {end}, then {other} Hz");
        let remedy = "export the part around the load change at one rate";
        return Err(Error::unsupported(name, message, remedy));
    }
    Ok(Some(*first).filter(|rate| *rate > 0.0))
}

#[allow(clippy::cast_precision_loss)]
fn by_number(samples: &Samples, rate: f64, notes: &mut Vec<String>) -> Vec<f64> {
    let numbers = &samples.numbers;
    if numbers.windows(2).all(|pair| pair[0] < pair[1]) {
        let first = numbers[0];
        return numbers.iter().map(|n| (n - first) as f64 / rate).collect();
    }
    notes.push("the sample numbers do not rise; the samples are taken as consecutive".to_owned());
    (0..numbers.len()).map(|k| k as f64 / rate).collect()
}

fn by_stamp(name: &str, of: &Configuration, samples: &Samples) -> Result<Vec<f64>, Error> {
    if let Some(k) = samples.stamps.iter().position(|stamp| !stamp.is_finite()) {
        let message = format!(
            "the configuration declares no sampling rate, and sample {} has no time stamp",
            k + 1
        );
        let remedy = "set the rate in the .cfg (samp), or export the file with time stamps";
        return Err(Error::at(name, 0, "timestamp", message, remedy));
    }
    let stamps = unwrapped(of, samples);
    let first = stamps[0];
    let seconds = stamps.iter().map(|stamp| (stamp - first) * of.stamp_s);
    Ok(seconds.collect())
}
