//! `drivemon explain`: which physical effect a model misses.

use clap::Args;
use discovery::{
    Budget, ExplainReport, FitReport, FrameReport, LAW, Laws, RankReport, StepReport, Verdict,
};

use crate::cli::arguments::next_run::NextRunArgs;
use crate::cli::arguments::study::{
    ShapesArgs, StudyArgs, fall, percent, print_audit, print_next, print_stretches, quantity,
    uncertain, with_progress, wrapped,
};
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::findings::{errors, laws, next_run, places, scale};
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;
use report::Subject;
use report::study::{Explained, Inputs, anything_off};

/// Find out which physical effect the model misses, and prove it on data that was not fitted.
///
/// The first recording is fitted, the second proves; where that leaves something, the other way round. Of more, the first, third, ... are
/// fitted together. A single one is proven by folds of 40 ms blocks. Every candidate is refitted together with all parameters. Nothing is claimed that the recordings cannot show: "adequate", a tie with the test that breaks it, and "unknown" are answers.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Explain {
    #[command(flatten)]
    study: StudyArgs,
    #[command(flatten)]
    shapes: ShapesArgs,
    #[command(flatten)]
    next_run: NextRunArgs,
}

const EXAMPLES: &str = "\
Examples:
  drivemon explain a.csv.gz b.csv.gz --motor motor.toml       fit a, prove on b
  drivemon explain a.csv.gz --motor motor.toml --report explain.html
  drivemon explain lab.csv --motor motor.toml --column speed=tacho --scale speed=unknown
  drivemon explain a.csv b.csv --motor motor.toml --design next.toml    which run decides what is open
Limits of supply and load (--limits FILE, every line may be left out):
  supply = \"grid\"              # or \"drive\", which sets the frequency
  load_percent = [0, 100]      # of rated torque
  voltage_percent = [100, 100] # of rated; behind a drive of what belongs to the frequency
  frequency_hz = [10, 50]      # behind a drive
  duration_s = 6
  start = true                 # the motor may be started while it is recorded
  coast_down = true            # the supply may be switched off while the motor runs
Exit codes: 0 the model is adequate, 1 something is missing or off, 2 bad input, 3 the data do not support an answer.";

/// Ranks that are printed.
const RANKS: usize = 8;
/// Gain from which on an effect is worth a line, percent.
const LEAST_GAIN_PERCENT: f64 = 0.5;

impl Explain {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        let files = self.next_run.files(self.study.files());
        self.shapes.read_by(files).check()?;
        let laws = Laws {
            shapes: self.shapes.shapes()?,
            formula: None,
        };
        let motor = self.study.motor()?;
        let sources = self.study.given(&motor, Budget::searched)?;
        let names = self.study.names();
        let next_run = self.next_run.asked(&motor, self.study.motor_path())?;
        let inputs = Inputs {
            laws,
            next_run: next_run.as_ref(),
            ..self.study.inputs(&names, &sources, &motor)
        };
        let adopt = |name: &str, names: &[String]| Some(self.adopt(name, names));
        let result = with_progress(|progress| Explained::new(inputs, &adopt, progress))?;
        let designed = result.report.next_run.as_ref();
        let written = self.next_run.write(designed)?;
        self.study.output.give(Subject::Explain, &result, || {
            print(&result);
            if next_run.is_some() {
                next_run::print(designed, written);
            }
        })?;
        Ok(finding(&result.report))
    }

    fn adopt(&self, name: &str, names: &[String]) -> String {
        let shapes = match name {
            LAW => self.shapes.typed(),
            _ => String::new(),
        };
        self.study.adopt(name, names, &shapes)
    }
}

fn finding(report: &ExplainReport) -> Finding {
    match report.verdict {
        Verdict::Unsupported => Finding::Unsupported,
        Verdict::Adequate if !anything_off(report) => Finding::Nothing,
        _ => Finding::Something,
    }
}

fn print(result: &Explained) {
    let report = &result.report;
    say!(
        "{} against {}",
        paint::strong(&result.motor),
        result.recordings.join(" and ")
    );
    print_audit(&report.audit);
    print_stretches(&report.stretches);
    print_answer(report);
    if !result.where_it_fails.is_empty() {
        say!("\n{}:", result.title_of_the_worst());
        places::print(&result.where_it_fails);
    }
    print_errors(report);
    print_ranking(report);
    report.steps.iter().for_each(print_step);
    report.laws.iter().for_each(laws::print);
    if let Some(last) = &report.final_ {
        print_parameters(last);
    }
    print_unexplained(report);
    scale::print(report.speed_scale.as_ref(), &report.cannot_be_concluded);
    if !report.not_testable.is_empty() {
        let names = report.not_testable.join(", ");
        let text = format!("This recording cannot show, present or not: {names}.");
        say!("\n{}", wrapped(&text));
    }
    print_next(&result.next.why, result.next.command.as_deref());
}

fn print_answer(report: &ExplainReport) {
    let summary = wrapped(&report.summary);
    match report.verdict {
        Verdict::Adequate => say!("\n{}", paint::good(summary)),
        Verdict::Effect | Verdict::Law => say!("\n{}", paint::error(summary)),
        _ => say!("\n{}", paint::caution(summary)),
    }
}

fn print_errors(report: &ExplainReport) {
    if report.baseline.is_none() {
        return;
    }
    say!("\nError on data that was not fitted:");
    let errors = report.errors();
    let full = errors.iter().map(|(_, error)| *error).fold(0.0, f64::max);
    errors::print(&errors, full);
    for frame in report.steps.iter().filter_map(|step| step.frame.as_ref()) {
        print_frame_errors(frame);
    }
}

/// The error of the monitor's own model, on its own scale.
fn print_frame_errors(frame: &FrameReport) {
    let full = frame.held_out_before.max(frame.held_out_after);
    say!("\nError of the monitor's first residual on data that was not fitted:");
    let both = [
        ("in the motor file's frame", frame.held_out_before),
        ("in the rotor-flux frame", frame.held_out_after),
    ];
    errors::print(&both, full);
}

fn print_ranking(report: &ExplainReport) {
    let Some(baseline) = &report.baseline else {
        return;
    };
    let before = baseline.held_out_error_over_noise;
    say!("\nEach effect alone, all parameters refitted with it (~ linearised):");
    let gains = |row: &&RankReport| row.gain_percent >= LEAST_GAIN_PERCENT;
    let shown: Vec<&RankReport> = report.ranking.iter().filter(gains).take(RANKS).collect();
    for row in &shown {
        let mark = if row.refitted { ' ' } else { '~' };
        let after = row.held_out_error_over_noise;
        say!(
            "  {:<24} {before:7.3} -> {mark}{after:7.3} {:>7} %  {}",
            row.effect,
            percent(-row.gain_percent),
            fall(before, after, errors::WIDTH)
        );
    }
    let count = report.ranking.len() - report.ranking.iter().filter(gains).count();
    say!(
        "  {} lower it by less than {LEAST_GAIN_PERCENT} %",
        match shown.is_empty() {
            true => format!("all {count}"),
            false => format!("{count} others"),
        }
    );
}

/// The first residual before and after, at every load.
pub(crate) fn print_frame(frame: &FrameReport) {
    let line = "First residual of a motor as the motor file says, percent of the voltage, over windows of steady running:";
    say!("{}", wrapped(line));
    say!("  load     windows   in its frame   rotor-flux frame");
    for band in &frame.by_load {
        say!(
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
    say!(
        "\n{}{form} explains {share:.0} % of the excess error.",
        paint::strong(&step.effect)
    );
    say!(
        "{}",
        wrapped(&format!("Seen when it is missing: {}.", step.symptom))
    );
    for p in &step.parameters {
        let value = uncertain(p.value, p.std_error);
        say!("  {:<34} {value} {}", p.name, p.unit);
    }
    if let Some(frame) = &step.frame {
        print_frame(frame);
    }
    if let Some(loss) = step.loss_watt {
        say!("  it takes {loss:.0} W at rated voltage and synchronous speed");
    }
    if !step.tied_with.is_empty() {
        let others = step.tied_with.join(", ");
        say!("{} {others}", paint::caution("As likely:"));
        say!(
            "{}",
            wrapped(&format!("What separates them: {}.", step.separating_test))
        );
    }
}

fn print_parameters(fit: &FitReport) {
    say!("\nParameters    believed -> fitted +- standard error");
    for p in &fit.parameters {
        let mark = if p.off { "  <- off" } else { "" };
        say!(
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
        say!(
            "\n{}",
            wrapped(&format!("What is left: {}", rest.description))
        );
    }
    let share = rest.best_lead_explains_percent;
    if let Some(lead) = rest.best_lead.as_ref().filter(|_| share >= 1.0) {
        say!("\nBest lead, not proven: {lead}, explains {share:.0} % of the excess error.");
    }
    if !rest.correlates_with.is_empty() {
        say!(
            "What is left grows with: {}.",
            rest.correlates_with.join(", ")
        );
    }
}
