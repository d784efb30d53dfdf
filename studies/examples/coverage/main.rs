//! How often the intervals that the tool prints hold the truth: random motors, random beliefs, random recorders.
//!
//! `cargo run --release -p studies --example coverage -- --machines 300 --first 1`
//! `--only adopt|calibrate|explain` asks one command; `--only healthy` asks `explain` about motors as believed at constant load,
//! `--only changed` about one parameter that is off by as much as a user wants found (a tenth as many machines each);
//! `--short` makes recordings of ten minutes into ones of a minute, `--long` all into ones of ten minutes; `--explain` asks every
//! machine for missing effects too; `--verbose` prints every interval. Exits with 1 when a promise is missed.

mod machine;
mod tally;

use discovery::{NominalReport, StepReport, Verdict, adopt, explain};
use machine::{Case, Question};
use rayon::prelude::*;
use recording::Source;
use replay::calibrate::{Surroundings, calibrate};
use std::process::ExitCode;
use tally::{Answer, Interval};

/// Intervals of one machine by `adopt` (the same that `explain` prints of a model to which nothing is added).
fn fitted(case: &Case) -> Answer {
    let source = [Source::Recording(case.recording.clone())];
    let report = adopt("parameters", &source, &case.believed, &mut |_, _| {});
    let (report, _) = match report {
        Ok(found) => found,
        Err(error) => return Answer::refused(error.to_string()),
    };
    let interval = |p: &NominalReport| Interval {
        name: p.name.clone(),
        truth: case.truth_of(&p.name),
        value: p.value,
        std_error: p.std_error,
        believed: p.believed,
        off: p.off,
    };
    let judged = report.nominals.iter().filter(|p| p.std_error > 0.0);
    Answer {
        intervals: judged.map(interval).collect(),
        said: format!("{:.3} x noise", report.after.held_out_error_over_noise),
        ..Answer::default()
    }
}

/// The channels of the random recorders are off, each by itself: to say so is no error.
fn is_the_recorders(step: &StepReport) -> bool {
    ["phase-voltage-gain", "phase-current-gain"].contains(&step.effect.as_str())
}

/// What `explain` says beyond parameters.
fn explained(case: &Case) -> Answer {
    let source = [Source::Recording(case.recording.clone())];
    match explain(&source, &case.believed, &mut |_, _| {}) {
        Ok(report) => Answer {
            wrong: !matches!(report.verdict, Verdict::Adequate | Verdict::Unsupported)
                && !report.steps.iter().any(is_the_recorders),
            off: report
                .final_
                .iter()
                .flat_map(|fit| &fit.parameters)
                .filter(|p| p.off)
                .map(|p| p.name.clone())
                .collect(),
            said: report.summary,
            ..Answer::default()
        },
        Err(error) => Answer::refused(error.to_string()),
    }
}

/// Intervals of one machine by `calibrate`.
fn calibrated(case: &Case) -> Answer {
    let surroundings = Surroundings {
        winding_kelvin: 20.0,
        false_alarm_rate: 1e-6,
    };
    let recording = std::slice::from_ref(&case.recording);
    let found = match calibrate(&case.believed, recording, &surroundings) {
        Ok(found) => found,
        Err(error) => return Answer::refused(error.to_string()),
    };
    let interval = |(cause, change, error): &(monitor::Cause, f64, f64)| {
        let name = machine::name_of(*cause);
        let believed = case.believed_of(name);
        Interval {
            name: name.to_owned(),
            truth: case.truth_of(name),
            value: believed * (1.0 + change),
            std_error: believed * (1.0 + change) * error,
            believed,
            off: false,
        }
    };
    Answer {
        intervals: found.changes.iter().map(interval).collect(),
        ..Answer::default()
    }
}

/// Changes that must be found: place, factor and name of the parameter.
const CHANGES: [(usize, f64, &str); 4] = [
    (1, 1.25, "rotor_resistance_ohm"),
    (3, 1.1, "magnetizing_inductance_henry"),
    (3, 0.9, "magnetizing_inductance_henry"),
    (4, 1.4, "inertia_kg_m2"),
];

fn main() -> ExitCode {
    let value = |flag: &str| std::env::args().skip_while(|a| a != flag).nth(1);
    let number = |flag: &str, otherwise: u64| {
        value(flag).map_or(otherwise, |x| x.parse().expect("a whole number"))
    };
    let has = |flag: &str| std::env::args().any(|a| a == flag);
    let first = number("--first", 1);
    let seeds: Vec<u64> = (first..first + number("--machines", 300)).collect();
    let about = |seeds: &[u64], what: &str, question: Question, of: fn(&Case) -> Answer| {
        let one = |&seed: &u64| {
            let case = Case::new(seed, question);
            let answer = of(&case);
            eprintln!("{what:9} {seed:4} {} {}", case.words, answer.said);
            if has("--verbose") {
                answer.print();
            }
            answer
        };
        seeds.par_iter().map(one).collect::<Vec<Answer>>()
    };
    let any = match (has("--short"), has("--long")) {
        (true, _) => Question::Short,
        (false, true) => Question::Long,
        (false, false) => Question::Any,
    };
    let asked = |what: &str, of| about(&seeds, what, any, of);
    println!(
        "| intervals | machines | hold the truth | share | promised | said to be off |\n|---|---|---|---|---|---|"
    );
    let only = value("--only");
    if only.as_deref() == Some("healthy") {
        let answers = about(&seeds, "healthy", Question::Healthy, explained);
        return ExitCode::from(u8::from(!tally::called_off(&answers)));
    }
    if only.as_deref() == Some("changed") {
        let some = &seeds[..seeds.len().div_ceil(10)];
        let found = CHANGES.map(|(place, factor, name)| {
            let answers = about(some, name, Question::Changed(place, factor), explained);
            tally::found(name, factor, &answers)
        });
        return ExitCode::from(u8::from(!found.iter().all(|found| *found)));
    }
    let wanted = |command: &str| only.as_deref().is_none_or(|only| only == command);
    let mut kept = true;
    if wanted("adopt") {
        kept &= tally::row("explain and adopt", &asked("adopt", fitted));
    }
    if wanted("calibrate") {
        kept &= tally::row("calibrate", &asked("calibrate", calibrated));
    }
    if only.as_deref() == Some("explain") || has("--explain") {
        kept &= tally::wrong(&asked("explain", explained));
    }
    ExitCode::from(u8::from(!kept))
}
