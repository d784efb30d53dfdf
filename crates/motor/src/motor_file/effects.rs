//! `[[effects]]`: physical effects by name, with their parameters as written.
//!
//! This module knows no effect. The library of effects checks names, parameters and ranges; lines are kept so that its
//! errors can name them.

use document::{Bounds, Entry, Problem, Section, Value};

/// One `[[effects]]` entry.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectEntry {
    /// Name of the effect.
    pub name: String,
    /// Line of `name` in its file, counted from 1; 0 when the entry was made by a program.
    pub line: usize,
    /// Parameters in the order of the file.
    pub parameters: Vec<EffectParameter>,
}

/// One key of an `[[effects]]` entry.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectParameter {
    /// The key.
    pub key: String,
    /// Its line, counted from 1; 0 when it was made by a program.
    pub line: usize,
    /// Its value.
    pub value: EffectValue,
}

/// A parameter's value.
#[derive(Clone, Debug, PartialEq)]
pub enum EffectValue {
    /// A finite number.
    Number(f64),
    /// Text, such as a formula.
    Text(String),
    /// Finite numbers, such as the knots of a curve.
    List(Vec<f64>),
}

impl EffectEntry {
    /// An entry with numbers only, as a fit writes it.
    pub fn with_numbers<'k>(
        name: &str,
        numbers: impl IntoIterator<Item = (&'k str, f64)>,
    ) -> EffectEntry {
        let parameters = numbers
            .into_iter()
            .map(|(key, number)| EffectParameter {
                key: key.to_owned(),
                line: 0,
                value: EffectValue::Number(number),
            })
            .collect();
        EffectEntry {
            name: name.to_owned(),
            line: 0,
            parameters,
        }
    }

    /// Takes over the numbers of another entry of the same effect; keys, order and form stay.
    pub fn take_numbers(&mut self, other: &EffectEntry) {
        for parameter in &mut self.parameters {
            if let Some(number) = other.number(&parameter.key) {
                parameter.value = EffectValue::Number(number);
            }
        }
    }

    /// A numeric parameter by its key.
    pub fn number(&self, key: &str) -> Option<f64> {
        match self.parameter(key)?.value {
            EffectValue::Number(number) => Some(number),
            EffectValue::Text(_) | EffectValue::List(_) => None,
        }
    }

    /// A text parameter by its key.
    pub fn text(&self, key: &str) -> Option<&str> {
        match &self.parameter(key)?.value {
            EffectValue::Text(text) => Some(text),
            EffectValue::Number(_) | EffectValue::List(_) => None,
        }
    }

    /// A parameter by its key.
    pub fn parameter(&self, key: &str) -> Option<&EffectParameter> {
        self.parameters
            .iter()
            .find(|parameter| parameter.key == key)
    }

    /// The line of one key of this entry, or of its name where the key is absent.
    pub fn line_of(&self, key: &str) -> usize {
        self.parameter(key)
            .map_or(self.line, |parameter| parameter.line)
    }

    /// One key of this entry, as errors print it.
    pub fn path_of(&self, key: &str) -> String {
        format!("effects.{}.{key}", self.name)
    }

    /// A problem with one key of this entry, at that key's line.
    pub fn problem(&self, file: &str, key: &str, message: impl Into<String>) -> Problem {
        Problem {
            file: file.to_owned(),
            line: self.line_of(key),
            key: self.path_of(key),
            message: message.into(),
        }
    }
}

const ANY_FINITE: Bounds = Bounds::between(f64::MIN, f64::MAX, "");

pub(super) fn read(root: &Section<'_>) -> Option<Vec<EffectEntry>> {
    let sections = root.sections("effects")?;
    sections.into_iter().map(read_entry).collect()
}

fn read_entry(section: Section<'_>) -> Option<EffectEntry> {
    let name = section.text("name", "the name of the effect");
    let line = section.line_of("name");
    let parameters: Option<Vec<_>> = section
        .entries()
        .iter()
        .filter(|entry| entry.key != "name")
        .map(|entry| read_parameter(&section, entry))
        .collect();
    section.finish();
    Some(EffectEntry {
        name: name?,
        line,
        parameters: parameters?,
    })
}

fn read_parameter(section: &Section<'_>, entry: &Entry) -> Option<EffectParameter> {
    let value = match entry.value {
        Value::Text(_) => EffectValue::Text(section.optional_text(&entry.key)??),
        Value::Array(_) => EffectValue::List(section.list(&entry.key, &ANY_FINITE)?),
        _ => EffectValue::Number(section.optional_number(&entry.key, &ANY_FINITE)??),
    };
    Some(EffectParameter {
        key: entry.key.clone(),
        line: entry.line,
        value,
    })
}
