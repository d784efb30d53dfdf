//! The next experiment: what supply and load can do, and where its scenario file goes.

use clap::Args;
use discovery::{DesignReport, Limits, NextRun};
use motor::MotorFile;
use std::path::{Path, PathBuf};

use super::files::Files;
use crate::cli::printing::failure::Failure;
use crate::cli::printing::output::write_text;
use document::read_text;

/// Flags of the next experiment.
#[derive(Debug, Args)]
pub struct NextRunArgs {
    /// Design the run that decides best what these recordings leave open: instructions, and a scenario file to simulate it
    #[arg(long, value_name = "RUN.toml")]
    design: Option<PathBuf>,
    /// TOML file with what supply and load can do; without it a grid, loads up to rated torque, a start and a coast-down
    #[arg(long, value_name = "FILE", requires = "design")]
    limits: Option<PathBuf>,
}

impl NextRunArgs {
    /// The files among those that are read and written.
    pub fn files(&self, mut files: Files) -> Files {
        if let Some(path) = &self.limits {
            files = files.reads("the file of --limits", path);
        }
        match &self.design {
            Some(path) => files.writes("--design", path),
            None => files,
        }
    }

    /// What is asked for; `path` is the motor file's.
    ///
    /// # Errors
    /// A file of limits that cannot be read, and everything that is wrong with it.
    pub fn asked(&self, motor: &MotorFile, path: &Path) -> Result<Option<NextRun>, Failure> {
        let Some(out) = &self.design else {
            return Ok(None);
        };
        let rated = motor.nameplate.frequency_hz;
        let limits = match &self.limits {
            None => Limits::usual(false, rated),
            Some(path) => Limits::parse(&read_text(path)?, &path.display().to_string(), rated)?,
        };
        Ok(Some(NextRun {
            limits,
            motor_file: from(out, path).display().to_string(),
        }))
    }

    /// Writes the scenario file of a designed run, and says where it is.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, design: Option<&DesignReport>) -> Result<Option<&Path>, Failure> {
        match (&self.design, design) {
            (Some(path), Some(design)) => {
                write_text(path, &design.scenario)?;
                Ok(Some(path))
            }
            _ => Ok(None),
        }
    }
}

/// The motor file as a scenario file at `out` finds it: scenario files name it from their own folder.
fn from(out: &Path, motor: &Path) -> PathBuf {
    let here = out
        .parent()
        .is_none_or(|folder| folder.as_os_str().is_empty());
    match here {
        true => motor.to_owned(),
        false => motor.canonicalize().unwrap_or_else(|_| motor.to_owned()),
    }
}
