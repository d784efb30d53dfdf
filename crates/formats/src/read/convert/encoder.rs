//! Shaft speed from a running count of encoder edges.

use recording::{Error, Period, Sensors};
use std::f64::consts::TAU;

/// Time over which edges are counted, s: at 1500 rpm and 4096 edges per turn 0.2 % resolution, and
/// short against the mechanical time constants of machines from 0.1 kW.
const WINDOW_S: f64 = 0.005;

/// Speed in rad/s from counts: centred difference over 5 ms, or over two samples if that is longer.
///
/// # Errors
/// An encoder whose pulses per revolution are not declared.
pub(in crate::read) fn speed(
    file: &str,
    t: &[f64],
    counts: &[f64],
    sensors: &Sensors,
) -> Result<Vec<f64>, Error> {
    let pulses = pulses(file, sensors, "is a count of edges")?;
    let edges = pulses * f64::from(sensors.encoder_edges_per_pulse.unwrap_or(4));
    let counts = unwrapped(counts, sensors.encoder_counter_bits);
    Ok((0..t.len())
        .map(|k| TAU / edges * slope(t, &counts, k))
        .collect())
}

/// Speed in rad/s from the time between two pulses, or of a turn, s; 0 says that no pulse came, at standstill.
///
/// # Errors
/// An encoder whose pulses per revolution are not declared, and a negative time.
pub(in crate::read) fn speed_of_periods(
    file: &str,
    periods: &[f64],
    of: Period,
    sensors: &Sensors,
) -> Result<Vec<f64>, Error> {
    let per_turn = match of {
        Period::Turn => 1.0,
        Period::Pulse => pulses(file, sensors, "is the time between pulses")?,
    };
    if let Some(x) = periods.iter().find(|x| **x < 0.0) {
        let message = format!("a period of {x} s is negative");
        let remedy = "a period is a time between two pulses; map another column with --column";
        return Err(Error::at(file, 0, "speed", message, remedy));
    }
    let speed = |x: &f64| if *x > 0.0 { TAU / (per_turn * x) } else { 0.0 };
    Ok(periods.iter().map(speed).collect())
}

fn pulses(file: &str, sensors: &Sensors, what: &str) -> Result<f64, Error> {
    sensors
        .encoder_pulses_per_revolution
        .map(f64::from)
        .ok_or_else(|| {
            let message = format!("{what}, but the encoder is not declared");
            let remedy =
                "add encoder_pulses_per_revolution to [sensors], or --pulses-per-revolution N";
            Error::at(file, 0, "speed", message, remedy)
        })
}

fn slope(t: &[f64], counts: &[f64], k: usize) -> f64 {
    let last = t.len() - 1;
    let from = t
        .partition_point(|&x| x < t[k] - 0.5 * WINDOW_S)
        .min(k.saturating_sub(1));
    let to = t
        .partition_point(|&x| x <= t[k] + 0.5 * WINDOW_S)
        .saturating_sub(1);
    let to = to.max((k + 1).min(last));
    (counts[to] - counts[from]) / (t[to] - t[from])
}

/// Adds whole turns of the counter: a step beyond half its range is a wrap.
fn unwrapped(counts: &[f64], bits: Option<u32>) -> Vec<f64> {
    let Some(range) = bits.map(|bits| 2f64.powf(f64::from(bits))) else {
        return counts.to_vec();
    };
    let mut turns = 0.0;
    let mut previous = counts[0];
    let follow = |&count: &f64| {
        turns -= ((count - previous) / range).round();
        previous = count;
        count + turns * range
    };
    counts.iter().map(follow).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoder() -> Sensors {
        Sensors {
            encoder_pulses_per_revolution: Some(1024),
            encoder_counter_bits: Some(16),
            ..Sensors::default()
        }
    }

    /// 1500 rpm for 2 s: 204800 edges, three wraps of a 16 bit counter.
    #[test]
    fn a_wrapping_counter_gives_a_constant_speed() {
        let t: Vec<f64> = (0..20_000).map(|k| f64::from(k) * 1e-4).collect();
        let exact = 25.0 * TAU;
        let count = |t: &f64| (t * 25.0 * 4096.0).floor() % 65536.0;
        let counts: Vec<f64> = t.iter().map(count).collect();
        let speed = speed("x.csv", &t, &counts, &encoder()).unwrap();
        // One edge in 5 ms is 0.31 rad/s; at the ends the window is half as long.
        assert!(
            speed
                .iter()
                .all(|w| (w - exact).abs() < 2.0 * TAU / 4096.0 / 0.005 * 1.01)
        );
        let mean = speed.iter().sum::<f64>() / 20_000.0;
        assert!((mean - exact).abs() < 1e-3 * exact, "{mean}");
    }

    #[test]
    fn a_period_is_a_speed_and_none_is_standstill() {
        let periods = [1.0 / (25.0 * 1024.0), 0.0];
        let pulses = speed_of_periods("x.csv", &periods, Period::Pulse, &encoder()).unwrap();
        assert!((pulses[0] - 25.0 * TAU).abs() < 1e-9 && pulses[1] == 0.0);
        let turn = speed_of_periods("x.csv", &[0.04], Period::Turn, &Sensors::default()).unwrap();
        assert!((turn[0] - 25.0 * TAU).abs() < 1e-9);
        assert!(speed_of_periods("x.csv", &[-1.0], Period::Turn, &encoder()).is_err());
    }

    #[test]
    fn an_undeclared_encoder_is_refused() {
        let error = speed("x.csv", &[0.0, 1.0], &[0.0, 1.0], &Sensors::default()).unwrap_err();
        assert!(error.to_string().contains("encoder_pulses_per_revolution"));
    }
}
