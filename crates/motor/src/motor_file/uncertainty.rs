//! `[uncertainty]`: 95 % intervals of parameters that were not measured on this motor, and how they hang together.

use super::EffectEntry;
use document::{Bounds, Section};

/// 95 % intervals of parameters, and their strong correlations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Uncertainty {
    /// One interval per parameter, in the order of the file.
    pub intervals: Vec<ParameterInterval>,
    /// Correlations of the logarithms of two parameters each.
    pub correlations: Vec<Correlation>,
}

/// 95 % interval of one parameter, in its own unit.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterInterval {
    /// Key of the parameter, in `[parameters]` or in an effect.
    pub key: String,
    /// Lower end, above 0.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Correlation of the logarithms of two parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Correlation {
    /// Key of the one.
    pub first: String,
    /// Key of the other.
    pub second: String,
    /// -1..=1.
    pub value: f64,
}

/// 95 % of a normal distribution lie within so many standard deviations.
const TWO_SIDED_95: f64 = 1.959_964;

impl ParameterInterval {
    /// Standard deviation of the parameter's logarithm.
    pub fn log_deviation(&self) -> f64 {
        (self.high / self.low).ln() / (2.0 * TWO_SIDED_95)
    }
}

impl Uncertainty {
    /// Takes another value for a parameter with its relative standard error, where the value lies outside what was believed: its interval
    /// is then the value's own, and its correlations go.
    pub fn replace_outside(&mut self, key: &str, value: f64, error: f64) {
        let Some(interval) = self.intervals.iter_mut().find(|one| one.key == key) else {
            return;
        };
        if (interval.low..=interval.high).contains(&value) {
            return;
        }
        let factor = (TWO_SIDED_95 * error).exp();
        (interval.low, interval.high) = (value / factor, value * factor);
        self.correlations
            .retain(|one| one.first != key && one.second != key);
    }

    /// The interval of a parameter.
    pub fn of(&self, key: &str) -> Option<&ParameterInterval> {
        self.intervals.iter().find(|interval| interval.key == key)
    }

    /// Correlation of the logarithms of two parameters, 0 where none is written.
    pub fn correlation(&self, [a, b]: [&str; 2]) -> f64 {
        let of =
            |c: &&Correlation| (c.first == a && c.second == b) || (c.first == b && c.second == a);
        self.correlations.iter().find(of).map_or(0.0, |c| c.value)
    }

    /// Standard deviation of a parameter's logarithm.
    pub fn log_deviation(&self, key: &str) -> Option<f64> {
        self.of(key).map(ParameterInterval::log_deviation)
    }
}

/// Keys of `[parameters]` that may have an interval.
const PARAMETERS: [&str; 7] = [
    "stator_resistance_ohm",
    "rotor_resistance_ohm",
    "stator_leakage_henry",
    "rotor_leakage_henry",
    "magnetizing_inductance_henry",
    "inertia_kg_m2",
    "friction_nm_s",
];
const CORRELATION: &str = "correlation";
const END: Bounds = Bounds::above(0.0, 1e12, "");
const SHARE: Bounds = Bounds::between(-1.0, 1.0, "");

pub(super) fn read(root: &Section<'_>, effects: &[EffectEntry]) -> Option<Option<Uncertainty>> {
    let Some(section) = root.optional_section("uncertainty")? else {
        return Some(None);
    };
    let keys: Vec<&str> = section
        .entries()
        .iter()
        .map(|entry| entry.key.as_str())
        .filter(|key| *key != CORRELATION)
        .collect();
    let read: Vec<_> = keys
        .iter()
        .map(|key| interval(&section, key, effects))
        .collect();
    let correlations = correlations(&section, &keys);
    section.finish();
    Some(Some(Uncertainty {
        intervals: read.into_iter().collect::<Option<_>>()?,
        correlations: correlations?,
    }))
}

fn interval(
    section: &Section<'_>,
    key: &str,
    effects: &[EffectEntry],
) -> Option<ParameterInterval> {
    let of_effect = effects.iter().any(|effect| effect.number(key).is_some());
    if !of_effect && !PARAMETERS.contains(&key) {
        let known = PARAMETERS.join(", ");
        // The reader knows the key from here on: it is named once.
        let _ = section.optional_numbers::<2>(key, &END);
        section.report(
            key,
            format!("is no parameter of this motor; intervals are given of {known} and of the parameters of its effects"),
        );
        return None;
    }
    let [low, high] = section.optional_numbers::<2>(key, &END)??;
    if low > high {
        section.report(
            key,
            format!("[{low}, {high}] is upside down: write the lower end first"),
        );
        return None;
    }
    Some(ParameterInterval {
        key: key.to_owned(),
        low,
        high,
    })
}

fn correlations(section: &Section<'_>, keys: &[&str]) -> Option<Vec<Correlation>> {
    let entries = section.sections(CORRELATION)?;
    let mut read = Vec::new();
    for entry in entries {
        let (first, second) = (name(&entry, "first", keys), name(&entry, "second", keys));
        let value = entry.number("value", &SHARE, "the correlation, -1 to 1");
        entry.finish();
        read.push(Correlation {
            first: first?,
            second: second?,
            value: value?,
        });
    }
    Some(read)
}

fn name(entry: &Section<'_>, place: &str, keys: &[&str]) -> Option<String> {
    let name = entry.text(place, "the key of a parameter with an interval")?;
    if keys.contains(&name.as_str()) {
        return Some(name);
    }
    entry.report(
        place,
        format!("\"{name}\" has no interval in [uncertainty]"),
    );
    None
}
