//! A motor with its adopted effects as a dynamic model in other languages.
//!
//! [`model::model_of`] writes the equations of a motor file as expressions ([`algebra`]), each effect its own ([`effects`]); [`mod@print`] has one
//! printer for each language.

pub mod algebra;
pub mod circuit_forms;
pub mod effects;
pub mod model;
pub mod print;

/// Why a model is not exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The effects of the motor file.
    #[error(transparent)]
    File(#[from] motor::FileError),
    /// An effect whose equations are not written for other languages.
    #[error(
        "effect `{effect}` cannot be exported: {reason}; export the model without it: --without {effect}"
    )]
    NoEquations {
        /// The effect.
        effect: String,
        /// Why.
        reason: &'static str,
    },
    /// A formula that is not understood.
    #[error(
        "formula `{formula}` cannot be exported: {reason}; or export the model without it: --without expression"
    )]
    Formula {
        /// The formula.
        formula: String,
        /// Why.
        reason: effects::NotWritten,
    },
    /// A name that the motor file does not have.
    #[error(
        "--without {name}: the motor file has no such effect; it has: {}",
        list(known)
    )]
    NotThere {
        /// The name.
        name: String,
        /// Names that there are.
        known: Vec<String>,
    },
    /// A motor without leakage on one side.
    #[error(
        "a leakage of 0 H and saturation or a second cage cannot go together, in the simulation either: \
         give stator_leakage_henry and rotor_leakage_henry a part of the leakage each"
    )]
    NoLeakage,
    /// An archive that cannot be packed.
    #[error("the archive cannot be packed: {0}")]
    Archive(String),
    /// What a language cannot hold.
    #[error(
        "effect `{effect}` cannot be written for {language}: {reason}; export the model without it: --without {effect}"
    )]
    Language {
        /// The effect.
        effect: String,
        /// The language.
        language: &'static str,
        /// Why.
        reason: &'static str,
    },
    /// A parameter that is no number.
    #[error(
        "parameter `{parameter}` is infinite in this motor file: give it a finite value, or leave its effect out with --without"
    )]
    NotFinite {
        /// The parameter.
        parameter: String,
    },
}

fn list(names: &[String]) -> String {
    match names.is_empty() {
        true => "none".to_owned(),
        false => names.join(", "),
    }
}
