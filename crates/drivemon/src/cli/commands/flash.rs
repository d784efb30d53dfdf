//! `drivemon flash`: a motor file onto the board.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};

use clap::Args;

use super::board::motor;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;

/// Build the firmware for one motor and write it to a board.
///
/// The motor file is checked first, as every command checks it; then `tools/thumb` builds the firmware with its constants
/// and probe-rs writes it through the debugger of the NUCLEO. What the board has learnt stays in its flash, but holds only
/// for the motor constants that it was learnt with.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Flash {
    /// Motor file
    #[arg(long, value_name = "M")]
    motor: PathBuf,
    /// Check the motor file and say what would be done; build and write nothing
    #[arg(long)]
    dry_run: bool,
    /// Folder of the drive-monitor source tree; without it the current folder and those above it are searched
    #[arg(long, value_name = "FOLDER")]
    source: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  drivemon flash --motor motors/mine.toml --dry-run      is the file fit for the board, and what would be run?
  drivemon flash --motor motors/mine.toml                build, write, start
Needs: the source tree; a compiler for the board (tools/thumb says which); probe-rs (cargo install probe-rs-tools);
the NUCLEO-G474RE on USB. Afterwards: docs/firmware.md, first power-up; `drivemon monitor --serial PORT` shows its lamps.
Exit codes: 0 done, 2 the motor file, the build, probe-rs or the board.";

const CHIP: &str = "STM32G474RETx";
const TARGET: &str = "thumbv7em-none-eabihf";
/// What tells the source tree from any other folder.
const BUILD_SCRIPT: &str = "tools/thumb";

impl Flash {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        // Everything that the firmware's build would refuse, before it takes minutes.
        let (name, _) = motor::read(&self.motor)?;
        let tree = self.source_tree()?;
        let motor = absolute(&self.motor)?;
        let elf = target_folder(&tree)
            .join(TARGET)
            .join("release/drive-monitor");
        say!(
            "{}  {name}",
            paint::strong(&self.motor.display().to_string())
        );
        let steps = [build(&tree, &motor), write(&elf), restart()];
        if self.dry_run {
            for step in &steps {
                say!("would run: {}", step.shown);
            }
            return Ok(Finding::Nothing);
        }
        steps.into_iter().try_for_each(Step::run)?;
        say!("{}", paint::good("written and started"));
        Ok(Finding::Nothing)
    }

    fn source_tree(&self) -> Result<PathBuf, Failure> {
        let is_tree = |folder: &Path| folder.join(BUILD_SCRIPT).is_file();
        if let Some(folder) = &self.source {
            return is_tree(folder).then(|| folder.clone()).ok_or_else(|| {
                let folder = folder.display();
                Failure::Usage(format!(
                    "{folder}: holds no {BUILD_SCRIPT}; name the folder that README.md lies in"
                ))
            });
        }
        let here = std::env::current_dir().map_err(|error| Failure::Usage(error.to_string()))?;
        let found = here.ancestors().find(|folder| is_tree(folder));
        found.map(Path::to_path_buf).ok_or_else(|| {
            Failure::Usage(format!(
                "{}: is not within the drive-monitor source tree; go there, or name it with --source FOLDER",
                here.display()
            ))
        })
    }
}

/// The build runs in another folder.
fn absolute(path: &Path) -> Result<PathBuf, Failure> {
    std::path::absolute(path)
        .map_err(|error| Failure::Usage(format!("{}: {error}", path.display())))
}

fn target_folder(tree: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| tree.join("target"), |folder| tree.join(folder))
}

/// One program to run.
struct Step {
    command: Command,
    shown: String,
    absent: &'static str,
    failed: &'static str,
}

fn build(tree: &Path, motor: &Path) -> Step {
    let mut command = Command::new(tree.join(BUILD_SCRIPT));
    let arguments = ["build", "--release", "-p", "drive-monitor"];
    command
        .current_dir(tree)
        .args(arguments)
        .env("DRIVE_MONITOR_MOTOR", motor);
    Step {
        command,
        shown: format!(
            "DRIVE_MONITOR_MOTOR={} {BUILD_SCRIPT} {}",
            motor.display(),
            arguments.join(" ")
        ),
        absent: "it needs bash; on Windows use WSL",
        failed: "the firmware was not built; the compiler's messages above say why",
    }
}

fn write(elf: &Path) -> Step {
    probe_rs(
        &["download", "--chip", CHIP],
        Some(elf),
        "the board was not written: is the NUCLEO on USB, and no other debugger open? `probe-rs list` shows the probes",
    )
}

fn restart() -> Step {
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
    fn run(mut self) -> Result<(), Failure> {
        say!("{} {}", paint::faint("running"), self.shown);
        let status = self.command.status().map_err(|error| {
            let (shown, remedy) = (&self.shown, self.absent);
            Failure::Usage(format!("{shown}: cannot be run: {error}; {remedy}"))
        })?;
        self.judge(status)
    }

    fn judge(&self, status: ExitStatus) -> Result<(), Failure> {
        if status.success() {
            return Ok(());
        }
        Err(Failure::Usage(format!(
            "{}: {status}; {}",
            self.shown, self.failed
        )))
    }
}
