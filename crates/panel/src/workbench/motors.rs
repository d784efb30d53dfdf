//! The motor file on the desk.

use motor::MotorFile;
use serde::Serialize;

use crate::running::fields::problems;
use crate::running::shared::Refusal;
use report::motor_text;
use report::study::effects_fit;

/// A shipped motor file.
macro_rules! shipped {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../../../motors/", $name)))),*]
    };
}

/// Every motor file of the folder `motors`.
pub(super) const SHIPPED: [(&str, &str); 11] = shipped![
    "assumed-300w.toml",
    "assumed-300w-calibrated.toml",
    "chalmers-4kw.toml",
    "chalmers-4kw-calibrated.toml",
    "imc-18k5.toml",
    "itsc-075hp.toml",
    "peer-2k2.toml",
    "peer-2k2-calibrated.toml",
    "peer-2k2-saturating.toml",
    "peer-2k2-saturating-calibrated.toml",
    "published-300w.toml",
];

/// A motor file.
#[derive(Clone, Debug)]
pub(super) struct Motor {
    /// Its name.
    pub file: String,
    /// Its text, comments included.
    pub text: String,
    /// What it says.
    pub motor: MotorFile,
    /// What was adopted to get here; `None` for a file as it was given.
    pub adopted: Option<String>,
}

/// What the page shows of it.
#[derive(Debug, Serialize)]
pub(super) struct MotorView {
    /// Name of the motor.
    name: String,
    /// Name of the file.
    file: String,
    /// Effects that its model has.
    effects: Vec<String>,
    /// What was adopted on this desk, the first first.
    adopted: Vec<String>,
    /// Rated frequency, Hz.
    frequency_hz: f64,
}

impl Motor {
    /// Reads a motor file.
    pub fn parse(file: &str, text: &str) -> Result<Motor, Refusal> {
        let motor = MotorFile::parse(text, file).map_err(|error| Refusal {
            problems: problems(&error),
            ..Refusal::of(error.to_string())
        })?;
        effects_fit(file, &motor).map_err(Refusal::of)?;
        Ok(Motor {
            file: file.to_owned(),
            text: text.to_owned(),
            motor,
            adopted: None,
        })
    }

    /// What the panel judges with.
    pub fn of_panel(motor: MotorFile) -> Motor {
        Motor {
            file: "panel.toml".into(),
            text: motor.to_toml(),
            motor,
            adopted: None,
        }
    }

    /// The file with an effect added; comments stay.
    pub fn with(&self, effect: &str, motor: MotorFile) -> Motor {
        let stem = self.file.trim_end_matches(".toml");
        Motor {
            file: format!("{stem}-{effect}.toml"),
            text: motor_text::updated(&self.text, &motor),
            motor,
            adopted: Some(effect.to_owned()),
        }
    }

    /// The file with what recordings of the motor in good order taught.
    pub fn learnt(&self, motor: MotorFile) -> Motor {
        Motor {
            file: self.file.clone(),
            text: motor.to_toml(),
            motor,
            adopted: self.adopted.clone(),
        }
    }

    pub fn view(&self, before: &[Motor]) -> MotorView {
        let steps = before.iter().chain([self]);
        MotorView {
            name: self.motor.name.clone(),
            file: self.file.clone(),
            effects: self
                .motor
                .effects
                .iter()
                .map(|effect| effect.name.clone())
                .collect(),
            adopted: steps.filter_map(|motor| motor.adopted.clone()).collect(),
            frequency_hz: self.motor.nameplate.frequency_hz,
        }
    }
}

/// Names of the shipped motor files.
pub(super) fn shipped_names() -> Vec<&'static str> {
    SHIPPED.iter().map(|(name, _)| *name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_motor_file_can_be_chosen() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../motors");
        let entries = std::fs::read_dir(folder).expect("motors");
        let mut there: Vec<String> = entries
            .map(|entry| {
                entry
                    .expect("a file")
                    .file_name()
                    .to_string_lossy()
                    .into_owned()
            })
            .filter(|name| name.ends_with(".toml"))
            .collect();
        there.sort();
        let mut known = shipped_names();
        known.sort_unstable();
        assert_eq!(known, there, "each file of motors/ stands in SHIPPED");
        for (name, text) in SHIPPED {
            assert!(Motor::parse(name, text).is_ok(), "{name}");
        }
    }

    #[test]
    fn a_motor_file_that_is_none_is_refused_with_the_readers_words() {
        let refusal = Motor::parse("m.toml", "name = 3").expect_err("no motor");
        assert!(refusal.message.contains("m.toml:1"), "{}", refusal.message);
        assert!(!refusal.problems.is_empty());
    }
}
