//! Laws that no library holds: what `explain` says about plants that share no code with it.
//!
//! ```text
//! cargo run --release -p studies --example laws -- [--seeds N] [--first SEED] [--supply drive|grid] [--bare] [LAW...]
//! ```
//!
//! With `--bare` the recordings say nothing of their instruments, as those of most recorders.
//! One line each: truth, answer, errors, simulations and time; shares at the end. A law is visible where the model without
//! it is at least 2 % worse than the model of the same machine with nothing hidden.

#[path = "../../crates/discovery/tests/foreign/mod.rs"]
#[expect(dead_code, reason = "effects of the library have tables of their own")]
mod foreign;

use discovery::{ExplainReport, FormulaReport, LawReport, ParameterReport, explain, simulations};
use foreign::laws::Law;
use foreign::{
    DRIVE, DRIVE_B, Hidden, LOADS, MACHINES, Machine, SMALLEST_AND_LARGEST, STEPS, priors, record,
};
use recording::{Sensors, Source};
use std::time::Instant;

/// Errors that count as visible (a proof needs as much), and as good as the true law's, over the error with nothing hidden.
const VISIBLE: f64 = 1.02;
const AS_GOOD: f64 = 1.05;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Supply {
    Drive,
    Grid,
}

#[derive(Clone, Copy, Debug)]
struct Question {
    law: Option<Law>,
    seed: u64,
    supply: Supply,
    bare: bool,
}

/// What an answer is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    /// Place and coordinate are named, alone or in a declared tie.
    Right,
    /// The library's effect at the same place over the same coordinate is named, and does as well as the law.
    Library,
    /// Nothing is named, and there is nothing to be seen.
    Invisible,
    /// Place and coordinate are named as a lead.
    Lead,
    /// "Unknown", or another law as a lead: open, but not wrong.
    Open,
    /// "Adequate", although something is to be seen.
    Missed,
    /// Something else is named.
    Wrong,
}

fn machine(seed: u64) -> Machine {
    let all = [MACHINES.as_slice(), SMALLEST_AND_LARGEST.as_slice()].concat();
    all[(seed as usize) % all.len()]
}

fn asked(question: Question) -> ExplainReport {
    let machine = machine(question.seed);
    let hidden = Hidden {
        law: question.law,
        ..Hidden::default()
    };
    let courses = match question.supply {
        Supply::Drive => [DRIVE, DRIVE_B],
        Supply::Grid => [LOADS, STEPS],
    };
    let recording = |n: usize| {
        let seed = 100 * question.seed + 1 + n as u64;
        let mut recorded = record(&machine, &hidden, &courses[n], seed);
        if question.bare {
            recorded.metadata.sensors = Sensors::default();
        }
        Source::Recording(recorded)
    };
    let sources = [recording(0), recording(1)];
    explain(&sources, &priors(&machine, question.seed), &mut |_, _| {}).expect("judged")
}

fn outcome(question: Question, report: &ExplainReport, nothing_hidden: f64) -> Outcome {
    let Some(law) = question.law else {
        let nothing = report.laws.is_empty() && report.steps.is_empty();
        return match report.verdict {
            discovery::Verdict::Adequate if nothing => Outcome::Right,
            _ if nothing => Outcome::Open,
            _ => Outcome::Wrong,
        };
    };
    let named = |proven: bool| {
        let laws = report.laws.iter();
        laws.filter(|l| l.proven == proven).any(|l| law.is_named(l))
    };
    let in_library = |name: &str| law.library_names().contains(&name);
    let steps = &report.steps;
    let visible = baseline(report) > VISIBLE * nothing_hidden;
    let as_good = last(report) < AS_GOOD * nothing_hidden;
    let proven = report.laws.iter().any(|l| l.proven);
    match report.verdict {
        _ if named(true) => Outcome::Right,
        _ if steps.iter().any(|s| in_library(&s.effect)) && as_good => Outcome::Library,
        _ if proven || !steps.is_empty() => Outcome::Wrong,
        _ if named(false) => Outcome::Lead,
        discovery::Verdict::Adequate if visible => Outcome::Missed,
        discovery::Verdict::Adequate => Outcome::Invisible,
        _ => Outcome::Open,
    }
}

fn baseline(report: &ExplainReport) -> f64 {
    let fit = report.baseline.as_ref();
    fit.map_or(f64::NAN, |f| f.held_out_error_over_noise)
}

fn last(report: &ExplainReport) -> f64 {
    let fit = report.final_.as_ref();
    fit.map_or(f64::NAN, |f| f.held_out_error_over_noise)
}

fn formula(f: &FormulaReport) -> String {
    let number = |p: &ParameterReport| format!("{} {:.4} +- {:.4}", p.name, p.value, p.std_error);
    let numbers: Vec<String> = f.parameters.iter().map(number).collect();
    format!(
        "{}: {} ({}) {:.3} folds {:.3}",
        f.shape,
        f.formula,
        numbers.join(", "),
        f.held_out_error_over_noise,
        f.fold_error_over_noise
    )
}

fn words(l: &LawReport) -> String {
    let ties = l.tied_with.iter();
    let tied: Vec<String> = ties
        .map(|t| format!("{}/{}", t.place, t.coordinate))
        .collect();
    let how = if l.proven { "proven" } else { "lead" };
    let formulas: Vec<String> = l.formulas.iter().map(formula).collect();
    format!(
        "{}/{} {how} {:.3} folds {:.3} explains {:.0} % tied {tied:?} formulas {formulas:?}",
        l.place,
        l.coordinate,
        l.held_out_error_over_noise,
        l.fold_error_over_noise,
        l.explained_percent
    )
}

/// One answer as the shares count it.
struct Answer {
    law: Option<Law>,
    outcome: Outcome,
    as_good: bool,
    /// Rank of the first formula with the law's own shape; `None` where no formula is to be judged.
    formula: Option<Option<usize>>,
}

fn answered(question: Question, nothing_hidden: Option<f64>) -> (Answer, f64) {
    let (begin, before) = (Instant::now(), simulations());
    let report = asked(question);
    let nothing_hidden = nothing_hidden.unwrap_or_else(|| baseline(&report));
    let outcome = outcome(question, &report, nothing_hidden);
    let laws: Vec<String> = report.laws.iter().map(words).collect();
    let steps: Vec<&str> = report.steps.iter().map(|s| s.effect.as_str()).collect();
    println!(
        "{outcome:?} {:?} seed {} {:?}: {:?} {:.2} -> {:.3} ({nothing_hidden:.3}), laws {laws:?}, effects {steps:?}, {} simulations, {:.1} s",
        question.law,
        question.seed,
        question.supply,
        report.verdict,
        baseline(&report),
        last(&report),
        simulations() - before,
        begin.elapsed().as_secs_f64(),
    );
    let formula = question.law.and_then(|law| {
        let judged = outcome == Outcome::Right && !law.shapes().is_empty();
        let found = report.laws.iter().find(|l| l.proven && law.is_named(l));
        let mut formulas = found.map_or(&[][..], |l| &l.formulas).iter();
        judged.then(|| formulas.position(|f| law.shapes().contains(&f.shape.as_str())))
    });
    let answer = Answer {
        law: question.law,
        outcome,
        as_good: last(&report) < AS_GOOD * nothing_hidden,
        formula,
    };
    (answer, baseline(&report))
}

fn print_shares(answers: &[Answer]) {
    let laws: Vec<&Answer> = answers.iter().filter(|a| a.law.is_some()).collect();
    let count = |outcome: Outcome| laws.iter().filter(|a| a.outcome == outcome).count();
    let visible = laws.len() - count(Outcome::Invisible);
    let named = count(Outcome::Right) + count(Outcome::Library);
    let good = laws
        .iter()
        .filter(|a| a.outcome != Outcome::Invisible && a.as_good);
    let shaped: Vec<Option<usize>> = laws.iter().filter_map(|a| a.formula).collect();
    let without = answers.iter().filter(|a| a.law.is_none());
    let of_nothing = |outcome| without.clone().filter(|a| a.outcome == outcome).count();
    println!(
        "{} laws, {visible} visible: {named} named ({} as the library's effect), {} as a lead, {} open, {} missed, {} wrong; \
         error within 5 % in {}; of {} laws with a shape in the dictionary the first formula has it in {}, one of the list in {}; nothing hidden: invented in {}, called incomplete in {} of {}",
        laws.len(),
        count(Outcome::Library),
        count(Outcome::Lead),
        count(Outcome::Open),
        count(Outcome::Missed),
        count(Outcome::Wrong),
        good.count(),
        shaped.len(),
        shaped.iter().filter(|rank| **rank == Some(0)).count(),
        shaped.iter().flatten().count(),
        of_nothing(Outcome::Wrong),
        of_nothing(Outcome::Open),
        without.count(),
    );
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let (mut seeds, mut first) = (1, 31);
    let mut bare = false;
    let mut supplies = vec![Supply::Drive, Supply::Grid];
    let mut wanted: Vec<String> = Vec::new();
    while let Some(argument) = arguments.next() {
        let mut number = || {
            let text = arguments.next().expect("a number");
            text.parse().expect("a whole number")
        };
        match argument.as_str() {
            "--seeds" => seeds = number(),
            "--first" => first = number(),
            "--bare" => bare = true,
            "--supply" => match arguments.next().as_deref() {
                Some("drive") => supplies = vec![Supply::Drive],
                Some("grid") => supplies = vec![Supply::Grid],
                _ => panic!("--supply drive|grid"),
            },
            _ => wanted.push(argument),
        }
    }
    let is_asked = |law: &Law| wanted.is_empty() || wanted.contains(&format!("{law:?}"));
    let mut answers = Vec::new();
    for seed in first..first + seeds {
        for &supply in &supplies {
            let question = |law| Question {
                law,
                seed,
                supply,
                bare,
            };
            let (nothing, error) = answered(question(None), None);
            answers.push(nothing);
            for law in Law::ALL.into_iter().filter(is_asked) {
                answers.push(answered(question(Some(law)), Some(error)).0);
            }
        }
    }
    print_shares(&answers);
}
