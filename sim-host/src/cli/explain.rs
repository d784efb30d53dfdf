//! `drivemon explain`: which physical effect a model misses.

use clap::Args;
use discovery::{ExplainReport, FitReport, StepReport, Verdict};
use serde::Serialize;

use super::failure::{Failure, Finding};
use super::paint;
use super::study::{StudyArgs, bar, print_audit, print_next, quantity, with_progress};
use crate::overlay::{Model, Overlay};
use crate::report::Subject;

/// Find out which physical effect the model misses, and prove it on data that was not fitted.
///
/// The first recording is fitted, the others prove; a single one is proven by folds of 40 ms blocks. Every
/// candidate is refitted together with all parameters. Nothing is claimed that the recordings cannot show: the
/// answer may be "adequate", a tie with the test that breaks it, or "unknown".
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Explain {
    #[command(flatten)]
    study: StudyArgs,
}

const EXAMPLES: &str = "\
Examples:
  drivemon explain a.csv.gz b.csv.gz --motor motor.toml       fit a, prove on b
  drivemon explain a.csv.gz --motor motor.toml --report explain.html
Exit codes: 0 the model is adequate, 1 something is missing or off, 2 bad input, 3 the data do not support an answer.";

/// Ranks that are printed.
const RANKS: usize = 8;
/// Longest bar, characters.
const WIDTH: usize = 36;

/// Everything that `drivemon explain` says.
#[derive(Debug, Serialize)]
struct ExplainJson {
    recordings: Vec<String>,
    motor: String,
    next: Next,
    #[serde(flatten)]
    report: ExplainReport,
    overlay: Option<Overlay>,
}

/// What to do next.
#[derive(Debug, Serialize)]
struct Next {
    why: String,
    command: Option<String>,
}

impl Explain {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        let motor = self.study.motor()?;
        let sources = self.study.sources()?;
        let report = with_progress(|progress| discovery::explain(&sources, &motor, progress))?;
        let models = Model::of_explanation(&motor, &report);
        let result = ExplainJson {
            recordings: self.study.names(),
            motor: motor.name.clone(),
            next: self.next(&report),
            overlay: sources
                .last()
                .filter(|_| report.baseline.is_some())
                .and_then(|source| Overlay::new(source, &models)),
            report,
        };
        if !self.study.output.takes_stdout() {
            print(&result);
        }
        self.study.output.write(Subject::Explain, &result)?;
        Ok(finding(&result.report))
    }

    fn next(&self, report: &ExplainReport) -> Next {
        let adopt = |name: &str| {
            let file = self.study.new_motor_file(name);
            Some(format!(
                "drivemon adopt {name} {} -o {file}",
                self.study.typed()
            ))
        };
        let (why, command) = match (report.verdict, report.steps.first()) {
            (Verdict::Effect, Some(step)) => (
                format!("Add {} to the model:", step.effect),
                adopt(&step.effect),
            ),
            (Verdict::Ambiguous, Some(step)) => (
                format!(
                    "Measure first what separates them: {}. Or take the first of the tie:",
                    step.separating_test
                ),
                adopt(&step.effect),
            ),
            (Verdict::Adequate, _) if anything_off(report) => (
                "Take over the refitted parameters:".to_owned(),
                adopt("parameters"),
            ),
            (Verdict::Adequate, _) => ("Nothing to do: the model is adequate.".to_owned(), None),
            (Verdict::Unsupported, _) => ("Record again as the audit says.".to_owned(), None),
            (Verdict::Implausible, _) => (
                "Check nameplate, connection and scales of the sensors before anything else."
                    .to_owned(),
                None,
            ),
            _ => (
                "Record more of what the description names, with a second load and a second voltage."
                    .to_owned(),
                None,
            ),
        };
        Next { why, command }
    }
}

fn anything_off(report: &ExplainReport) -> bool {
    let last = report.final_.iter().flat_map(|fit| &fit.parameters);
    last.into_iter().any(|parameter| parameter.off)
}

fn finding(report: &ExplainReport) -> Finding {
    match report.verdict {
        Verdict::Unsupported => Finding::Unsupported,
        Verdict::Adequate if !anything_off(report) => Finding::Nothing,
        _ => Finding::Something,
    }
}

fn print(result: &ExplainJson) {
    let report = &result.report;
    anstream::println!(
        "{} against {}",
        paint::strong(&result.motor),
        result.recordings.join(" and ")
    );
    print_audit(&report.audit);
    print_answer(report);
    print_errors(report);
    print_ranking(report);
    report.steps.iter().for_each(print_step);
    if let Some(last) = &report.final_ {
        print_parameters(last);
    }
    print_unexplained(report);
    if !report.not_testable.is_empty() {
        anstream::println!(
            "\nThis recording cannot show (present or not): {}",
            report.not_testable.join(", ")
        );
    }
    print_next(&result.next.why, result.next.command.as_deref());
}

fn print_answer(report: &ExplainReport) {
    let summary = &report.summary;
    match report.verdict {
        Verdict::Adequate => anstream::println!("\n{}", paint::good(summary)),
        Verdict::Effect => anstream::println!("\n{}", paint::error(summary)),
        _ => anstream::println!("\n{}", paint::caution(summary)),
    }
}

fn print_errors(report: &ExplainReport) {
    let Some(baseline) = &report.baseline else {
        return;
    };
    let full = baseline.held_out_error_over_noise;
    let line = |name: &str, error: f64| {
        anstream::println!(
            "  {name:<34} {error:8.3} x noise  {}",
            bar(error, full, WIDTH)
        );
    };
    anstream::println!("\nError on data that was not fitted:");
    line("all parameters refitted", full);
    for step in &report.steps {
        line(
            &format!("with {}", step.effect),
            step.held_out_error_over_noise,
        );
    }
}

fn print_ranking(report: &ExplainReport) {
    let Some(baseline) = &report.baseline else {
        return;
    };
    let full = baseline.held_out_error_over_noise;
    anstream::println!("\nEach effect alone, all parameters refitted with it (~ linearised):");
    for row in report.ranking.iter().take(RANKS) {
        let mark = if row.refitted { ' ' } else { '~' };
        let error = row.held_out_error_over_noise;
        anstream::println!(
            "  {:<24} {full:7.3} -> {mark}{error:7.3}  {:+6.1} %  {}",
            row.effect,
            -row.gain_percent,
            bar(error, full, WIDTH)
        );
    }
}

fn print_step(step: &StepReport) {
    let form = if step.form.is_empty() {
        String::new()
    } else {
        format!(" ({})", step.form)
    };
    anstream::println!(
        "\n{}{form} explains {:.0} % of the excess error. Seen when it is missing: {}.",
        paint::strong(&step.effect),
        step.explained_percent,
        step.symptom
    );
    for p in &step.parameters {
        anstream::println!(
            "  {:<34} {:>12} +- {} {}",
            p.name,
            quantity(p.value),
            quantity(p.std_error),
            p.unit
        );
    }
    if let Some(loss) = step.loss_watt {
        anstream::println!("  it takes {loss:.0} W at rated voltage and synchronous speed");
    }
    if !step.tied_with.is_empty() {
        let others = step.tied_with.join(", ");
        anstream::println!(
            "  {} {others}; what separates them: {}",
            paint::caution("as likely:"),
            step.separating_test
        );
    }
}

fn print_parameters(fit: &FitReport) {
    anstream::println!("\nParameters    believed -> fitted +- standard error");
    for p in &fit.parameters {
        let mark = if p.off { "  <- off" } else { "" };
        anstream::println!(
            "  {:<30} {:>10} -> {:>10} +- {:<9} {:<7} {:+6.1} %{}",
            p.name,
            quantity(p.believed),
            quantity(p.value),
            quantity(p.std_error),
            p.unit,
            p.change_percent,
            paint::error(mark)
        );
    }
}

fn print_unexplained(report: &ExplainReport) {
    let Some(rest) = &report.unexplained else {
        return;
    };
    anstream::println!("\nWhat is left: {}", rest.description);
    if let Some(lead) = &rest.best_lead {
        anstream::println!(
            "  best lead, not proven: {lead}, explains {:.0} %",
            rest.best_lead_explains_percent
        );
    }
    if !rest.correlates_with.is_empty() {
        anstream::println!("  it grows with: {}", rest.correlates_with.join(", "));
    }
}
