//! How often the hidden effect is found on foreign machines, as a table.
//!
//! `cargo run --release -p studies --example evidence -- --seeds 10 --first 101`
//! `--only coast-down|loads|steady|healthy|without|double` asks one row, `--effect NAME` one effect; every answer
//! goes to standard error, with `--verbose` its ranking too. Exits with 1 when a promise is missed.

#[path = "../../crates/discovery/tests/foreign/mod.rs"]
#[expect(
    dead_code,
    unused_imports,
    reason = "the laws have a table of their own"
)]
mod foreign;

use foreign::cases;
use foreign::evidence::{Answer, Question, Setting, double, with_twins};
use rayon::prelude::*;
use std::ops::Range;
use std::process::ExitCode;

/// Single effects in one setting. An inverter has no coast-down and no steady load here.
fn single(setting: Setting, seed: u64) -> Vec<Question> {
    let all = cases::single(seed);
    let asked = all
        .iter()
        .filter(|c| setting != Setting::Steady || !c.inverter);
    asked.map(|c| Question::of(c, setting, seed)).collect()
}

/// Single effects with the truth, and what cannot be told from it, taken out of the library.
fn without_truth(seed: u64) -> Vec<Question> {
    let mut all = single(Setting::CoastDown, seed);
    all.iter_mut()
        .for_each(|q| q.without = with_twins(q.names[0]));
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

/// Whether a gain of all currents or of the torque is hidden: from the terminals they are one number.
fn is_common_gain(answer: &Answer) -> bool {
    let mut hidden = answer.question.names.iter();
    hidden.any(|name| ["current-gain", "load-gain"].contains(name))
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

/// A share of answers and what is promised of it, percent.
struct Row {
    what: &'static str,
    promised: Promise,
    part: usize,
    all: usize,
}

/// Bounds of a share, percent.
#[derive(Clone, Copy)]
enum Promise {
    AtLeast(f64),
    AtMost(f64),
    /// Nothing is promised.
    Noted,
}

impl Row {
    fn new<'a>(
        what: &'static str,
        promised: Promise,
        answers: impl IntoIterator<Item = &'a Answer>,
        test: impl Fn(&Answer) -> bool,
    ) -> Self {
        let counted: Vec<bool> = answers.into_iter().map(test).collect();
        Row {
            what,
            promised,
            part: counted.iter().filter(|passes| **passes).count(),
            all: counted.len(),
        }
    }

    fn percent(&self) -> f64 {
        100.0 * self.part as f64 / self.all.max(1) as f64
    }

    /// A row that was not asked for breaks nothing.
    fn is_kept(&self) -> bool {
        self.all == 0
            || match self.promised {
                Promise::AtLeast(least) => self.percent() >= least,
                Promise::AtMost(most) => self.percent() <= most,
                Promise::Noted => true,
            }
    }

    fn print(&self) {
        let promised = match self.promised {
            Promise::AtLeast(x) => format!(">= {x} %"),
            Promise::AtMost(x) => format!("<= {x} %"),
            Promise::Noted => String::new(),
        };
        let mark = if self.is_kept() { "" } else { " MISSED" };
        println!(
            "| {} | {} of {} | {:.1} % | {promised}{mark} |",
            self.what,
            self.part,
            self.all,
            self.percent()
        );
    }
}

/// The whole table, row by row.
fn rows(asked: &Asked) -> Vec<Row> {
    use Promise::{AtLeast, AtMost, Noted};
    let seeds = asked.seeds.clone();
    let single_in = |setting| move |seed| single(setting, seed);
    let coast = asked.answers("coast-down", single_in(Setting::CoastDown), seeds.clone());
    let mut loads = asked.answers("loads", single_in(Setting::Loads), seeds.clone());
    loads.retain(|a| !is_invisible(a));
    let steady = asked.answers("steady", single_in(Setting::Steady), seeds.clone());
    let every = seeds.start..seeds.start + 5 * (seeds.end - seeds.start) / 2;
    let nothing = asked.answers("healthy", healthy, every);
    let without = asked.answers("without", without_truth, seeds.clone());
    let two = asked.answers("double", double, seeds);
    vec![
        Row::new(
            "two recordings, one with a coast-down: truth in the tie set",
            AtLeast(95.0),
            &coast,
            Answer::is_found,
        ),
        Row::new(
            "the same: truth alone, or beside what these recordings cannot tell from it",
            AtLeast(85.0),
            &coast,
            Answer::is_unique_but_for_twins,
        ),
        Row::new(
            "the same, without common gains of the currents and of the torque: truth alone",
            AtLeast(85.0),
            coast.iter().filter(|a| !is_common_gain(a)),
            Answer::is_unique,
        ),
        Row::new(
            "the same, with them: truth alone",
            Noted,
            &coast,
            Answer::is_unique,
        ),
        Row::new(
            "starts and loads only, visible effects: found",
            AtLeast(90.0),
            &loads,
            Answer::is_found,
        ),
        Row::new(
            "one steady load: something else named",
            AtMost(2.0),
            &steady,
            Answer::is_wrong,
        ),
        Row::new(
            "nothing hidden: something named",
            AtMost(0.0),
            &nothing,
            Answer::is_wrong,
        ),
        Row::new(
            "truth and its twins taken out of the library: something named",
            AtMost(5.0),
            &without,
            |a| !a.report.steps.is_empty(),
        ),
        Row::new(
            "two at once: both found",
            AtLeast(85.0),
            &two,
            Answer::is_found,
        ),
        Row::new(
            "the same: a false third",
            AtMost(5.0),
            &two,
            Answer::is_wrong,
        ),
    ]
}

fn main() -> ExitCode {
    let rows = rows(&Asked::from_arguments());
    println!("| question | answers | share | promised |\n|---|---|---|---|");
    rows.iter().for_each(Row::print);
    ExitCode::from(u8::from(!rows.iter().all(Row::is_kept)))
}
