//! What one or two channels say: frequency and size, and how the size changes.

use recording::{Channel, Recording};
use schemars::JsonSchema;
use serde::Serialize;

use super::clamp_bars::{BesideSupply, beside_supply};

/// One channel of a recording that has no three of a kind.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ClampSignal {
    /// Its name.
    pub channel: String,
    /// Unit of the size: V or A.
    pub unit: &'static str,
    /// Frequency of the supply, Hz; absent where no steady one is seen.
    pub frequency_hz: Option<f64>,
    /// Root mean square over the recording.
    pub rms: f64,
    /// Change of the size from the first to the last quarter, percent.
    pub change_percent: f64,
    /// What lies beside the supply; only of a current of a steady frequency, long enough to part lines from the supply.
    pub beside_supply: Option<BesideSupply>,
    /// What that says about the rotor's bars, in words; absent of a voltage.
    pub rotor: Option<String>,
}

/// Least periods for a frequency.
const PERIODS: usize = 5;
/// Supplies of motors, Hz.
const SUPPLIES_HZ: [f64; 2] = [1.5, 1000.0];
/// Crossings may scatter by this share of a period: more is no steady frequency.
const SCATTER: f64 = 0.1;

/// The electrical channels of a recording with neither three voltages nor three currents; empty for all others.
pub fn clamp_signals(recording: &Recording) -> Vec<ClampSignal> {
    if recording.voltages().is_some() || recording.currents().is_some() {
        return Vec::new();
    }
    let electrical = recording
        .channels()
        .filter(|(channel, _)| channel.is_electrical());
    electrical
        .map(|(channel, x)| signal(channel, x, recording.t_sample()))
        .collect()
}

fn signal(channel: Channel, x: &[f64], step: f64) -> ClampSignal {
    let mean = x.iter().sum::<f64>() / x.len().max(1) as f64;
    let swings: Vec<f64> = x.iter().map(|x| x - mean).collect();
    let quarter = (swings.len() / 4).max(1);
    let [first, last] = [
        &swings[..quarter.min(swings.len())],
        &swings[swings.len() - quarter.min(swings.len())..],
    ]
    .map(rms);
    let is_voltage = Channel::VOLTAGES.contains(&channel);
    let frequency_hz = frequency(&swings, step);
    let beside_supply = frequency_hz
        .filter(|_| !is_voltage)
        .and_then(|hz| beside_supply(&swings, step, hz));
    ClampSignal {
        channel: channel.to_string(),
        unit: if is_voltage { "V" } else { "A" },
        frequency_hz,
        rotor: (!is_voltage).then(|| words(beside_supply.as_ref(), frequency_hz)),
        beside_supply,
        rms: rms(&swings),
        change_percent: 100.0 * (last / first.max(f64::MIN_POSITIVE) - 1.0),
    }
}

/// Without a speed the bars are never called whole or broken.
fn words(beside: Option<&BesideSupply>, frequency_hz: Option<f64>) -> String {
    let Some((beside, supply_hz)) = beside.zip(frequency_hz) else {
        return "rotor bars not tested: that takes a steady supply and some ten seconds".to_owned();
    };
    let [from, to] = beside.looked_hz;
    match &beside.line {
        Some(line) => format!(
            "rotor bars cannot be told from one current: lines {:.2} Hz beside the supply, {:.2} % of the current below and {:.2} % above it. Broken bars leave such lines at \
             a slip of {:.1} %, and so does a load that swings at {0:.2} Hz: record the speed too, or another load",
            line.distance_hz,
            line.lower_percent,
            line.upper_percent,
            50.0 * line.distance_hz / supply_hz,
        ),
        None => format!(
            "rotor bars: no line beside the supply between {from:.1} and {to:.1} Hz; from {:.2} % of the current on one would show. Broken bars leave some 0.5 to 2 % near rated \
             load, little without load",
            beside.visible_percent
        ),
    }
}

fn rms(x: &[f64]) -> f64 {
    (x.iter().map(|x| x * x).sum::<f64>() / x.len().max(1) as f64).sqrt()
}

/// From the upward crossings of zero behind a band of half the size: noise crosses no band.
fn frequency(x: &[f64], step: f64) -> Option<f64> {
    let band = 0.5 * rms(x);
    let (mut below, mut crossings) = (false, Vec::new());
    for (k, &value) in x.iter().enumerate() {
        if value < -band {
            below = true;
        } else if below && value > band {
            below = false;
            crossings.push(k as f64 * step);
        }
    }
    let periods: Vec<f64> = crossings.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mean = periods.iter().sum::<f64>() / periods.len().max(1) as f64;
    let steady = periods
        .iter()
        .filter(|period| (*period / mean - 1.0).abs() < SCATTER)
        .count();
    let hz = 1.0 / mean;
    let seen = periods.len() >= PERIODS && 10 * steady >= 9 * periods.len();
    (seen && (SUPPLIES_HZ[0]..=SUPPLIES_HZ[1]).contains(&hz)).then_some(hz)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_sine_has_its_frequency_and_size() {
        let x: Vec<f64> = (0..20_000)
            .map(|k| 0.3 + 5.0 * (TAU * 49.7 * f64::from(k) * 1e-4).sin())
            .collect();
        let signal = signal(Channel::CURRENTS[0], &x, 1e-4);
        // One sample of 1e-4 s over 98 periods.
        assert!((signal.frequency_hz.unwrap() - 49.7).abs() < 0.01);
        assert!((signal.rms - 5.0 / 2f64.sqrt()).abs() < 0.01 && signal.change_percent.abs() < 1.0);
    }

    #[test]
    fn noise_and_silence_have_none() {
        let mut seed = 1u64;
        let mut noise = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as f64 / 2f64.powi(31) - 0.5
        };
        let x: Vec<f64> = (0..5000).map(|_| noise()).collect();
        assert_eq!(frequency(&x, 1e-4), None);
        assert_eq!(frequency(&[0.0; 1000], 1e-4), None);
        assert_eq!(frequency(&[], 1e-4), None);
    }
}
