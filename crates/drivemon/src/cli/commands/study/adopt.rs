//! `drivemon adopt`: an effect added to a motor file.

use std::path::{Path, PathBuf};

use clap::Args;
use discovery::{AdoptReport, Budget, LAW, Laws};

use crate::cli::arguments::study::{
    ShapesArgs, StudyArgs, percent, print_audit, print_next, print_stretches, quantity, uncertain,
    with_progress,
};
use crate::cli::commands::study::explain::print_frame;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::findings::{errors, laws, scale};
use crate::cli::printing::output::write_text;
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;
use report::Subject;
use report::motor_text;
use report::study::{Adopted, Inputs, PARAMETERS};

/// Add a physical effect to a motor file, refit everything, and show the error before and after.
///
/// The error is shown on data that was not fitted too. The new motor file keeps the comments of the old one. The name
/// `parameters` takes over the refitted parameters and adds nothing; `law` takes over the curve that `explain` proves where
/// no effect of the library does. A motor file is written only where the error on data
/// that was not fitted falls by more than its own scatter.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Adopt {
    /// Name of the effect, as `drivemon explain` gives it, `law` or `parameters`
    #[arg(value_name = "EFFECT")]
    effect: String,
    #[command(flatten)]
    study: StudyArgs,
    #[command(flatten)]
    shapes: ShapesArgs,
    /// Of a law take this formula instead of the curve: its number in the list of `drivemon explain`, from 1
    #[arg(long, value_name = "N")]
    formula: Option<usize>,
    /// Motor file to write
    #[arg(short, long = "out", value_name = "M2")]
    out: PathBuf,
    /// Write the motor file even where no gain is proven
    #[arg(long)]
    anyway: bool,
}

const EXAMPLES: &str = "\
Example:
  drivemon adopt magnetizing-saturation a.csv.gz b.csv.gz --motor m.toml -o m2.toml
Exit codes: 0 the gain is proven on data that was not fitted, 1 it is not, and the file is written all the same (--anyway),
2 bad input, 3 nothing is gained, or the data do not support an answer: nothing is written.";

impl Adopt {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        self.check_formula()?;
        let files = self.study.files().writes("-o", &self.out);
        self.shapes.read_by(files).check()?;
        let laws = Laws {
            shapes: self.shapes.shapes()?,
            formula: self.formula,
        };
        let motor = self.study.motor()?;
        let sources = self.study.given(&motor, Budget::searched)?;
        let names = self.study.names();
        let inputs = Inputs {
            laws,
            ..self.study.inputs(&names, &sources, &motor)
        };
        let (mut result, adopted) =
            with_progress(|progress| Adopted::new(&self.effect, inputs, progress))?;
        let written = result.report.proven || self.anyway;
        if written {
            self.write_motor(&adopted)?;
            result.report.motor_file = self.out.display().to_string();
            result.next_command = self.next();
        }
        self.study
            .output
            .give(Subject::Adopt, &result, || print(&result))?;
        Ok(match (result.report.proven, written) {
            (true, _) => Finding::Nothing,
            (false, true) => Finding::Something,
            (false, false) => Finding::Unsupported,
        })
    }

    /// Refuses a formula of anything but a law before the recordings are read.
    fn check_formula(&self) -> Result<(), Failure> {
        let message = match self.formula {
            Some(0) => "--formula 0: formulas count from 1".to_owned(),
            Some(_) if self.effect != LAW => format!(
                "--formula belongs to `drivemon adopt {LAW}`: `{}` has no formulas to choose from",
                self.effect
            ),
            _ => return Ok(()),
        };
        Err(Failure::Usage(message))
    }

    fn write_motor(&self, adopted: &motor::MotorFile) -> Result<(), Failure> {
        let path: &Path = self.study.motor_path();
        let old = std::fs::read_to_string(path).unwrap_or_default();
        let text = motor_text::updated(&old, adopted);
        write_text(&self.out, &text)
    }

    fn next(&self) -> String {
        format!("drivemon explain {}", self.study.typed_with(&self.out))
    }
}

fn print(result: &Adopted) {
    let report = &result.report;
    say!(
        "{} with {} on {}",
        paint::strong(&result.motor),
        paint::strong(&report.effect),
        result.recordings.join(" and ")
    );
    print_audit(&report.audit);
    print_stretches(&report.stretches);
    let before = match report.effect.as_str() {
        PARAMETERS => "before, as the motor file has it",
        _ => "before, all parameters refitted",
    };
    let held_out = [&report.before, &report.after].map(|errors| errors.held_out_error_over_noise);
    let fitted = [&report.before, &report.after].map(|errors| errors.error_over_noise);
    let full = held_out[0].max(fitted[0]);
    say!("\nError on data that was not fitted:");
    errors::print(&[(before, held_out[0]), ("after", held_out[1])], full);
    say!("Error on the fitted data:");
    errors::print(&[(before, fitted[0]), ("after", fitted[1])], full);
    print_verdict(report);
    report.laws.iter().for_each(laws::print);
    if let Some(frame) = &report.frame {
        print_frame(frame);
    } else {
        print_values(report);
    }
    scale::print(report.speed_scale.as_ref(), &report.cannot_be_concluded);
    match report.motor_file.as_str() {
        "" => print_next("Nothing is written; --anyway writes it all the same.", None),
        file => print_next(
            &format!("{file} is written. Is anything still missing?"),
            Some(&result.next_command),
        ),
    }
}

fn print_verdict(report: &AdoptReport) {
    if report.proven {
        say!(
            "{}",
            paint::good("The gain is proven on data that was not fitted.")
        );
    } else {
        let what = match report.effect.as_str() {
            PARAMETERS => {
                "Nothing is gained: the motor file explains data that was not fitted as well as the fit does."
            }
            _ => {
                "The gain is not proven on data that was not fitted: do not trust this effect yet."
            }
        };
        say!("{}", paint::caution(what));
    }
}

fn print_values(report: &AdoptReport) {
    let written = !report.motor_file.is_empty();
    let heading = match written {
        true => "In the new motor file",
        false => "What the fit found",
    };
    say!("\n{heading}:");
    for p in &report.parameters {
        let value = uncertain(p.value, p.std_error);
        say!("  {:<34} {value} {}", p.name, p.unit);
    }
    for p in &report.nominals {
        say!(
            "  {:<34} {} {:<7} believed {} ({} %)",
            p.name,
            uncertain(p.value, p.std_error),
            p.unit,
            quantity(p.believed),
            percent(p.change_percent)
        );
    }
}
