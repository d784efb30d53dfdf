//! `drivemon export`: a motor with its adopted effects as a model in another language.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use export::ExportError;
use export::model::model_of;
use export::print::{self, File, Job, Language, Library};
use motor::MotorFile;

use crate::cli::arguments::files::Files;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::write_bytes;
use crate::cli::printing::terminal::say;

/// Write a motor with its adopted effects as a dynamic model in another language.
///
/// The model has the equations of the simulation, effects of the motor file included: with the same inputs and the same step it does
/// the same. An effect that a language cannot hold is an error that names it, never a poorer model. For motulator and
/// gym-electric-motor, whose motors are linear, parameters are written by their names, and which effects are lost is said.
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
  drivemon export motors/peer-2k2-saturating.toml --to fmu -o motor.fmu
  drivemon export motor.toml --to c -o motor.c --without sensor-filter

Inputs are phase voltages (V), load torque (N m) and the supply frequency (rad/s, needed by effects of slip and frequency).
docs/export.md says what each language gets.";

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
    /// A functional mock-up unit, FMI 2.0, for co-simulation and model exchange; compiled where there is a C compiler
    Fmu,
    /// Parameters by motulator's names, a Python file
    Motulator,
    /// Parameters by gym-electric-motor's names, a Python file
    GymElectricMotor,
}

/// What is written.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Model(Language),
    Parameters(Library),
}

impl To {
    /// Keeps the Python files of one motor apart.
    fn suffix(self) -> &'static str {
        match self {
            To::Motulator => "_motulator",
            To::GymElectricMotor => "_gym_electric_motor",
            _ => "",
        }
    }

    fn kind(self) -> Kind {
        match self {
            To::Python => Kind::Model(Language::Python),
            To::C => Kind::Model(Language::C),
            To::Matlab => Kind::Model(Language::Matlab),
            To::Modelica => Kind::Model(Language::Modelica),
            To::Fmu => Kind::Model(Language::Fmu),
            To::Motulator => Kind::Parameters(Library::Motulator),
            To::GymElectricMotor => Kind::Parameters(Library::GymElectricMotor),
        }
    }
}

impl Kind {
    fn ending(self) -> &'static str {
        match self {
            Kind::Model(language) => language.ending(),
            Kind::Parameters(_) => "py",
        }
    }

    /// The files that are written: the named one, and those beside it.
    fn written(self, path: &Path) -> Vec<PathBuf> {
        let beside = match self {
            Kind::Model(language) => language.beside(),
            Kind::Parameters(_) => &[],
        };
        let beside = beside.iter().map(|ending| path.with_extension(ending));
        std::iter::once(path.to_owned()).chain(beside).collect()
    }
}

impl Export {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        let kind = self.to.kind();
        let path = self.path(kind.ending())?;
        let files = kind.written(&path);
        let check = Files::default().reads("the motor file", &self.motor);
        let check = files
            .iter()
            .fold(check, |check, path| check.writes("-o", path));
        check.check()?;
        let motor = MotorFile::read(&self.motor)?;
        let made = self
            .made(kind, &motor, stem(&path))
            .map_err(|error| Failure::Usage(format!("{}: {error}", self.motor.display())))?;
        for (path, file) in files.iter().zip(&made) {
            write_bytes(path, &file.content)?;
        }
        let names: Vec<_> = files
            .iter()
            .map(|path| path.display().to_string())
            .collect();
        say!("{}: written", names.join(", "));
        for remark in made.iter().flat_map(|file| &file.remarks) {
            say!("  {remark}");
        }
        Ok(Finding::Nothing)
    }

    fn made(&self, kind: Kind, motor: &MotorFile, name: String) -> Result<Vec<File>, ExportError> {
        let label = self.motor.display().to_string();
        let job = Job {
            name,
            source: &label,
            version: env!("CARGO_PKG_VERSION"),
        };
        match kind {
            Kind::Model(language) => {
                let model = model_of(motor, &label, &self.without)?;
                print::files(&model, language, &job)
            }
            Kind::Parameters(library) => Ok(vec![print::parameters(
                motor,
                library,
                &self.without,
                &job,
            )?]),
        }
    }

    /// The file to write.
    fn path(&self, ending: &str) -> Result<PathBuf, Failure> {
        let path = match &self.output {
            Some(path) => path.clone(),
            None => PathBuf::from(format!(
                "{}{}.{ending}",
                print::model_name(&stem(&self.motor)),
                self.to.suffix()
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
                "-o {}: the file's name becomes the model's, which has letters, digits and underlines only and is no word of a \
                 language; call it {plain}.{ending}",
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
