//! `sim-host demo`: the method at work on a simulated motor, without what reads recordings.

use std::error::Error;
use std::ffi::OsString;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Parser};
use indicatif::{ProgressBar, ProgressDrawTarget};
use motor::MotorFile;
use sim_host::demo;

/// The method at work on a simulated motor. All other commands: `cargo drivemon --help`.
#[derive(Debug, Parser)]
#[command(version, about, arg_required_else_help = true)]
enum Command {
    Demo(Demo),
    #[command(external_subcommand)]
    Other(Vec<OsString>),
}

/// Show the published method at work: healthy motor and every fault of Table 1, through the board's core.
///
/// `cargo drivemon demo` prints the same; it also writes a page for the browser (--report).
#[derive(Debug, Args)]
struct Demo {
    /// Motor file to demonstrate on instead of the assumed 300 W motor
    #[arg(long, value_name = "M")]
    motor: Option<PathBuf>,
    /// Seed of the sensor noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write every number as JSON into a new file
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl Demo {
    fn run(&self) -> Result<(), Box<dyn Error>> {
        let motor = match &self.motor {
            Some(path) => MotorFile::read(path)?,
            None => demo::assumed_motor()?,
        };
        let experiments = Some(demo::EXPERIMENTS as u64);
        let bar = ProgressBar::with_draw_target(experiments, ProgressDrawTarget::stderr());
        let result = demo::run(&motor, self.seed, || bar.inc(1))?;
        bar.finish_and_clear();
        if let Some(path) = &self.json {
            write_new(path, &(serde_json::to_string_pretty(&result)? + "\n"))?;
        }
        match write!(io::stdout().lock(), "{result}") {
            // The reader has seen enough, as `head` does.
            Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error.into()),
            _ => Ok(()),
        }
    }
}

/// Never writes over what is there: it may be the motor file.
fn write_new(path: &Path, text: &str) -> Result<(), String> {
    let written = fs::File::create_new(path).and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|error| match error.kind() {
        io::ErrorKind::AlreadyExists => {
            format!(
                "{}: exists; name another file, or remove it",
                path.display()
            )
        }
        _ => format!("{}: {error}", path.display()),
    })
}

/// What to type for a command that this program does not have.
fn elsewhere(words: &[OsString]) -> String {
    let words: Vec<_> = words.iter().map(|word| word.to_string_lossy()).collect();
    let words = words.join(" ");
    format!("this program has `demo` only; for the others: cargo drivemon {words}")
}

fn main() -> ExitCode {
    let outcome = match Command::parse() {
        Command::Demo(demo) => demo.run(),
        Command::Other(words) => Err(elsewhere(&words).into()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(io::stderr(), "error: {error}");
            ExitCode::from(2)
        }
    }
}
