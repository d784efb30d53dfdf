//! `drivemon motor identify`: parameters from recordings.

use std::path::PathBuf;

use clap::Args;
use discovery::{Budget, IdentifiedParameter, IdentifyReport, Sources};
use motor::MotorFile;
use report::json::Answer;
use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::arguments::study::{
    StudyArgs, print_audit, print_stretches, quantity, with_progress,
};
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::write_text;
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;
use report::motor_text;

/// Learn a motor's parameters from recordings of it in good order.
///
/// The intervals of the motor file are the prior: `drivemon motor new` writes them. What the recordings tell gets a narrower
/// interval; what they cannot tell keeps its own, and the answer says which recording would tell it. A start and two loads
/// tell nearly everything.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Identify {
    #[command(flatten)]
    study: StudyArgs,
    /// Motor file to write
    #[arg(short, long = "out", value_name = "M2")]
    out: PathBuf,
    /// Write the motor file even where the model does not fit: its parameters then stand for what it misses
    #[arg(long)]
    anyway: bool,
}

const EXAMPLES: &str = "\
Example:
  drivemon motor new --plate pump-plate.toml -o pump.toml
  drivemon motor identify start.csv full-load.csv --motor pump.toml -o pump-2.toml
Exit codes: 0 written, 1 the model does not fit the recordings, and the file is written all the same (--anyway), 2 bad input,
3 the model does not fit (drivemon explain says what it misses), or the data do not support an answer: nothing is written.";

/// An error over noise from here on is no noise.
const MISFIT: f64 = 1.5;

/// Parameters that recordings tell.
#[derive(Debug, Serialize, JsonSchema)]
pub struct IdentifyJson<'a> {
    #[serde(flatten)]
    report: &'a IdentifyReport,
    /// The motor file that was written; `null` where it was not.
    motor_file: Option<String>,
}

impl Answer for IdentifyJson<'_> {
    const FORMAT: &'static str = "motor-identify/1";
}

impl Identify {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        self.study.files().writes("-o", &self.out).check()?;
        let motor = self.study.motor()?;
        let sources = self.study.given(&motor, Budget::fitted)?;
        let (report, identified) = with_progress(|progress| {
            discovery::identify(Sources::Given(&sources), &motor, progress)
        })?;
        let fits = report.after.held_out_error_over_noise < MISFIT;
        let written = fits || self.anyway;
        if written {
            self.write(&identified)?;
        }
        let result = IdentifyJson {
            report: &report,
            motor_file: written.then(|| self.out.display().to_string()),
        };
        self.study
            .output
            .json
            .give(&result, || self.print(&report, fits))?;
        Ok(match (fits, written) {
            (true, _) => Finding::Nothing,
            (false, true) => Finding::Something,
            (false, false) => Finding::Unsupported,
        })
    }

    fn write(&self, motor: &MotorFile) -> Result<(), Failure> {
        let old = std::fs::read_to_string(self.study.motor_path()).unwrap_or_default();
        write_text(&self.out, &motor_text::updated(&old, motor))
    }

    fn print(&self, report: &IdentifyReport, fits: bool) {
        print_audit(&report.audit);
        print_stretches(&report.stretches);
        print_table(&report.parameters);
        say!(
            "\n  error over noise on data that was not fitted: {:.2} before, {:.2} after",
            report.before.held_out_error_over_noise,
            report.after.held_out_error_over_noise
        );
        if !fits {
            say!(
                "  {} the model misses something, and the parameters stand for it. What it misses:",
                paint::caution("not identified:")
            );
            say!("  drivemon explain {}", self.study.typed());
        }
        if fits || self.anyway {
            say!("\n{} is written.", self.out.display());
        } else {
            say!("\nNothing is written; --anyway writes it.");
        }
    }
}

/// Every parameter: told by the recordings, or what would tell it.
pub(crate) fn print_table(parameters: &[IdentifiedParameter]) {
    say!(
        "  {:<30} {:>14} {:>14}  {:<28} to learn it, record",
        "parameter",
        "believed",
        "found",
        "95 % interval"
    );
    for p in parameters {
        let interval = format!("{} .. {}", quantity(p.low), quantity(p.high));
        let tell = p.would_tell.as_deref().unwrap_or("-");
        say!(
            "  {:<30} {:>14} {:>14}  {:<28} {}",
            p.name,
            quantity(p.believed),
            format!("{} {}", quantity(p.value), p.unit),
            interval,
            paint::faint(tell)
        );
    }
}
