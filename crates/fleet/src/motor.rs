//! A motor of a plant: its name, and what people wrote about it.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Longest name of a motor, characters.
const LONGEST: usize = 64;

/// Name of a motor within its plant: 1 to 64 of `A-Z a-z 0-9 . _ -`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct MotorId(String);

/// Why a text is no name of a motor.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum MotorIdError {
    /// Nothing, or too much.
    #[error("a motor's name has 1 to 64 characters, this one has {0}")]
    Length(usize),
    /// A character that topics, paths and labels of metrics do not all take.
    #[error(
        "{text:?}: character {position} is {found:?}; a motor's name has only A-Z a-z 0-9 . _ -"
    )]
    Character {
        /// The text.
        text: String,
        /// The character.
        found: char,
        /// Its place, from 1.
        position: usize,
    },
    /// Names that a file system or a path of HTTP takes as a folder.
    #[error("{0:?} is no motor's name: use a letter or a digit too")]
    Dots(String),
}

impl MotorId {
    /// The name as text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl FromStr for MotorId {
    type Err = MotorIdError;

    fn from_str(text: &str) -> Result<Self, MotorIdError> {
        let length = text.chars().count();
        if !(1..=LONGEST).contains(&length) {
            return Err(MotorIdError::Length(length));
        }
        if let Some((at, found)) = text.chars().enumerate().find(|(_, c)| !fits(*c)) {
            let text = text.to_owned();
            return Err(MotorIdError::Character {
                text,
                found,
                position: at + 1,
            });
        }
        if text.chars().all(|c| c == '.') {
            return Err(MotorIdError::Dots(text.to_owned()));
        }
        Ok(Self(text.to_owned()))
    }
}

fn fits(c: char) -> bool {
    c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '-')
}

impl TryFrom<String> for MotorId {
    type Error = MotorIdError;

    fn try_from(text: String) -> Result<Self, MotorIdError> {
        text.parse()
    }
}

impl From<MotorId> for String {
    fn from(id: MotorId) -> Self {
        id.0
    }
}

impl fmt::Display for MotorId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}

/// What the gateway's configuration says of a motor. Words for people: nothing is computed from them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MotorInfo {
    /// Its name within the plant.
    pub id: MotorId,
    /// What people call it.
    pub title: String,
    /// The nameplate in words ("7.5 kW 400 V 50 Hz 1455 1/min").
    pub nameplate: String,
    /// Where it is.
    pub place: String,
    /// How it is reached ("modbus-tcp 10.0.0.7:502 unit 1").
    pub link: String,
    /// Absolute path of its motor file, where there is one.
    pub motor_file: Option<String>,
}

impl MotorInfo {
    /// A motor of which nothing but the name is known.
    pub fn new(id: MotorId) -> Self {
        Self {
            title: id.to_string(),
            id,
            nameplate: String::new(),
            place: String::new(),
            link: String::new(),
            motor_file: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_checked_where_they_are_read() {
        assert_eq!(
            "pump-7_a.B".parse::<MotorId>().unwrap().as_str(),
            "pump-7_a.B"
        );
        assert_eq!("".parse::<MotorId>(), Err(MotorIdError::Length(0)));
        assert_eq!(
            "m".repeat(65).parse::<MotorId>(),
            Err(MotorIdError::Length(65))
        );
        let error = "hall/7".parse::<MotorId>().unwrap_err();
        assert!(error.to_string().contains("character 5 is '/'"), "{error}");
        assert!("..".parse::<MotorId>().is_err());
        assert!(serde_json::from_str::<MotorId>("\"a b\"").is_err());
    }
}
