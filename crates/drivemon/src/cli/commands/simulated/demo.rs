//! `drivemon demo`: the method at work, without hardware.

use std::path::PathBuf;

use clap::Args;

use crate::cli::arguments::files::Files;
use crate::cli::arguments::input::read_motor;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::OutputArgs;
use crate::cli::printing::progress;
use crate::cli::printing::terminal::say;
use report::Subject;
use report::json::Answer;
use schemars::JsonSchema;
use serde::Serialize;
use sim_host::demo;

/// Show the published method at work: healthy motor and every fault of Table 1, through the board's core.
///
/// Each fault is switched into a simulated motor in both directions; lamps, residuals and probabilities are
/// what the board would show. Three plants and frames stand side by side: the paper's linear model (which
/// reproduces the published table), and the full three-phase motor in the rotor-flux and in the paper's voltage frame.
/// Sensor faults are put on the d-q signals, as the published bench does.
#[derive(Debug, Args)]
pub struct Demo {
    /// Motor file to demonstrate on instead of the assumed 300 W motor
    #[arg(long, value_name = "M")]
    motor: Option<PathBuf>,
    /// Seed of the sensor noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    output: OutputArgs,
}

/// What the demonstration measured.
#[derive(Debug, Serialize, JsonSchema)]
pub struct DemoJson {
    #[serde(flatten)]
    demo: demo::Demo,
}

impl Answer for DemoJson {
    const FORMAT: &'static str = "demo/1";
}

impl Demo {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        Files::default()
            .may_read("the motor file", self.motor.as_ref())
            .writes_results(&self.output)
            .check()?;
        let motor = match &self.motor {
            Some(path) => read_motor(path)?,
            None => demo::assumed_motor()?,
        };
        let bar = progress::bar("simulating", demo::EXPERIMENTS as u64);
        let result = demo::run(&motor, self.seed, || bar.inc(1));
        bar.finish_and_clear();
        let demo = result.map_err(|error| Failure::Usage(error.to_string()))?;
        let json = DemoJson { demo };
        let show = || say!("{}", json.demo);
        self.output.give(Subject::Demo, &json, show)?;
        Ok(Finding::Nothing)
    }
}
