//! A curve in a motor file.

use super::law::allowed;
use super::{Action, Coordinate, NAME, Place, curve, knots_and_values};
use crate::effect::{EffectConfig, EffectError};
use crate::motor_file::{EffectEntry, EffectParameter, EffectValue};

const PLACE: &str = "place";
const COORDINATE: &str = "coordinate";

/// The entry as an effect.
///
/// # Errors
/// An unknown place, coordinate or key, and what [`curve`] refuses.
pub(crate) fn from_entry(entry: &EffectEntry) -> Result<EffectConfig, EffectError> {
    let place = chosen(entry, PLACE, Place::by_name, &Place::ALL.map(Place::name))?;
    let coordinates = Coordinate::ALL.map(Coordinate::name);
    let coordinate = chosen(entry, COORDINATE, Coordinate::by_name, &coordinates)?;
    let action = Action { place, coordinate };
    allowed(action)?;
    let keys = [coordinate.key(), place.quantity(coordinate).key];
    let known = [PLACE, COORDINATE, keys[0], keys[1]];
    let mut given = entry.parameters.iter().map(|p| p.key.as_str());
    if let Some(key) = given.find(|key| !known.contains(key)) {
        return Err(EffectError::UnknownParameter {
            effect: NAME,
            key: key.to_owned(),
            known: known.to_vec(),
        });
    }
    let [knots, values] = keys.map(|key| list(entry, key));
    curve(action, knots?, values?)
}

/// A curve as a motor file writes it; `None` for another effect.
pub(crate) fn to_entry(config: &EffectConfig) -> Option<EffectEntry> {
    let (action, knots, values) = knots_and_values(config)?;
    let Action { place, coordinate } = action;
    let text = |words: &str| EffectValue::Text(words.to_owned());
    let list = |numbers: &[f64]| EffectValue::List(numbers.to_vec());
    let one = |(key, value): (&str, EffectValue)| EffectParameter {
        key: key.to_owned(),
        line: 0,
        value,
    };
    let parameters = [
        (PLACE, text(place.name())),
        (COORDINATE, text(coordinate.name())),
        (coordinate.key(), list(knots)),
        (place.quantity(coordinate).key, list(values)),
    ];
    Some(EffectEntry {
        name: NAME.to_owned(),
        line: 0,
        parameters: parameters.map(one).into(),
    })
}

fn chosen<T>(
    entry: &EffectEntry,
    key: &'static str,
    by_name: impl Fn(&str) -> Option<T>,
    names: &[&str],
) -> Result<T, EffectError> {
    let wrong = |reason: String| EffectError::Curve { key, reason };
    let known = names.join(", ");
    let name = entry
        .text(key)
        .ok_or_else(|| wrong(format!("give one of: {known}")))?;
    by_name(name).ok_or_else(|| wrong(format!("`{name}` is not one of: {known}")))
}

fn list<'e>(entry: &'e EffectEntry, key: &'static str) -> Result<&'e [f64], EffectError> {
    match entry.parameter(key).map(|p| &p.value) {
        Some(EffectValue::List(list)) => Ok(list),
        _ => Err(EffectError::Curve {
            key,
            reason: "give a list of numbers".to_owned(),
        }),
    }
}
