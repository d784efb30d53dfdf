//! Work on more than one machine: Ray through the Python package, and a script for Slurm.

use std::ffi::OsStr;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;

use campaign::slurm::{self, in_shell};
use clap::{Args, ValueEnum};

use crate::cli::printing::failure::Failure;

/// What does the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Engine {
    /// All cores of this machine
    Here,
    /// Tasks of Ray (pip install drivemon ray); a lost task is made again
    Ray,
    /// Does nothing, but prints a script that hands the work to Slurm as an array job
    Slurm,
}

/// Where the work is done.
#[derive(Debug, Args)]
pub struct EngineArgs {
    /// What does the work; the result has the same bytes
    #[arg(long, value_enum, default_value = "here")]
    pub engine: Engine,
    /// With --engine ray: a Ray cluster, or `auto` for the one that this machine belongs to; without it Ray starts here
    #[arg(long, value_name = "ADDRESS")]
    address: Option<String>,
    /// Time that a task of Ray or Slurm takes, s
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = task_seconds)]
    task_seconds: f64,
}

/// Below it the start of a task counts.
const SHORTEST_TASK_S: f64 = 10.0;

fn task_seconds(text: &str) -> Result<f64, String> {
    let number: Option<f64> = text.parse().ok();
    number
        .filter(|s| (SHORTEST_TASK_S..=86_400.0).contains(s))
        .ok_or_else(|| format!("write a time of {SHORTEST_TASK_S} to 86400 s"))
}

impl EngineArgs {
    /// Does the work with Ray, by a module of the Python package; the exit code that it ends with, 0 or 1, comes back.
    ///
    /// # Errors
    /// Python or one of the packages is missing, or the work could not be done.
    pub fn ray<W: AsRef<OsStr>>(&self, module: &str, words: &[W]) -> Result<i32, Failure> {
        let python = std::env::var_os("DRIVEMON_PYTHON").unwrap_or_else(|| "python3".into());
        // Whether Ray is there; its import takes more than half a second.
        let asks = format!(
            "import {module}, importlib.util, sys; sys.exit(importlib.util.find_spec('ray') is None)"
        );
        let has = Command::new(&python).args(["-c", &asks]).output();
        if !has.as_ref().is_ok_and(|has| has.status.success()) {
            return Err(Failure::Usage(format!(
                "--engine ray: {} does not have the packages drivemon and ray: install them (docs/python.md), or name another \
                 Python in DRIVEMON_PYTHON",
                python.display()
            )));
        }
        let mut command = Command::new(&python);
        command.args(["-m", module]).args(words);
        command.args(["--task-seconds", &self.task_seconds.to_string()]);
        if let Some(address) = &self.address {
            command.args(["--address", address]);
        }
        let ended = command.status().ok().and_then(|status| status.code());
        ended.filter(|code| [0, 1].contains(code)).ok_or_else(|| {
            Failure::Usage(
                "--engine ray: the work was not all done; the same command goes on where it was"
                    .to_owned(),
            )
        })
    }

    /// How many items of `range` a task of Slurm gets: what `trial` does with one tells how long it takes.
    pub fn items_a_task(&self, range: &Range<u64>, trial: impl FnMut(u64)) -> u64 {
        slurm::items_a_task(self.task_seconds, range, trial)
    }
}

/// This program, as a shell takes it.
///
/// # Errors
/// A program that does not know where it is.
pub fn program() -> Result<String, Failure> {
    let path = std::env::current_exe().map_err(|error| Failure::Usage(error.to_string()))?;
    Ok(in_shell(&path))
}

/// A path that is the same from everywhere.
///
/// # Errors
/// An empty path.
pub fn absolute(path: &Path) -> Result<PathBuf, Failure> {
    std::path::absolute(path)
        .map_err(|error| Failure::Usage(format!("{}: {error}", path.display())))
}
