//! What a designed run settles: foreign machines whose first recordings leave a tie or cannot show the truth, recorded
//! once more as designed, and as the best of the usual runs.
//!
//! `cargo run --release -p studies --example design -- --seeds 5 --first 101 [--effect NAME]`

#[path = "../../crates/discovery/tests/foreign/mod.rs"]
#[expect(
    dead_code,
    unused_imports,
    reason = "the laws have a table of their own"
)]
mod foreign;

use discovery::{Asked, DesignReport, ExplainReport, Limits, NextRun, RunReport, explain_with};
use foreign::cases;
use foreign::evidence::{Answer, Question, Setting};
use foreign::{Course, Machine, priors, record};
use motor::MotorFile;
use rayon::prelude::*;
use recording::Source;

/// A designed or usual run as the foreign machine lives through it.
fn course(run: &RunReport, inverter: bool) -> Course {
    let share = |l: &discovery::LevelReport| match inverter {
        true => l.frequency_hz / 50.0,
        false => l.voltage_percent / 100.0,
    };
    let steps = run.levels.iter();
    let steps: Vec<(f64, f64, f64)> = steps
        .map(|l| (l.at_s, l.load_percent / 100.0, share(l)))
        .collect();
    let volts = run.levels.iter().filter(|_| inverter).flat_map(|l| {
        let factor = l.voltage_percent / 2.0 / l.frequency_hz;
        let factor = if l.frequency_hz > 2.0 { factor } else { 1.0 };
        [(l.at_s + l.ramp_s, factor)]
    });
    Course {
        steps: steps.leak(),
        cut: run.switch_off_s.unwrap_or(99.0),
        from: 0.0,
        end: run.duration_s,
        ramp: if inverter { 0.4 } else { 0.0 },
        volts: volts.collect::<Vec<_>>().leak(),
    }
}

fn asked(sources: &[Source], motor: &MotorFile, limits: Option<Limits>) -> ExplainReport {
    let asked = Asked {
        next_run: limits.map(|limits| NextRun {
            limits,
            motor_file: "motor.toml".to_owned(),
        }),
        ..Asked::default()
    };
    explain_with(sources, motor, asked, &mut |_, _| {}).expect("a report")
}

fn limits(inverter: bool) -> Limits {
    let mut limits = Limits::usual(inverter, 50.0);
    limits.duration_s = 4.0;
    limits.voltage = [0.85, 1.1];
    limits
}

/// Whether the first recordings leave the truth open: a tie beyond its twins, or nothing found that they could not show.
fn is_open(answer: &Answer) -> bool {
    let invisible = answer.report.not_testable.iter();
    let invisible = invisible.filter(|n| answer.question.names.contains(&n.as_str()));
    !answer.is_wrong()
        && !answer.is_unique_but_for_twins()
        && (answer.is_found() || invisible.count() > 0)
}

struct Outcome {
    designed: bool,
    usual: bool,
    promised: bool,
}

fn settled(question: &Question, sources: &[Source], run: &RunReport) -> (bool, String) {
    let machine = Machine::of(question.seed);
    let course = course(run, question.inverter);
    let more = record(&machine, &question.hidden, &course, 10 * question.seed + 7);
    let mut all = sources.to_vec();
    let at = if all.len() == 1 { 0 } else { all.len() };
    all.insert(at, Source::Recording(more));
    let motor = priors(&machine, question.seed);
    let answer = Answer {
        question: question.clone(),
        report: asked(&all, &motor, None),
    };
    (
        answer.is_unique_but_for_twins(),
        answer.report.summary.clone(),
    )
}

/// Whether the design promises to decide what is true.
fn promises(design: &DesignReport, question: &Question) -> bool {
    let about = |d: &&discovery::DecidesReport| question.names.iter().any(|n| d.what.contains(n));
    design
        .decides
        .iter()
        .filter(about)
        .all(|d| d.how_surely != discovery::Certainty::Unlikely)
}

fn outcome(question: &Question) -> Option<Outcome> {
    let motor = priors(&Machine::of(question.seed), question.seed);
    let sources = question.sources();
    let report = asked(&sources, &motor, Some(limits(question.inverter)));
    let design = report.next_run.clone();
    let answer = Answer {
        question: question.clone(),
        report,
    };
    if !is_open(&answer) {
        return None;
    }
    let name = format!(
        "{:22} {:3} {:?}",
        question.names[0], question.seed, question.setting
    );
    let Some(design) = design else {
        eprintln!("{name}: no design: {}", answer.report.summary);
        return Some(Outcome {
            designed: false,
            usual: false,
            promised: false,
        });
    };
    let (designed, said) = settled(question, &sources, &design.run);
    let (usual, usual_said) = settled(question, &sources, &design.standard_run);
    let promised = promises(&design, question);
    eprintln!(
        "{name}: {} | {} | designed {designed}: {said} | {} {usual}: {usual_said} | promised {promised}",
        answer.report.summary, design.summary, design.best_standard_run
    );
    Some(Outcome {
        designed,
        usual,
        promised,
    })
}

fn main() {
    let value = |flag: &str| std::env::args().skip_while(|a| a != flag).nth(1);
    let number = |flag: &str, otherwise: u64| {
        value(flag).map_or(otherwise, |x| x.parse().expect("a whole number"))
    };
    let first = number("--first", 101);
    let mut questions: Vec<Question> = Vec::new();
    for seed in first..first + number("--seeds", 2) {
        for setting in [Setting::Steady, Setting::Loads, Setting::CoastDown] {
            let all = cases::single(seed);
            let grid = all
                .iter()
                .filter(|c| !c.inverter || setting == Setting::Loads);
            questions.extend(grid.map(|c| Question::of(c, setting, seed)));
        }
    }
    if let Some(effect) = value("--effect") {
        questions.retain(|q| q.names[0] == effect);
    }
    let all: Vec<Outcome> = questions.par_iter().filter_map(outcome).collect();
    let count = |of: &dyn Fn(&Outcome) -> bool| all.iter().filter(|o| of(o)).count();
    println!(
        "{} questions open; settled by the designed run {}, by the best usual run {}; the designed run at least as good {}; of {} that it promises it settles {}",
        all.len(),
        count(&|o| o.designed),
        count(&|o| o.usual),
        count(&|o| o.designed || !o.usual),
        count(&|o| o.promised),
        count(&|o| o.promised && o.designed),
    );
}
