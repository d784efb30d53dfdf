//! The sidecar of a recording: `x.toml` beside `x.csv.gz`.

mod columns;
mod sensors;

use super::Mapping;
use crate::data::metadata::{LoadTorque, Metadata, Sensors, StartsFrom, Supply, VoltageKind};
use crate::error::{Error, Problem};
use crate::names::sidecar_path;
use columns::mapping;
use document::{Document, FileError, Section, read_text};
use sensors::sensors;
use std::path::Path;

/// What a sidecar says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sidecar {
    /// What is known beside the samples.
    pub metadata: Metadata,
    /// How the columns are to be read.
    pub mapping: Mapping,
}

impl Sidecar {
    /// Reads the sidecar beside a recording; without one, the defaults.
    ///
    /// # Errors
    /// All problems of the file, each with line, key and remedy.
    pub fn beside(recording: &Path) -> Result<Sidecar, Error> {
        let path = sidecar_path(recording);
        if path.exists() {
            Sidecar::read(&path)
        } else {
            Ok(Sidecar::default())
        }
    }

    /// Reads a sidecar.
    ///
    /// # Errors
    /// All problems of the file, each with line, key and remedy.
    pub fn read(path: &Path) -> Result<Sidecar, Error> {
        let file = path.display().to_string();
        if std::fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() == 0) {
            let remedy = "remove it, or write for example voltage = \"instantaneous\"";
            return Err(Error::bad(&file, "the sidecar is empty", remedy));
        }
        Sidecar::parse(&read_text(path)?, &file)
    }

    /// Reads the text of a sidecar; `file` is the name that errors print.
    ///
    /// # Errors
    /// All problems of the text, each with line, key and remedy.
    pub fn parse(text: &str, file: &str) -> Result<Sidecar, Error> {
        let document = Document::parse(text, file)?;
        let root = document.root();
        if root.has("nameplate") {
            return Err(motor_file(file, root.line_of("nameplate")));
        }
        let sidecar = sidecar(root);
        Ok(document.finish(sidecar)?)
    }
}

fn motor_file(file: &str, line: usize) -> Error {
    let remedy = "rename one of the two: the sidecar of x.csv is always x.toml beside it";
    let message = "this is a motor file, not the sidecar of the recording of the same name";
    Error::at(file, line as u64, "nameplate", message, remedy)
}

impl From<FileError> for Error {
    fn from(error: FileError) -> Error {
        let problems = error.problems().iter().map(|problem| Problem {
            file: problem.file.clone(),
            line: problem.line as u64,
            field: problem.key.clone(),
            message: problem.message.clone(),
            remedy: String::new(),
        });
        Error::of(problems.collect())
    }
}

const VOLTAGE: [(&str, VoltageKind); 2] = [
    ("instantaneous", VoltageKind::Instantaneous),
    ("hold", VoltageKind::Hold),
];
const SUPPLY: [(&str, Supply); 2] = [("grid", Supply::Grid), ("inverter", Supply::Inverter)];
const LOAD: [(&str, LoadTorque); 3] = [
    ("measured", LoadTorque::Measured),
    ("friction", LoadTorque::Friction),
    ("free", LoadTorque::Free),
];
const STARTS: [(&str, StartsFrom); 5] = [
    ("standstill", StartsFrom::Standstill),
    ("running", StartsFrom::Running),
    ("steady", StartsFrom::Running),
    ("steady-state", StartsFrom::Running),
    ("unknown", StartsFrom::Unknown),
];

fn sidecar(root: Section<'_>) -> Option<Sidecar> {
    let mut scales = Mapping::default();
    let metadata = metadata(&root, &mut scales);
    let mapping = mapping(&root, scales);
    root.finish();
    Some(Sidecar {
        metadata: metadata?,
        mapping: mapping?,
    })
}

fn metadata(root: &Section<'_>, scales: &mut Mapping) -> Option<Metadata> {
    let voltage = root.choice_or("voltage", &VOLTAGE, VoltageKind::default());
    let supply = root.choice_or("supply", &SUPPLY, Supply::default());
    let belief = root.optional_text("supply_belief");
    let load_torque = root.choice_or("load_torque", &LOAD, LoadTorque::default());
    let starts_from = root.choice_or("starts_from", &STARTS, StartsFrom::default());
    let sensors = match root.optional_section("sensors")? {
        Some(section) => sensors(section, scales)?,
        None => Sensors::default(),
    };
    Some(Metadata {
        voltage: voltage?,
        supply: supply?,
        supply_belief: belief?.unwrap_or_default(),
        load_torque: load_torque?,
        starts_from: starts_from?,
        sensors,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::channel::Channel;
    use crate::mapping::{Factor, Target};

    #[test]
    fn every_key_is_read() {
        let text = r#"
            voltage = "hold"
            supply = "inverter"
            supply_belief = "ideal"
            load_torque = "friction"
            starts_from = "standstill"
            line_voltages = true
            sample_rate_hz = 5000
            skip_missing = true
            decimal_comma = true
            delimiter = "tab"
            [sensors]
            voltage_full_scale_volt = 600.0
            adc_bits = 12
            encoder_pulses_per_revolution = 1024
            encoder_edges_per_pulse = 2
            encoder_counter_bits = 16
            [columns]
            ic = "ic2"
            ia = { delay_us = 11.55 }
            speed = { name = "n", unit = "rpm", scale = 1.02, offset = -2.1 }
        "#;
        let Sidecar { metadata, mapping } = Sidecar::parse(text, "x.toml").unwrap();
        assert_eq!(metadata.voltage, VoltageKind::Hold);
        assert_eq!(metadata.supply, Supply::Inverter);
        assert_eq!(metadata.load_torque, LoadTorque::Friction);
        assert_eq!(metadata.starts_from, StartsFrom::Standstill);
        assert_eq!(metadata.sensors.adc_bits, Some(12));
        assert_eq!(metadata.sensors.encoder_edges_per_pulse, Some(2));
        assert_eq!(
            (mapping.line_voltages, mapping.delimiter),
            (Some(true), Some(b'\t'))
        );
        let speed = &mapping.columns[&Target::Channel(Channel::SPEED)];
        assert_eq!(
            (speed.scale, speed.offset),
            (Some(Factor::Known(1.02)), Some(-2.1))
        );
        let ic = &mapping.columns[&Target::Channel(Channel::CURRENTS[2])];
        assert_eq!(ic.name.as_deref(), Some("ic2"));
        let ia = &mapping.columns[&Target::Channel(Channel::CURRENTS[0])];
        assert!((ia.delay.unwrap() - 11.55e-6).abs() < 1e-18);
    }

    #[test]
    fn only_the_factor_of_the_speed_may_be_unknown() {
        let text = "[columns.speed]\nscale = \"unknown\"";
        let mapping = Sidecar::parse(text, "x.toml").unwrap().mapping;
        let speed = &mapping.columns[&Target::Channel(Channel::SPEED)];
        assert_eq!(speed.scale, Some(Factor::Unknown));
        for (text, expected) in [
            ("[columns.ia]\nscale = \"unknown\"", "ia cannot be unknown"),
            ("[columns.speed]\nscale = \"unknwon\"", "scale"),
        ] {
            let error = Sidecar::parse(text, "x.toml").unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }

    #[test]
    fn what_is_not_said_stays_open() {
        let sidecar = Sidecar::parse("voltage = \"instantaneous\"", "x.toml").unwrap();
        assert_eq!(sidecar, Sidecar::default());
    }
}
