//! `sim-host demo`: the method at work on a simulated motor, without what reads recordings.

use std::error::Error;
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
    /// Write every number as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// The assumed motor of the published bench.
const ASSUMED_MOTOR: &str = include_str!("../../motors/assumed-300w.toml");

impl Demo {
    fn run(&self) -> Result<(), Box<dyn Error>> {
        let motor = self
            .motor
            .as_deref()
            .map_or_else(assumed_motor, motor_file)?;
        let experiments = Some(demo::EXPERIMENTS as u64);
        let bar = ProgressBar::with_draw_target(experiments, ProgressDrawTarget::stderr());
        let result = demo::run(&motor, self.seed, || bar.inc(1))?;
        bar.finish_and_clear();
        if let Some(path) = &self.json {
            let text = serde_json::to_string_pretty(&result)? + "\n";
            fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))?;
        }
        Ok(write!(io::stdout().lock(), "{result}")?)
    }
}

fn assumed_motor() -> Result<MotorFile, Box<dyn Error>> {
    Ok(MotorFile::parse(ASSUMED_MOTOR, "motors/assumed-300w.toml")?)
}

fn motor_file(path: &Path) -> Result<MotorFile, Box<dyn Error>> {
    let name = path.display().to_string();
    let text = fs::read_to_string(path).map_err(|error| format!("{name}: {error}"))?;
    Ok(MotorFile::parse(&text, &name)?)
}

fn main() -> ExitCode {
    let Command::Demo(demo) = Command::parse();
    match demo.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(io::stderr(), "error: {error}");
            ExitCode::from(2)
        }
    }
}
