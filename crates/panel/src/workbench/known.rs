//! The motor of the first check, as it is known before recordings teach anything of it.

use std::collections::BTreeMap;

use report::study::Known;
use serde::Serialize;

/// Texts of a plate by their keys, as they were typed.
pub(super) type Typed = BTreeMap<String, String>;

/// The motor of the first check.
#[derive(Clone, Debug)]
pub(super) struct Checked {
    /// What is known of it.
    pub known: Known,
    /// What was typed; empty where a motor file was given.
    pub typed: Typed,
}

/// What the page shows of it.
#[derive(Debug, Serialize)]
pub(super) struct CheckView {
    name: String,
    by_plate: bool,
    calibrated: bool,
    contradictions: Vec<String>,
    typed: Typed,
}

impl Checked {
    pub fn view(&self) -> CheckView {
        CheckView {
            name: self.known.motor.name.clone(),
            by_plate: !self.known.plate.is_empty(),
            calibrated: self.known.motor.healthy.is_some(),
            contradictions: self.known.contradictions.clone(),
            typed: self.typed.clone(),
        }
    }
}
