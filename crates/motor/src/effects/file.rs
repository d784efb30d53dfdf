//! Effects in the motor file: from its entries and back.

use super::expression;
use super::{EffectConfig, EffectError, Rated};
use crate::MotorFile;
use crate::document::FileError;
use crate::motor_file::{EffectEntry, EffectParameter, EffectValue};

/// Key that chooses between several forms of one effect.
const FORM: &str = "form";

/// Rated quantities of a motor file.
pub fn rated(file: &MotorFile) -> Rated<f64> {
    let plate = &file.nameplate;
    Rated {
        voltage: plate.phase_voltage_amplitude(),
        current: plate.current_amplitude(),
        omega_sync: plate.omega_sync(),
        n_p: f64::from(plate.pole_pairs),
        torque: plate.torque_nm,
    }
}

/// The effects of a motor file, checked against the library.
///
/// # Errors
/// Every entry that names no effect, or has a wrong key or a value out of range: with file, line and remedy.
pub fn from_motor_file(file: &MotorFile, label: &str) -> Result<Vec<EffectConfig>, FileError> {
    let rated = rated(file);
    file.check_effects(label, |entry| match from_entry(entry, &rated) {
        Ok(_) => Ok(()),
        Err(error) => Err((blamed(&error), error.to_string())),
    })?;
    let configs = file.effects.iter().map(|e| from_entry(e, &rated));
    Ok(configs.filter_map(Result::ok).collect())
}

/// One entry of a motor file as an effect.
///
/// # Errors
/// As [`EffectConfig::from_file`].
pub fn from_entry(entry: &EffectEntry, rated: &Rated<f64>) -> Result<EffectConfig, EffectError> {
    let numbers: Vec<(String, f64)> = entry
        .parameters
        .iter()
        .filter_map(|p| entry.number(&p.key).map(|x| (p.key.clone(), x)))
        .collect();
    if entry.name == expression::NAME {
        return expression::expression(entry.text("formula"), entry.text("adds_to"), &numbers);
    }
    EffectConfig::from_file(&entry.name, entry.text(FORM).unwrap_or(""), &numbers, rated)
}

/// An effect as a motor file writes it.
pub fn to_entry(config: &EffectConfig) -> EffectEntry {
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

/// The key of a motor file that an error is about.
fn blamed(error: &EffectError) -> String {
    match error {
        EffectError::UnknownParameter { key, .. } => key.clone(),
        EffectError::OutOfRange { key, .. } => (*key).to_owned(),
        EffectError::Formula { .. } => "formula".to_owned(),
        EffectError::UnknownEffect { .. } | EffectError::MissingParameter { .. } => {
            "name".to_owned()
        }
    }
}
