//! Effects in the motor file: from its entries and back.

use crate::MotorFile;
use crate::effect::config::known_effect;
use crate::effect::{Descriptor, EffectConfig, EffectError, MAX_FILE_STATES, Rated};
use crate::effect::{curve, expression, motions};
use crate::motor_file::{EffectEntry, EffectParameter, EffectValue, Nameplate};
use document::{Document, FileError};

/// Key that chooses between several forms of one effect.
const FORM: &str = "form";

/// Rated quantities of a motor file.
pub fn rated(file: &MotorFile) -> Rated<f64> {
    rated_by(&file.nameplate)
}

fn rated_by(plate: &Nameplate) -> Rated<f64> {
    Rated {
        voltage: plate.phase_voltage_amplitude(),
        current: plate.current_amplitude(),
        omega_sync: plate.omega_sync(),
        n_p: f64::from(plate.pole_pairs),
        torque: plate.torque_nm,
    }
}

/// The effects of a motor file.
///
/// # Errors
/// Every entry that the library refuses, with file, line and remedy: in a motor made by a program only, since a file is
/// checked when it is read.
pub fn from_motor_file(file: &MotorFile, label: &str) -> Result<Vec<EffectConfig>, FileError> {
    let rated = rated(file);
    let (mut configs, mut problems) = (Vec::new(), Vec::new());
    for entry in &file.effects {
        match from_entry(entry, &rated) {
            Ok(config) => configs.push(config),
            Err(error) => problems.push(entry.problem(label, error.key(), error.to_string())),
        }
    }
    if problems.is_empty() {
        Ok(configs)
    } else {
        Err(FileError::new(problems))
    }
}

/// Reports every entry that the library refuses, with its line and key.
pub(crate) fn check(document: &Document, plate: &Nameplate, entries: &[EffectEntry]) {
    let rated = rated_by(plate);
    let mut states = 0;
    for entry in entries {
        let report = |key: &str, message: String| {
            document.report(entry.line_of(key), &entry.path_of(key), message);
        };
        match from_entry(entry, &rated) {
            Ok(config) => states += config.effect.extra_states(),
            Err(error) => report(error.key(), error.to_string()),
        }
        if states > MAX_FILE_STATES {
            report(
                "name",
                format!("all effects together need more than {MAX_FILE_STATES} states: remove one"),
            );
            return;
        }
    }
}

/// One entry of a motor file as an effect.
///
/// # Errors
/// As [`EffectConfig::from_file`], and a key that the effect does not have, or of the wrong type.
pub fn from_entry(entry: &EffectEntry, rated: &Rated<f64>) -> Result<EffectConfig, EffectError> {
    if entry.name == curve::NAME {
        return curve::from_entry(entry);
    }
    check_lists(entry)?;
    let numbers: Vec<(String, f64)> = entry
        .parameters
        .iter()
        .filter_map(|p| entry.number(&p.key).map(|x| (p.key.clone(), x)))
        .collect();
    if entry.name == expression::NAME {
        check_formula_texts(entry)?;
        let formula = entry.text("formula");
        let config = expression::expression(formula, entry.text("adds_to"), &numbers)?;
        motions::check(formula.unwrap_or_default(), &numbers, rated)?;
        return Ok(config);
    }
    let effect = known_effect(&entry.name, entry.text(FORM).unwrap_or(""))?;
    check_types(entry, effect.descriptor())?;
    EffectConfig::with_entries(effect, &numbers, rated)
}

fn texts(entry: &EffectEntry) -> impl Iterator<Item = &str> {
    let keys = entry.parameters.iter().map(|p| p.key.as_str());
    keys.filter(|key| entry.text(key).is_some())
}

/// A list is the knots or the values of a curve, and nothing else.
fn check_lists(entry: &EffectEntry) -> Result<(), EffectError> {
    let is_list = |p: &&EffectParameter| matches!(p.value, EffectValue::List(_));
    let list = entry.parameters.iter().find(is_list);
    let Some(list) = list else { return Ok(()) };
    let effect = match entry.name.as_str() {
        expression::NAME => expression::NAME,
        name => {
            known_effect(name, entry.text(FORM).unwrap_or(""))?
                .descriptor()
                .name
        }
    };
    let key = list.key.clone();
    Err(EffectError::NotANumber { effect, key })
}

/// Nothing but the form is text, and the form is nothing else.
fn check_types(entry: &EffectEntry, descriptor: &'static Descriptor) -> Result<(), EffectError> {
    let effect = descriptor.name;
    let has_form = !descriptor.form.is_empty();
    if has_form && entry.number(FORM).is_some() {
        return Err(EffectError::NotAText { effect, key: FORM });
    }
    let Some(key) = texts(entry).find(|key| !(has_form && *key == FORM)) else {
        return Ok(());
    };
    let numbers = descriptor.parameters.iter().map(|p| p.name);
    let key = key.to_owned();
    if numbers.clone().any(|name| name == key) {
        return Err(EffectError::NotANumber { effect, key });
    }
    let known = numbers.chain(has_form.then_some(FORM)).collect();
    Err(EffectError::UnknownParameter { effect, key, known })
}

/// Of a formula's entry, only the formula and its target are text.
fn check_formula_texts(entry: &EffectEntry) -> Result<(), EffectError> {
    let unknown = texts(entry).find(|key| !expression::TEXTS.contains(key));
    unknown.map_or(Ok(()), |key| {
        Err(EffectError::UnknownParameter {
            effect: expression::NAME,
            key: key.to_owned(),
            known: [
                &expression::TEXTS[..],
                &["a number for each parameter of the formula"],
            ]
            .concat(),
        })
    })
}

/// An effect as a motor file writes it.
pub fn to_entry(config: &EffectConfig) -> EffectEntry {
    if let Some(law) = curve::to_entry(config) {
        return law;
    }
    let mut entry = EffectEntry::with_numbers(config.effect.descriptor().name, config.to_file());
    let text = |(key, text): (&str, &str)| EffectParameter {
        key: key.to_owned(),
        line: 0,
        value: EffectValue::Text(text.to_owned()),
    };
    entry
        .parameters
        .splice(0..0, config.effect.texts().into_iter().map(text));
    entry
}
