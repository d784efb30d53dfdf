//! `drivemon compare`: where the model of a motor file fails.

use clap::Args;
use discovery::{Budget, CompareReport, SignalReport};

use crate::cli::arguments::study::{
    StudyArgs, bar, print_audit, print_next, print_stretches, with_progress,
};
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::findings::{places, scale};
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;
use report::study::{Compared, worst};
use report::{AGREES, Subject};

/// Compare the model of a motor file with a recording: how far off, in which signal, and where.
///
/// Nothing is refitted. Errors are given in units of the noise that the sensors themselves have, so that 1 means
/// that nothing is missing. The first recording is compared.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Compare {
    #[command(flatten)]
    study: StudyArgs,
}

const EXAMPLES: &str = "\
Examples:
  drivemon compare rec.csv.gz --motor motor.toml
  drivemon compare rec.csv.gz --motor motor.toml --report compare.html     with figures
Exit codes: 0 the model agrees within 10 % of the noise, 1 it does not, 2 bad input, 3 the audit refused.";

impl Compare {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        self.study.files().check()?;
        let motor = self.study.motor()?;
        let sources = self.study.given(&motor, Budget::compared)?;
        let names = self.study.names();
        let inputs = self.study.inputs(&names, &sources, &motor);
        let next = format!("drivemon explain {}", self.study.typed());
        let result = with_progress(|progress| Compared::new(inputs, next, progress))?;
        self.study
            .output
            .give(Subject::Compare, &result, || print(&result))?;
        Ok(finding(&result.report))
    }
}

fn finding(report: &CompareReport) -> Finding {
    match report.overall {
        None => Finding::Unsupported,
        Some(overall) if overall.error_over_noise > AGREES => Finding::Something,
        Some(_) => Finding::Nothing,
    }
}

fn print(result: &Compared) {
    let report = &result.report;
    say!(
        "{} against {}, {}",
        paint::strong(&result.motor),
        result.recording,
        match report.speed_scale {
            Some(_) => "nothing refitted but the scale of the speed",
            None => "nothing refitted",
        }
    );
    print_audit(&report.audit);
    print_stretches(&report.stretches);
    let Some(overall) = report.overall else {
        say!("{}", paint::caution("not compared: the audit refused"));
        return;
    };
    let error = overall.error_over_noise;
    if error > AGREES {
        let answer = format!("The model misses the measurement by {error:.2} times the noise.");
        say!("\n{}", paint::error(answer));
    } else {
        let answer = format!("The model agrees with the measurement ({error:.2} times the noise).");
        say!("\n{}", paint::good(answer));
    }
    if !report.regions.is_empty() {
        say!("It is furthest off:");
        places::print(&worst(report));
    }
    print_signals(&report.signals);
    scale::print(report.speed_scale.as_ref(), &report.cannot_be_concluded);
    if error > AGREES {
        print_next("Which physics is missing?", Some(&result.next_command));
    }
}

fn print_signals(signals: &[SignalReport]) {
    let worst = signals.iter().map(|signal| signal.error_over_noise);
    let worst = worst.fold(0.0, f64::max);
    say!("By signal:");
    for signal in signals {
        say!(
            "  {:<13} error {:9.4} of {:9.3} {:<6} noise {:8.4} {:7.2} x noise  {}",
            signal.name,
            signal.error_rms,
            signal.rms,
            signal.unit,
            signal.noise_floor,
            signal.error_over_noise,
            bar(signal.error_over_noise, worst, 24)
        );
    }
}
