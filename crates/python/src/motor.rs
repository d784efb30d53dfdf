//! What is believed of a motor.

use crate::errors::{of_file, usage};
use ::motor::MotorFile;
use document::read_text;
use nameplate::plate::PlateFile;
use pyo3::prelude::*;
use report::motor_text;
use report::study::{Known, effects_fit};
use std::path::{Path, PathBuf};

/// A motor: its file, or its plate.
#[pyclass(frozen, from_py_object, module = "drivemon._drivemon")]
#[derive(Clone, Debug)]
pub struct Motor {
    pub known: Known,
    /// The text of the file, with the comments of its author.
    pub text: String,
    /// Where the file lies; nowhere for a text or a plate.
    pub path: Option<PathBuf>,
}

impl Motor {
    fn read(text: String, label: &str, path: Option<PathBuf>) -> PyResult<Motor> {
        let motor = MotorFile::parse(&text, label).map_err(|error| of_file(&error))?;
        effects_fit(label, &motor).map_err(usage)?;
        let known = Known::of_file(motor.clone(), motor.to_toml());
        Ok(Motor { known, text, path })
    }

    /// The same file with what was learnt; its author's comments stay.
    pub fn with(&self, motor: MotorFile, path: Option<&Path>) -> Motor {
        Motor {
            text: motor_text::updated(&self.text, &motor),
            known: Known::of_file(motor.clone(), motor.to_toml()),
            path: path.map(Path::to_owned),
        }
    }

    /// What a check learnt, as `drivemon check` writes it.
    pub fn learnt(motor: MotorFile, path: Option<&Path>) -> Motor {
        Motor {
            text: motor.to_toml(),
            known: Known::of_file(motor.clone(), motor.to_toml()),
            path: path.map(Path::to_owned),
        }
    }

    /// What errors call it.
    pub fn label(&self) -> String {
        let path = self.path.as_ref();
        path.map_or_else(|| "the motor".to_owned(), |path| path.display().to_string())
    }
}

#[pymethods]
impl Motor {
    #[staticmethod]
    fn from_file(path: PathBuf) -> PyResult<Motor> {
        let text = read_text(&path).map_err(|error| of_file(&error))?;
        let label = path.display().to_string();
        Motor::read(text, &label, Some(path))
    }

    #[staticmethod]
    fn from_text(text: String, name: &str) -> PyResult<Motor> {
        Motor::read(text, name, None)
    }

    /// Keys and texts in the order in which they are set: a code letter needs what it is a ratio to.
    #[staticmethod]
    fn from_nameplate(plate: Option<PathBuf>, numbers: Vec<(String, String)>) -> PyResult<Motor> {
        let mut file = match &plate {
            Some(path) => {
                let text = read_text(path).map_err(|error| of_file(&error))?;
                PlateFile::parse(&text, &path.display().to_string()).map_err(usage)?
            }
            None => PlateFile::default(),
        };
        for (key, text) in &numbers {
            file.set(key, text)
                .map_err(|problem| usage(format!("{key}: {problem}")))?;
        }
        let known = Known::of_plate(&file).map_err(usage)?;
        Ok(Motor {
            text: known.text.clone(),
            known,
            path: None,
        })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.known.motor.name
    }

    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    #[getter]
    fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    #[getter]
    fn contradictions(&self) -> Vec<String> {
        self.known.contradictions.clone()
    }

    #[getter]
    fn is_calibrated(&self) -> bool {
        self.known.motor.healthy.is_some()
    }

    /// Names of the effects in force.
    #[getter]
    fn effects(&self) -> Vec<String> {
        let effects = self.known.motor.effects.iter();
        effects.map(|effect| effect.name.clone()).collect()
    }

    /// Key, value, and the 95 % interval where one is known.
    fn parameters(&self) -> Vec<(String, f64, Option<f64>, Option<f64>)> {
        let rows = self.known.parameters().into_iter();
        rows.map(|row| (row.name, row.value, row.low, row.high))
            .collect()
    }

    fn __repr__(&self) -> String {
        format!("<drivemon.Motor \"{}\">", self.known.motor.name)
    }
}
