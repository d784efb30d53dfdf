//! The clock: sample numbers at one rate, or time stamps.

use super::configuration::Configuration;
use super::data::Samples;
use crate::error::Error;

/// Time of each sample, s, from 0.
///
/// # Errors
/// Several rates, or neither a rate nor time stamps.
pub(super) fn seconds(
    name: &str,
    of: &Configuration,
    samples: &Samples,
    notes: &mut Vec<String>,
) -> Result<Vec<f64>, Error> {
    match rate(name, of)? {
        Some(rate) => Ok(by_number(samples, rate, notes)),
        None => by_stamp(name, of, samples),
    }
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
    let first = samples.stamps[0];
    let stamps = samples.stamps.iter();
    Ok(stamps.map(|stamp| (stamp - first) * of.stamp_s).collect())
}
