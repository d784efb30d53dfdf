//! An effect of a motor file: validated once, used without checks afterwards.

use crate::effect::{Effect, Parameter, Rated, Role};
use crate::effects::{find, names};
use core::fmt;

/// An effect with values for its parameters (inside values, in the order of the descriptor).
#[derive(Clone, Debug)]
pub struct EffectConfig {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Values inside: zero sizes mean that the effect is absent.
    pub values: Vec<f64>,
}

impl fmt::Debug for dyn Effect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.descriptor().name)
    }
}

/// Why an `[[effects]]` entry of a motor file cannot be used.
#[derive(Clone, Debug, PartialEq)]
pub enum EffectError {
    /// No effect has this name (or this form).
    UnknownEffect {
        /// The name that was given.
        name: String,
        /// Names that exist.
        known: Vec<&'static str>,
    },
    /// The effect has no such parameter.
    UnknownParameter {
        /// The effect.
        effect: &'static str,
        /// The key that was given.
        key: String,
        /// Keys that exist.
        known: Vec<&'static str>,
    },
    /// A size was not given.
    MissingParameter {
        /// The effect.
        effect: &'static str,
        /// The missing key.
        key: &'static str,
        /// Its unit.
        unit: &'static str,
    },
    /// Text stands where a number belongs.
    NotANumber {
        /// The effect.
        effect: &'static str,
        /// The key.
        key: String,
    },
    /// A number stands where text belongs.
    NotAText {
        /// The effect.
        effect: &'static str,
        /// The key.
        key: &'static str,
    },
    /// A value lies outside its range for this machine.
    OutOfRange {
        /// The effect.
        effect: &'static str,
        /// The key.
        key: &'static str,
        /// The value that was given.
        value: f64,
        /// Lowest and highest allowed value, as written in files.
        range: [f64; 2],
    },
    /// A curve cannot be used.
    Curve {
        /// The key to blame.
        key: &'static str,
        /// What is wrong with it.
        reason: String,
    },
    /// A formula cannot be understood.
    Formula {
        /// The formula.
        formula: String,
        /// What is wrong with it.
        reason: String,
    },
}

impl fmt::Display for EffectError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownEffect { name, known } => {
                write!(
                    f,
                    "no effect is called `{name}`; use one of: {}",
                    known.join(", ")
                )
            }
            Self::UnknownParameter { effect, key, known } => {
                let known = known.join(", ");
                write!(
                    f,
                    "effect `{effect}` has no parameter `{key}`; it has: {known}"
                )
            }
            Self::MissingParameter { effect, key, unit } => {
                write!(f, "effect `{effect}` needs `{key}` ({unit})")
            }
            Self::NotANumber { effect, key } => {
                write!(
                    f,
                    "`{key}` of effect `{effect}` must be one number, without quotes or brackets"
                )
            }
            Self::NotAText { effect, key } => {
                write!(
                    f,
                    "`{key}` of effect `{effect}` must be text: write it in double quotes"
                )
            }
            Self::OutOfRange {
                effect,
                key,
                value,
                range,
            } => {
                let [low, high] = range;
                write!(
                    f,
                    "`{key}` = {value} of effect `{effect}` must lie in {low:.6e} .. {high:.6e}"
                )
            }
            Self::Curve { key, reason } => write!(f, "`{key}` of effect `curve`: {reason}"),
            Self::Formula { formula, reason } => {
                write!(f, "formula `{formula}` cannot be used: {reason}")
            }
        }
    }
}

impl core::error::Error for EffectError {}

impl EffectError {
    /// The key of the entry to blame.
    pub fn key(&self) -> &str {
        match self {
            Self::UnknownEffect { .. } => "name",
            Self::Formula { .. } => "formula",
            Self::UnknownParameter { key, .. } | Self::NotANumber { key, .. } => key,
            Self::MissingParameter { key, .. }
            | Self::Curve { key, .. }
            | Self::NotAText { key, .. }
            | Self::OutOfRange { key, .. } => key,
        }
    }
}

impl EffectConfig {
    /// Every size zero, every shape at its start value.
    pub fn absent(effect: &'static dyn Effect, rated: &Rated<f64>) -> Self {
        let start = |p: &Parameter| match p.role {
            Role::Size => 0.0,
            Role::Shape | Role::Form => p.typical * p.scale.of(rated),
        };
        let values = effect.descriptor().parameters.iter().map(start).collect();
        Self { effect, values }
    }

    /// Every parameter at its typical value for this machine.
    pub fn typical(effect: &'static dyn Effect, rated: &Rated<f64>) -> Self {
        let typical = |p: &Parameter| p.typical * p.scale.of(rated);
        let values = effect.descriptor().parameters.iter().map(typical).collect();
        Self { effect, values }
    }

    /// From the keys and values of a motor file; `form` chooses between several forms of one effect.
    ///
    /// # Errors
    /// An unknown name, key or form, a missing size, a value out of range for a machine rated `rated`.
    pub fn from_file(
        name: &str,
        form: &str,
        entries: &[(String, f64)],
        rated: &Rated<f64>,
    ) -> Result<Self, EffectError> {
        Self::with_entries(known_effect(name, form)?, entries, rated)
    }

    /// From a known effect and the keys and values of a motor file.
    ///
    /// # Errors
    /// As [`EffectConfig::from_file`].
    pub fn with_entries(
        effect: &'static dyn Effect,
        entries: &[(String, f64)],
        rated: &Rated<f64>,
    ) -> Result<Self, EffectError> {
        let descriptor = effect.descriptor();
        let known = || descriptor.parameters.iter().map(|p| p.name);
        if let Some((key, _)) = entries.iter().find(|(k, _)| !known().any(|n| n == k)) {
            return Err(EffectError::UnknownParameter {
                effect: descriptor.name,
                key: key.clone(),
                known: known().collect(),
            });
        }
        let value = |p: &'static Parameter| one_value(descriptor.name, p, entries, rated);
        let values: Result<_, _> = descriptor.parameters.iter().map(value).collect();
        Ok(Self {
            effect,
            values: values?,
        })
    }

    /// Keys and values as a motor file has them.
    pub fn to_file(&self) -> Vec<(&'static str, f64)> {
        let parameters = self.effect.descriptor().parameters.iter();
        parameters
            .zip(&self.values)
            .map(|(p, &v)| (p.name, p.to_file(v)))
            .collect()
    }
}

/// The effect of this name and form.
pub(super) fn known_effect(name: &str, form: &str) -> Result<&'static dyn Effect, EffectError> {
    find(name, form).ok_or_else(|| EffectError::UnknownEffect {
        name: joined(name, form),
        known: names(),
    })
}

fn joined(name: &str, form: &str) -> String {
    if form.is_empty() {
        name.to_owned()
    } else {
        format!("{name}` with form `{form}")
    }
}

/// The value of one parameter: given and in range, or its default.
fn one_value(
    effect: &'static str,
    p: &'static Parameter,
    entries: &[(String, f64)],
    rated: &Rated<f64>,
) -> Result<f64, EffectError> {
    let scale = p.scale.of(rated);
    let Some(&(_, written)) = entries.iter().find(|(key, _)| key == p.name) else {
        return match p.role {
            Role::Size => Err(EffectError::MissingParameter {
                effect,
                key: p.name,
                unit: p.unit,
            }),
            Role::Shape | Role::Form => Ok(p.typical * scale),
        };
    };
    let [low, high] = p.range.map(|x| x * scale);
    let value = p.from_file(written);
    if value.is_finite() && (low..=high).contains(&value) {
        return Ok(value);
    }
    let (a, b) = (p.to_file(low), p.to_file(high));
    Err(EffectError::OutOfRange {
        effect,
        key: p.name,
        value: written,
        range: [a.min(b), a.max(b)],
    })
}
