//! The motor's parameters as fields of the page, checked by the motor file's own reader.

use document::{FileError, Problem};
use motor::MotorFile;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use toml_edit::{DocumentMut, Item, value};

/// One input of the page.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Field {
    /// Section and key in the motor file.
    pub key: &'static str,
    /// The unit beside the input.
    pub label: &'static str,
    /// Symbol of the field's literature.
    pub symbol: &'static str,
    /// Unit behind the input.
    pub unit: &'static str,
    /// The value now, as it would be written in the motor file; empty where the file leaves it out.
    pub value: String,
}

/// Key, label, symbol and unit of every input, in the order of the page.
const FIELDS: [(&str, &str, &str, &str); 17] = [
    (
        "parameters.stator_resistance_ohm",
        "Stator resistance",
        "Rs",
        "Ω",
    ),
    (
        "parameters.rotor_resistance_ohm",
        "Rotor resistance",
        "Rr",
        "Ω",
    ),
    (
        "parameters.stator_leakage_henry",
        "Stator leakage",
        "Lls",
        "H",
    ),
    (
        "parameters.rotor_leakage_henry",
        "Rotor leakage",
        "Llr",
        "H",
    ),
    (
        "parameters.magnetizing_inductance_henry",
        "Magnetizing inductance",
        "Lm",
        "H",
    ),
    ("parameters.inertia_kg_m2", "Inertia", "J", "kg m²"),
    (
        "parameters.friction_nm_s",
        "Friction of the motor",
        "B",
        "N m s",
    ),
    (
        "parameters.load_friction_nm_s",
        "Friction of the load",
        "Bl",
        "N m s",
    ),
    ("nameplate.pole_pairs", "Pole pairs", "np", ""),
    ("nameplate.power_watt", "Rated power", "P", "W"),
    (
        "nameplate.voltage_line_rms_volt",
        "Rated line voltage",
        "U",
        "V rms",
    ),
    ("nameplate.current_rms_amp", "Rated current", "I", "A rms"),
    ("nameplate.frequency_hz", "Rated frequency", "f", "Hz"),
    ("nameplate.torque_nm", "Rated torque", "T", "N m"),
    ("monitor.window_cycles", "Window", "", "cycles"),
    ("monitor.persistence_windows", "Persistence", "", "windows"),
    ("monitor.hysteresis", "Hysteresis", "", ""),
];

/// What was typed, by key.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(transparent)]
pub struct Typed(BTreeMap<String, String>);

/// What is wrong with one field.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FieldProblem {
    /// Section and key; empty when it is no single field's fault.
    pub key: String,
    /// What is wrong, the allowed range and the remedy.
    pub message: String,
}

/// The inputs with the values of a motor.
pub fn fields(motor: &MotorFile) -> Vec<Field> {
    let document = document(motor);
    let field = |(key, label, symbol, unit)| Field {
        key,
        label,
        symbol,
        unit,
        value: text_of(&document, key),
    };
    FIELDS.into_iter().map(field).collect()
}

/// A motor with what was typed in place of its values.
///
/// # Errors
/// Everything that the motor file's reader finds wrong, at its field.
pub fn with_typed(motor: &MotorFile, typed: &Typed) -> Result<MotorFile, Vec<FieldProblem>> {
    let mut document = document(motor);
    for (key, text) in &typed.0 {
        let known = FIELDS.iter().any(|(field, ..)| field == key);
        let place = key.split_once('.').filter(|_| known);
        let Some((section, name)) = place else {
            return Err(vec![FieldProblem {
                key: key.clone(),
                message: "is no field of this page: reload it".into(),
            }]);
        };
        match typed_item(text) {
            Some(item) => document[section][name] = item,
            None => {
                document[section]
                    .as_table_mut()
                    .map(|table| table.remove(name));
            }
        }
    }
    MotorFile::parse(&document.to_string(), &motor.name).map_err(|error| problems(&error))
}

/// The problems of a motor file at their fields.
pub fn problems(error: &FileError) -> Vec<FieldProblem> {
    let at_field = |problem: &Problem| FieldProblem {
        key: problem.key.clone(),
        message: problem.message.clone(),
    };
    error.problems().iter().map(at_field).collect()
}

/// The file as a document; what `to_toml` writes always parses.
fn document(motor: &MotorFile) -> DocumentMut {
    motor.to_toml().parse().unwrap_or_default()
}

fn text_of(document: &DocumentMut, key: &str) -> String {
    let found = key
        .split_once('.')
        .and_then(|(section, name)| document.get(section)?.get(name));
    found.map_or(String::new(), |item| item.to_string().trim().to_owned())
}

/// A number as a number; anything else as a word, which the reader refuses at its key. `None` for nothing.
fn typed_item(text: &str) -> Option<Item> {
    let text = text.trim();
    if text.is_empty() {
        return None;
    }
    let whole = text.parse::<i64>().map(value);
    let number = || text.replace(',', ".").parse::<f64>().map(value);
    Some(whole.or_else(|_| number()).unwrap_or_else(|_| value(text)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motor() -> MotorFile {
        let text = include_str!("../../../../motors/assumed-300w.toml");
        MotorFile::parse(text, "motor").expect("it ships")
    }

    fn typed(key: &str, text: &str) -> Typed {
        Typed(BTreeMap::from([(key.to_owned(), text.to_owned())]))
    }

    #[test]
    fn every_field_of_the_page_stands_in_the_motor_file() {
        let fields = fields(&motor());
        assert!(
            fields.iter().all(|field| !field.value.is_empty()),
            "{fields:?}"
        );
        assert_eq!(fields[0].value, "8.0");
    }

    #[test]
    fn what_is_typed_is_what_the_motor_gets() {
        for text in ["9.25", " 9.25 ", "9,25"] {
            let changed = with_typed(&motor(), &typed("parameters.stator_resistance_ohm", text));
            let expected = MotorFile {
                parameters: motor::TParams {
                    r_s: 9.25,
                    ..motor().parameters
                },
                ..motor()
            };
            assert_eq!(changed, Ok(expected), "{text:?}");
        }
    }

    #[test]
    fn an_impossible_value_is_refused_at_its_field() {
        let impossible = [
            ("parameters.stator_leakage_henry", "-0.01", "-0.01"),
            ("parameters.magnetizing_inductance_henry", "0", "above 0"),
            ("parameters.rotor_resistance_ohm", "seven", "is text"),
            ("parameters.inertia_kg_m2", "", "missing"),
            ("parameters.friction_nm_s", "nan", "NaN"),
            ("nameplate.pole_pairs", "1.5", "whole"),
        ];
        for (key, text, word) in impossible {
            let problems = with_typed(&motor(), &typed(key, text)).expect_err(key);
            let own = problems.iter().find(|problem| problem.key == key);
            let message = own.map(|problem| problem.message.to_lowercase());
            let word = word.to_lowercase();
            assert!(
                message.is_some_and(|message| message.contains(&word)),
                "{key}: {problems:?}"
            );
        }
    }

    #[test]
    fn a_key_that_is_no_field_is_refused() {
        for key in ["name", "parameters", "sensors.adc_bits", "parameters.x.y"] {
            assert!(with_typed(&motor(), &typed(key, "1")).is_err(), "{key}");
        }
    }
}
