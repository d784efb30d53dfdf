//! What a clamp, divider or tachometer makes of a quantity.

use crate::data::channel::Quantity;
use crate::data::units::Unit;

/// The scale of a sensor, as its plate says it: `100 mV/A`, `10 A/V`, `1000:1`.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    text: String,
    raw: Quantity,
    si_per_raw: f64,
}

/// How a sensor may be written.
pub(crate) const WAYS: &str =
    "write output per input, 100mV/A or 60V/1000rpm, input per output, 10A/V, or a ratio, 1000:1";

impl Sensor {
    /// The sensor of a quantity.
    ///
    /// # Errors
    /// Text that is no scale of such a sensor: why, as a sentence.
    pub fn parse(quantity: Quantity, text: &str) -> Result<Sensor, String> {
        let found = ratio(quantity, text).or_else(|| per(quantity, text));
        let (raw, si_per_raw) = found.ok_or_else(|| {
            format!(
                "`{text}` is not the scale of a sensor of {}",
                word(quantity)
            )
        })?;
        match si_per_raw.is_finite() && si_per_raw != 0.0 {
            true => Ok(Sensor {
                text: text.trim().to_owned(),
                raw,
                si_per_raw,
            }),
            false => Err(format!("`{text}` is no finite scale other than 0")),
        }
    }

    /// As it was written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// What the sensor gives out.
    pub fn raw(&self) -> Quantity {
        self.raw
    }

    /// SI value of the quantity from the SI value of what the sensor gives out.
    pub fn to_si(&self, raw: f64) -> f64 {
        self.si_per_raw * raw
    }
}

fn word(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Time => "time",
        Quantity::Voltage => "voltage",
        Quantity::Current => "current",
        Quantity::Speed => "speed",
        Quantity::Torque => "torque",
        Quantity::Temperature => "temperature",
    }
}

/// `1000:1`: a divider, a transformer.
fn ratio(quantity: Quantity, text: &str) -> Option<(Quantity, f64)> {
    let electrical = matches!(quantity, Quantity::Voltage | Quantity::Current);
    let (first, second) = text.split_once(':').filter(|_| electrical)?;
    let number = |text: &str| text.trim().parse::<f64>().ok();
    Some((quantity, number(first)? / number(second)?))
}

/// `100 mV/A` or `10 A/V`.
fn per(quantity: Quantity, text: &str) -> Option<(Quantity, f64)> {
    // A unit may have a stroke of its own: `1 V/rad/s`.
    let strokes = text.match_indices('/').map(|(at, _)| at);
    strokes.into_iter().find_map(|at| {
        let (left, right) = (&text[..at], &text[at + 1..]);
        let raws = [Quantity::Voltage, Quantity::Current];
        raws.into_iter().find_map(|raw| {
            let output_per_input = || Some(size(quantity, right)? / size(raw, left)?);
            let input_per_output = || Some(size(quantity, left)? / size(raw, right)?);
            let factor = match raw == quantity {
                // 100 V/V could be either way round.
                true => output_per_input().filter(|_| unit_of(left) != unit_of(right)),
                false => output_per_input().or_else(input_per_output),
            };
            factor.map(|factor| (raw, factor))
        })
    })
}

/// The SI value of `100 mV`, or of `A`.
fn size(quantity: Quantity, text: &str) -> Option<f64> {
    let unit = Unit::declared(quantity, unit_of(text)).ok()?;
    let digits = text.trim().strip_suffix(unit_of(text))?.trim();
    let number = if digits.is_empty() {
        1.0
    } else {
        digits.parse().ok()?
    };
    let linear = !unit.counts && unit.period.is_none();
    linear.then_some(number * unit.factor)
}

fn unit_of(text: &str) -> &str {
    text.trim()
        .trim_start_matches(|c: char| c.is_ascii_digit() || matches!(c, '.' | '+' | '-'))
        .trim()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn plates_of_sensors_are_read() {
        for (quantity, text, raw, factor) in [
            (Quantity::Current, "100 mV/A", Quantity::Voltage, 10.0),
            (Quantity::Current, "100mV/A", Quantity::Voltage, 10.0),
            (Quantity::Current, "10 A/V", Quantity::Voltage, 10.0),
            (Quantity::Current, "1mA/A", Quantity::Current, 1000.0),
            (Quantity::Current, "400:5", Quantity::Current, 80.0),
            (Quantity::Voltage, "1000:1", Quantity::Voltage, 1000.0),
            (Quantity::Voltage, "5 mV/V", Quantity::Voltage, 200.0),
            (
                Quantity::Speed,
                "60V/1000rpm",
                Quantity::Voltage,
                1000.0 * TAU / 60.0 / 60.0,
            ),
            (Quantity::Torque, "10 Nm/V", Quantity::Voltage, 10.0),
        ] {
            let sensor = Sensor::parse(quantity, text).unwrap();
            assert_eq!(sensor.raw(), raw, "{text}");
            assert!((sensor.to_si(1.0) - factor).abs() < 1e-9 * factor, "{text}");
        }
    }

    #[test]
    fn what_is_no_plate_is_refused() {
        for text in [
            "",
            "100",
            "100 mV",
            "100 mV/rpm",
            "0 mV/A",
            "A/0V",
            "1:0",
            "100 V/V",
            "nan mV/A",
        ] {
            let voltage = Sensor::parse(Quantity::Voltage, text);
            let current = Sensor::parse(Quantity::Current, text);
            assert!(
                voltage.is_err() && current.is_err(),
                "{text}: {voltage:?} {current:?}"
            );
        }
    }
}
