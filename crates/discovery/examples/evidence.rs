//! How often the hidden effect is found on foreign machines, as a table.
//!
//! `cargo run --release -p discovery --example evidence -- --seeds 10 --first 101`
//! `--only coast-down|loads|steady|healthy|without|double` asks one row, `--effect NAME` one effect; every answer
//! goes to standard error, with `--verbose` its ranking too.

#[path = "../tests/foreign/mod.rs"]
mod foreign;

use foreign::cases;
use foreign::evidence::{Answer, Question, Setting, double};
use rayon::prelude::*;
use std::ops::Range;

/// Single effects in one setting. An inverter has no coast-down and no steady load here.
fn single(setting: Setting, seed: u64) -> Vec<Question> {
    let all = cases::single(seed);
    let asked = all
        .iter()
        .filter(|c| setting != Setting::Steady || !c.inverter);
    asked.map(|c| Question::of(c, setting, seed)).collect()
}

/// Single effects with the truth taken out of the library.
fn without_truth(seed: u64) -> Vec<Question> {
    let mut all = single(Setting::CoastDown, seed);
    all.iter_mut().for_each(|q| q.without = Some(q.names[0]));
    all
}

/// Healthy machines of every kind.
fn healthy(seed: u64) -> Vec<Question> {
    use Setting::{CoastDown, Loads, Steady};
    let kinds = [
        (CoastDown, false),
        (Loads, false),
        (Steady, false),
        (Loads, true),
    ];
    let question = |(setting, inverter)| Question::healthy(setting, inverter, seed);
    kinds.map(question).to_vec()
}

/// Whether the report says that this recording cannot show what is hidden in it.
fn is_invisible(answer: &Answer) -> bool {
    let mut hidden = answer.report.not_testable.iter();
    hidden.any(|n| n == answer.question.names[0])
}

/// The first effects of the ranking; `~`: linearised.
fn print_ranking(answer: &Answer) {
    for row in answer.report.ranking.iter().take(8) {
        let mark = if row.refitted { ' ' } else { '~' };
        eprintln!(
            "    {mark}{:28} {:.4} ({:+.2} %)",
            row.effect, row.held_out_error_over_noise, -row.gain_percent
        );
    }
}

/// What the command line asks for.
struct Asked {
    seeds: Range<u64>,
    only: Option<String>,
    effect: Option<String>,
    verbose: bool,
}

impl Asked {
    fn from_arguments() -> Self {
        let value = |flag: &str| std::env::args().skip_while(|a| a != flag).nth(1);
        let number = |flag: &str, otherwise| {
            value(flag).map_or(otherwise, |x| x.parse::<u64>().expect("a whole number"))
        };
        let first = number("--first", 101);
        Self {
            seeds: first..first + number("--seeds", 10),
            only: value("--only"),
            effect: value("--effect"),
            verbose: std::env::args().any(|a| a == "--verbose"),
        }
    }

    /// Answers to the questions of all seeds, or nothing if this row is not asked for.
    fn answers(
        &self,
        row: &str,
        questions: impl Fn(u64) -> Vec<Question>,
        seeds: Range<u64>,
    ) -> Vec<Answer> {
        if self.only.as_ref().is_some_and(|only| only != row) {
            return Vec::new();
        }
        let mut all: Vec<Question> = seeds.flat_map(questions).collect();
        if let Some(effect) = &self.effect {
            all.retain(|q| q.names.contains(&effect.as_str()));
        }
        let ask = |q: &Question| {
            let answer = q.ask();
            eprintln!("{row:10} {}", answer.line());
            if self.verbose {
                print_ranking(&answer);
            }
            answer
        };
        all.par_iter().map(ask).collect()
    }
}

fn count(answers: &[Answer], test: impl Fn(&Answer) -> bool) -> usize {
    answers.iter().filter(|a| test(a)).count()
}

fn print(what: &str, part: usize, all: usize, promised: &str) {
    let percent = 100.0 * part as f64 / all.max(1) as f64;
    println!("| {what} | {part} of {all} | {percent:.1} % | {promised} |");
}

fn main() {
    let asked = Asked::from_arguments();
    println!("| question | answers | share | promised |\n|---|---|---|---|");
    let seeds = asked.seeds.clone();
    let coast = asked.answers(
        "coast-down",
        |s| single(Setting::CoastDown, s),
        seeds.clone(),
    );
    print(
        "two recordings, one with a coast-down: truth in the tie set",
        count(&coast, Answer::is_found),
        coast.len(),
        ">= 95 %",
    );
    print(
        "the same: truth alone",
        count(&coast, Answer::is_unique),
        coast.len(),
        ">= 85 %",
    );
    let mut loads = asked.answers("loads", |s| single(Setting::Loads, s), seeds.clone());
    loads.retain(|a| !is_invisible(a));
    print(
        "starts and loads only, visible effects: found",
        count(&loads, Answer::is_found),
        loads.len(),
        ">= 90 %",
    );
    let steady = asked.answers("steady", |s| single(Setting::Steady, s), seeds.clone());
    print(
        "one steady load: something else named",
        count(&steady, Answer::is_wrong),
        steady.len(),
        "<= 2 %",
    );
    let every = seeds.start..seeds.start + 5 * (seeds.end - seeds.start) / 2;
    let nothing = asked.answers("healthy", healthy, every);
    print(
        "nothing hidden: something named",
        count(&nothing, Answer::is_wrong),
        nothing.len(),
        "0",
    );
    let without = asked.answers("without", without_truth, seeds.clone());
    print(
        "truth taken out of the library: something named",
        count(&without, |a| !a.report.steps.is_empty()),
        without.len(),
        "<= 5 %",
    );
    let two = asked.answers("double", double, seeds);
    print(
        "two at once: both found",
        count(&two, Answer::is_found),
        two.len(),
        ">= 85 %",
    );
    print(
        "the same: a false third",
        count(&two, Answer::is_wrong),
        two.len(),
        "<= 5 %",
    );
}
