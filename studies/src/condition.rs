//! Where a study judges its machines.

use crate::drive::{DRIVES, Drive};

/// At rest or in motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condition {
    /// Load, voltage and frequency, shares of what the study counts them by.
    AtRest([f64; 3]),
    /// Voltage, share of the rated one.
    InMotion(Drive, f64),
}

impl Condition {
    /// Those at rest, or every drive at each of these voltages.
    pub fn all(moving: bool, at_rest: &[[f64; 3]], voltages: [f64; 3]) -> Vec<Condition> {
        if !moving {
            return at_rest.iter().copied().map(Condition::AtRest).collect();
        }
        let of = |drive| voltages.map(|volt| Condition::InMotion(drive, volt));
        DRIVES.into_iter().flat_map(of).collect()
    }

    /// What heads the first columns of a table; `load`: what the load is a share of, in words.
    pub fn head(moving: bool, load: &str) -> String {
        match moving {
            true => "drive | voltage".to_owned(),
            false => format!("{load} | voltage | frequency"),
        }
    }

    /// The first columns of its row.
    pub fn row(self) -> String {
        match self {
            Condition::AtRest([load, volt, hertz]) => format!("{load} | {volt} | {hertz}"),
            Condition::InMotion(drive, volt) => format!("{} | {volt}", drive.name()),
        }
    }
}
