//! The units that a file may use, and what one of each is in SI.

use crate::data::channel::Quantity;

/// A unit of a file's column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// The name in a sidecar or a flag.
    pub name: &'static str,
    /// What it measures.
    pub quantity: Quantity,
    /// SI value of one unit.
    pub factor: f64,
    /// SI value of zero; differs from 0 for Fahrenheit and kelvin only.
    pub zero: f64,
    /// Whether the column is a running count of encoder edges, to be differentiated.
    pub counts: bool,
    /// Whether the column is the time from one pulse of the encoder to the next, or of a whole turn.
    pub period: Option<Period>,
}

/// What a measured period spans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Period {
    /// From one pulse of an encoder's track to the next.
    Pulse,
    /// One turn of the shaft.
    Turn,
}

use std::f64::consts::TAU;

const fn unit(name: &'static str, quantity: Quantity, factor: f64) -> Unit {
    Unit {
        name,
        quantity,
        factor,
        zero: 0.0,
        counts: false,
        period: None,
    }
}

const fn period(name: &'static str, seconds: f64, of: Period) -> Unit {
    Unit {
        period: Some(of),
        ..unit(name, Quantity::Speed, seconds)
    }
}

/// Every unit that a file may use; the first of a quantity is SI.
pub const UNITS: [Unit; 31] = [
    unit("s", Quantity::Time, 1.0),
    unit("ms", Quantity::Time, 1e-3),
    unit("us", Quantity::Time, 1e-6),
    unit("ns", Quantity::Time, 1e-9),
    unit("V", Quantity::Voltage, 1.0),
    unit("mV", Quantity::Voltage, 1e-3),
    unit("kV", Quantity::Voltage, 1e3),
    unit("A", Quantity::Current, 1.0),
    unit("mA", Quantity::Current, 1e-3),
    unit("kA", Quantity::Current, 1e3),
    unit("rad/s", Quantity::Speed, 1.0),
    unit("rpm", Quantity::Speed, TAU / 60.0),
    unit("rev/s", Quantity::Speed, TAU),
    unit("Hz", Quantity::Speed, TAU),
    unit("deg/s", Quantity::Speed, TAU / 360.0),
    Unit {
        counts: true,
        ..unit("counts", Quantity::Speed, 1.0)
    },
    unit("Nm", Quantity::Torque, 1.0),
    unit("mNm", Quantity::Torque, 1e-3),
    unit("kNm", Quantity::Torque, 1e3),
    unit("lbf.ft", Quantity::Torque, 1.355_817_948_331_4),
    unit("lbf.in", Quantity::Torque, 0.112_984_829_027_616_7),
    unit("degC", Quantity::Temperature, 1.0),
    unit("C", Quantity::Temperature, 1.0),
    Unit {
        zero: -273.15,
        ..unit("K", Quantity::Temperature, 1.0)
    },
    Unit {
        zero: -160.0 / 9.0,
        ..unit("degF", Quantity::Temperature, 5.0 / 9.0)
    },
    unit("min", Quantity::Time, 60.0),
    period("s/pulse", 1.0, Period::Pulse),
    period("ms/pulse", 1e-3, Period::Pulse),
    period("us/pulse", 1e-6, Period::Pulse),
    period("ms/rev", 1e-3, Period::Turn),
    period("us/rev", 1e-6, Period::Turn),
];

impl Unit {
    /// The unit called `name`, of a quantity.
    ///
    /// # Errors
    /// The units that the quantity does take, as text for a message.
    pub fn parse(quantity: Quantity, name: &str) -> Result<Unit, String> {
        let known = || UNITS.iter().filter(|unit| unit.quantity == quantity);
        known()
            .find(|unit| unit.name == name)
            .copied()
            .ok_or_else(|| known().map(|unit| unit.name).collect::<Vec<_>>().join(", "))
    }

    /// The unit that an instrument calls `name`: as [`Unit::parse`], and case counts only where it
    /// tells units apart (`mV` is not `MV`).
    ///
    /// # Errors
    /// The units that the quantity does take, as text for a message.
    pub fn declared(quantity: Quantity, name: &str) -> Result<Unit, String> {
        let usual = usual(name.trim());
        Unit::parse(quantity, usual)
    }

    /// The SI unit of a quantity.
    pub fn si(quantity: Quantity) -> Unit {
        // The table holds every quantity's SI name; the fallback has the same meaning.
        Unit::parse(quantity, quantity.si()).unwrap_or(unit("", quantity, 1.0))
    }

    /// A value of this unit in SI.
    pub fn to_si(self, x: f64) -> f64 {
        self.factor * x + self.zero
    }
}

/// Our name for what instruments call a unit.
fn usual(name: &str) -> &str {
    match name {
        "v" | "Volt" | "Volts" | "volt" | "volts" | "VOLT" | "Vdc" | "Vac" => "V",
        "a" | "Amp" | "Amps" | "amp" | "amps" | "Ampere" | "ampere" | "AMP" => "A",
        "mv" | "millivolt" | "Millivolt" => "mV",
        "ma" | "milliampere" => "mA",
        "kv" | "KV" | "Kv" => "kV",
        "ka" | "KA" | "Ka" => "kA",
        "N.m" | "N m" | "N*m" | "N-m" | "N\u{b7}m" | "NM" | "nm" => "Nm",
        "r/min" | "RPM" | "1/min" | "min-1" | "min^-1" | "min\u{207b}\u{b9}" | "U/min" | "Upm"
        | "tr/min" | "Rpm" => "rpm",
        "1/s" | "rps" | "U/s" => "rev/s",
        "rad/sec" | "rad s-1" | "rad/s^1" => "rad/s",
        "S" | "sec" | "Sec" | "second" | "Second" | "seconds" | "Seconds" | "Sekunden" => "s",
        "msec" | "mS" | "milliseconds" | "millisecond" => "ms",
        "\u{b5}s" | "\u{3bc}s" | "usec" | "uS" | "microseconds" => "us",
        "\u{b0}C" | "\u{2103}" | "Cel" | "deg C" => "degC",
        "\u{b0}F" => "degF",
        other => other,
    }
}

/// Whether a word is the unit of any quantity, as instruments write it.
pub fn is_unit(name: &str) -> bool {
    let name = usual(name.trim());
    UNITS.iter().any(|unit| unit.name == name) || OTHERS.contains(&name)
}

/// Units of columns that are not used.
const OTHERS: [&str; 16] = [
    "W", "kW", "VA", "kVA", "var", "kvar", "%", "deg", "bar", "g", "Wh", "kWh", "kHz", "MHz",
    "kS/s", "S/s",
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_points_convert() {
        let cases = [
            (Quantity::Speed, "rpm", 1500.0, 50.0 * std::f64::consts::PI),
            (Quantity::Temperature, "degF", 212.0, 100.0),
            (Quantity::Temperature, "K", 273.15, 0.0),
            (Quantity::Torque, "lbf.ft", 1.0, 1.355_817_948_331_4),
            (Quantity::Time, "ms", 20.0, 0.02),
        ];
        for (quantity, name, x, si) in cases {
            let unit = Unit::parse(quantity, name).unwrap();
            assert!(
                (unit.to_si(x) - si).abs() < 1e-12 * si.abs().max(1.0),
                "{name}"
            );
        }
    }

    #[test]
    fn every_quantity_has_its_si_unit() {
        use Quantity::*;
        for quantity in [Time, Voltage, Current, Speed, Torque, Temperature] {
            let si = Unit::si(quantity);
            assert_eq!((si.name, si.factor, si.zero), (quantity.si(), 1.0, 0.0));
        }
    }

    #[test]
    fn a_unit_of_another_quantity_is_refused_with_the_list() {
        let known = Unit::parse(Quantity::Speed, "V").unwrap_err();
        assert_eq!(
            known,
            "rad/s, rpm, rev/s, Hz, deg/s, counts, s/pulse, ms/pulse, us/pulse, ms/rev, us/rev"
        );
    }
}
