//! `drivemon export`: a motor with its adopted effects as a model in another language.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use export::model::model_of;
use export::print::{self, File, Job, Language};
use motor::MotorFile;

use crate::cli::arguments::files::Files;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::write_bytes;
use crate::cli::printing::terminal::say;

/// Write a motor with its adopted effects as a dynamic model in another language.
///
/// The model has the equations of the simulation, effects of the motor file included: with the same inputs and the same step it does
/// the same. An effect that a language cannot hold is an error that names it, never a poorer model.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Export {
    /// Motor file, with the effects that were adopted
    #[arg(value_name = "MOTOR")]
    motor: PathBuf,
    /// What to write
    #[arg(long, value_name = "LANGUAGE")]
    to: To,
    /// File to write; its name becomes the name of the model [default: the motor file's name, in this folder]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Leave an effect of the motor file out; may be repeated
    #[arg(long, value_name = "EFFECT")]
    without: Vec<String>,
}

const EXAMPLES: &str = "\
Examples:
  drivemon export motors/peer-2k2-saturating.toml --to python -o motor.py
  python3 motor.py < inputs.csv > outputs.csv          columns t, u_a, u_b, u_c, tau_load, omega_sync
  drivemon export motor.toml --to c -o motor.c --without sensor-filter";

#[derive(Clone, Copy, Debug, ValueEnum)]
enum To {
    /// One file of plain functions, without libraries
    Python,
    /// C99: a source and a header
    C,
    /// A function file for MATLAB and Octave
    Matlab,
    /// A model of equations in Modelica
    Modelica,
    /// A functional mock-up unit, FMI 2.0, for co-simulation and model exchange
    Fmu,
}

impl To {
    fn language(self) -> Language {
        match self {
            To::Python => Language::Python,
            To::C => Language::C,
            To::Matlab => Language::Matlab,
            To::Modelica => Language::Modelica,
            To::Fmu => Language::Fmu,
        }
    }
}

impl Export {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        let language = self.to.language();
        let path = self.path(language)?;
        let files = written(&path, language);
        let check = Files::default().reads("the motor file", &self.motor);
        let check = files
            .iter()
            .fold(check, |check, path| check.writes("-o", path));
        check.check()?;
        let motor = MotorFile::read(&self.motor)?;
        let label = self.motor.display().to_string();
        let model =
            model_of(&motor, &label, &self.without).map_err(|error| self.refused(&error))?;
        let job = Job {
            name: stem(&path),
            source: &label,
            version: env!("CARGO_PKG_VERSION"),
        };
        let made = print::files(&model, language, &job).map_err(|error| self.refused(&error))?;
        for (path, file) in files.iter().zip(&made) {
            write_bytes(path, &file.content)?;
        }
        self.tell(&files, &made, &model.remarks);
        Ok(Finding::Nothing)
    }

    fn refused(&self, error: &export::ExportError) -> Failure {
        Failure::Usage(format!("{}: {error}", self.motor.display()))
    }

    fn tell(&self, files: &[PathBuf], made: &[File], remarks: &[String]) {
        let names: Vec<_> = files
            .iter()
            .map(|path| path.display().to_string())
            .collect();
        say!("{}: written", names.join(", "));
        for remark in remarks
            .iter()
            .chain(made.iter().flat_map(|file| &file.remarks))
        {
            say!("  {remark}");
        }
    }

    /// The file to write.
    fn path(&self, language: Language) -> Result<PathBuf, Failure> {
        let ending = language.ending();
        let path = match &self.output {
            Some(path) => path.clone(),
            None => PathBuf::from(format!(
                "{}.{ending}",
                print::model_name(&stem(&self.motor))
            )),
        };
        if path.extension() != Some(OsStr::new(ending)) {
            return Err(Failure::Usage(format!(
                "-o {}: name a file that ends with .{ending}",
                path.display()
            )));
        }
        let (name, plain) = (stem(&path), print::model_name(&stem(&path)));
        match name == plain {
            true => Ok(path),
            false => Err(Failure::Usage(format!(
                "-o {}: the file's name becomes the model's, which has letters, digits and underlines only and is no word of a language; \
                 call it {plain}.{ending}",
                path.display()
            ))),
        }
    }
}

fn stem(path: &Path) -> String {
    path.file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// The files that a language writes: the named one, and those beside it.
fn written(path: &Path, language: Language) -> Vec<PathBuf> {
    let beside = language
        .beside()
        .iter()
        .map(|ending| path.with_extension(ending));
    std::iter::once(path.to_owned()).chain(beside).collect()
}
