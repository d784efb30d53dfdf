//! Programs onto a board by its debugger: what has to be run, one step after the other.

use std::path::Path;
use std::process::{Command, ExitStatus};

use crate::error::Error;

const CHIP: &str = "STM32G474RETx";
/// Builds for the board, within the source tree.
pub const BUILD_SCRIPT: &str = "tools/thumb";

/// One program to run.
pub struct Step {
    command: Command,
    shown: String,
    absent: &'static str,
    failed: &'static str,
}

/// Builds a package with a file that the environment names, or with none.
pub fn build(tree: &Path, package: &str, (variable, file): (&str, Option<&Path>)) -> Step {
    let mut command = Command::new(tree.join(BUILD_SCRIPT));
    let arguments = ["build", "--release", "-p", package];
    command.current_dir(tree).args(arguments);
    let shown = file.map_or(String::new(), |file| {
        format!("{variable}={} ", file.display())
    });
    match file {
        Some(file) => command.env(variable, file),
        None => command.env_remove(variable),
    };
    Step {
        command,
        shown: format!("{shown}{BUILD_SCRIPT} {}", arguments.join(" ")),
        absent: "it needs bash; on Windows use WSL",
        failed: "it was not built; the compiler's messages above say why",
    }
}

/// Writes an ELF file to the board.
pub fn write(elf: &Path) -> Step {
    probe_rs(
        &["download", "--chip", CHIP],
        Some(elf),
        "the board was not written: is the NUCLEO on USB, and no other debugger open? `probe-rs list` shows the probes",
    )
}

/// Starts the board again.
pub fn restart() -> Step {
    probe_rs(
        &["reset", "--chip", CHIP],
        None,
        "the board is written but was not started: press its reset button",
    )
}

fn probe_rs(arguments: &[&str], file: Option<&Path>, failed: &'static str) -> Step {
    let mut command = Command::new("probe-rs");
    command.args(arguments).args(file);
    let file = file.map_or(String::new(), |file| format!(" {}", file.display()));
    Step {
        command,
        shown: format!("probe-rs {}{file}", arguments.join(" ")),
        absent: "install it: cargo install probe-rs-tools --locked, or see https://probe.rs",
        failed,
    }
}

impl Step {
    /// As a person would type it.
    pub fn shown(&self) -> &str {
        &self.shown
    }

    /// Runs it.
    ///
    /// # Errors
    /// It is not installed, or fails.
    pub fn run(mut self) -> Result<(), Error> {
        let status = self.command.status().map_err(|error| {
            let what = format!("cannot be run: {error}");
            Error::new(Path::new(&self.shown), what, self.absent)
        })?;
        self.judge(status)
    }

    fn judge(&self, status: ExitStatus) -> Result<(), Error> {
        if status.success() {
            return Ok(());
        }
        Err(Error::new(Path::new(&self.shown), status, self.failed))
    }
}
