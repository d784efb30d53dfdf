//! `drivemon explain`: which physical effect a model misses.

use clap::Args;
use discovery::{ExplainReport, FitReport, FrameReport, RankReport, StepReport, Verdict};
use motor::MotorFile;
use recording::Source;
use serde::Serialize;

use super::failure::{Failure, Finding};
use super::places::Place;
use super::study::{
    StudyArgs, bar, fall, percent, print_audit, print_next, quantity, uncertain, with_progress,
    wrapped,
};
use super::{paint, places};
use crate::overlay::{Model, Overlay, TableOverlay};
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
/// Gain from which on an effect is worth a line, percent.
const LEAST_GAIN_PERCENT: f64 = 0.5;
/// Longest bar, characters.
const WIDTH: usize = 36;

/// Everything that `drivemon explain` says.
#[derive(Debug, Serialize)]
struct ExplainJson {
    recordings: Vec<String>,
    motor: String,
    next: Next,
    /// The worst places of the first recording, with the model as the motor file says.
    where_it_fails: Vec<Place>,
    #[serde(flatten)]
    report: ExplainReport,
    overlay: Option<Overlay>,
    table_overlay: Option<TableOverlay>,
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
            where_it_fails: where_it_fails(&sources, &motor, &report)?,
            overlay: sources
                .last()
                .filter(|_| report.baseline.is_some())
                .and_then(|source| Overlay::new(source, &models)),
            table_overlay: sources
                .last()
                .filter(|_| report.baseline.is_some())
                .and_then(|source| TableOverlay::new(source, &motor, &models)),
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
                "Measure first what separates them, or take the first of the tie:".to_owned(),
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
                "Record more of what the description names, with a second load and a second voltage. \
                 If you suspect what it is, write it as a formula into the motor file: docs/adding-an-effect.md."
                    .to_owned(),
                None,
            ),
        };
        Next { why, command }
    }
}

fn where_it_fails(
    sources: &[Source],
    motor: &MotorFile,
    report: &ExplainReport,
) -> Result<Vec<Place>, Failure> {
    if report.baseline.is_none() {
        return Ok(Vec::new());
    }
    let compared = with_progress(|progress| discovery::compare(sources, motor, progress))?;
    Ok(places::worst(&compared))
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
    if !result.where_it_fails.is_empty() {
        anstream::println!("\nThe model of the motor file is furthest off:");
        places::print(&result.where_it_fails);
    }
    print_errors(report);
    print_ranking(report);
    report.steps.iter().for_each(print_step);
    if let Some(last) = &report.final_ {
        print_parameters(last);
    }
    print_unexplained(report);
    if !report.not_testable.is_empty() {
        let names = report.not_testable.join(", ");
        let text = format!("This recording cannot show, present or not: {names}.");
        anstream::println!("\n{}", wrapped(&text));
    }
    print_next(&result.next.why, result.next.command.as_deref());
}

fn print_answer(report: &ExplainReport) {
    let summary = wrapped(&report.summary);
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
    for step in report.steps.iter().filter(|step| step.frame.is_none()) {
        line(
            &format!("with {}", step.effect),
            step.held_out_error_over_noise,
        );
    }
    for frame in report.steps.iter().filter_map(|step| step.frame.as_ref()) {
        print_frame_errors(frame);
    }
}

/// The error of the monitor's own model, on its own scale.
fn print_frame_errors(frame: &FrameReport) {
    let full = frame.held_out_before.max(frame.held_out_after);
    anstream::println!("\nError of the monitor's first residual on data that was not fitted:");
    let both = [
        ("in the motor file's frame", frame.held_out_before),
        ("in the rotor-flux frame", frame.held_out_after),
    ];
    for (name, error) in both {
        anstream::println!(
            "  {name:<34} {error:8.3} x noise  {}",
            bar(error, full, WIDTH)
        );
    }
}

fn print_ranking(report: &ExplainReport) {
    let Some(baseline) = &report.baseline else {
        return;
    };
    let before = baseline.held_out_error_over_noise;
    anstream::println!("\nEach effect alone, all parameters refitted with it (~ linearised):");
    let gains = |row: &&RankReport| row.gain_percent >= LEAST_GAIN_PERCENT;
    let shown: Vec<&RankReport> = report.ranking.iter().filter(gains).take(RANKS).collect();
    for row in &shown {
        let mark = if row.refitted { ' ' } else { '~' };
        let after = row.held_out_error_over_noise;
        anstream::println!(
            "  {:<24} {before:7.3} -> {mark}{after:7.3} {:>7} %  {}",
            row.effect,
            percent(-row.gain_percent),
            fall(before, after, WIDTH)
        );
    }
    let count = report.ranking.len() - report.ranking.iter().filter(gains).count();
    anstream::println!(
        "  {} lower it by less than {LEAST_GAIN_PERCENT} %",
        match shown.is_empty() {
            true => format!("all {count}"),
            false => format!("{count} others"),
        }
    );
}

/// The first residual before and after, at every load.
pub(super) fn print_frame(frame: &FrameReport) {
    let line = "First residual of a motor as the motor file says, percent of the voltage, over windows of steady running:";
    anstream::println!("{}", wrapped(line));
    anstream::println!("  load     windows   in its frame   rotor-flux frame");
    for band in &frame.by_load {
        anstream::println!(
            "  {:>4.0} %   {:>7}   {:>12.3}   {:>16.3}",
            band.load_percent,
            band.windows,
            band.r1_before_percent,
            band.r1_after_percent
        );
    }
}

fn print_step(step: &StepReport) {
    let form = if step.form.is_empty() {
        String::new()
    } else {
        format!(" ({})", step.form)
    };
    let share = step.explained_percent.min(100.0);
    anstream::println!(
        "\n{}{form} explains {share:.0} % of the excess error.",
        paint::strong(&step.effect)
    );
    anstream::println!(
        "{}",
        wrapped(&format!("Seen when it is missing: {}.", step.symptom))
    );
    for p in &step.parameters {
        let value = uncertain(p.value, p.std_error);
        anstream::println!("  {:<34} {value} {}", p.name, p.unit);
    }
    if let Some(frame) = &step.frame {
        print_frame(frame);
    }
    if let Some(loss) = step.loss_watt {
        anstream::println!("  it takes {loss:.0} W at rated voltage and synchronous speed");
    }
    if !step.tied_with.is_empty() {
        let others = step.tied_with.join(", ");
        anstream::println!("{} {others}", paint::caution("As likely:"));
        anstream::println!(
            "{}",
            wrapped(&format!("What separates them: {}.", step.separating_test))
        );
    }
}

fn print_parameters(fit: &FitReport) {
    anstream::println!("\nParameters    believed -> fitted +- standard error");
    for p in &fit.parameters {
        let mark = if p.off { "  <- off" } else { "" };
        anstream::println!(
            "  {:<30} {:>10} -> {} {:<7} {:>6} %{}",
            p.name,
            quantity(p.believed),
            uncertain(p.value, p.std_error),
            p.unit,
            percent(p.change_percent),
            paint::error(mark)
        );
    }
}

fn print_unexplained(report: &ExplainReport) {
    let Some(rest) = &report.unexplained else {
        return;
    };
    // The summary may have said it already.
    if !report
        .summary
        .contains(rest.description.trim_end_matches('.'))
    {
        anstream::println!(
            "\n{}",
            wrapped(&format!("What is left: {}", rest.description))
        );
    }
    let share = rest.best_lead_explains_percent;
    if let Some(lead) = rest.best_lead.as_ref().filter(|_| share >= 1.0) {
        anstream::println!(
            "\nBest lead, not proven: {lead}, explains {share:.0} % of the excess error."
        );
    }
    if !rest.correlates_with.is_empty() {
        anstream::println!(
            "What is left grows with: {}.",
            rest.correlates_with.join(", ")
        );
    }
}
