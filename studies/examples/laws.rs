//! Laws that no library holds: what `explain` says about plants that share no code with it.
//!
//! ```text
//! cargo run --release -p studies --example laws -- SEEDS [LAW...]
//! ```
//!
//! One line each: truth, answer, errors, simulations and time.

#[path = "../../crates/discovery/tests/foreign/mod.rs"]
#[expect(dead_code, reason = "the tests use the rest")]
mod foreign;

use discovery::{ExplainReport, FormulaReport, ParameterReport, explain, simulations};
use foreign::laws::Law;
use foreign::{DRIVE, DRIVE_B, Hidden, Machine, priors, record};
use recording::Source;
use std::time::Instant;

fn asked(law: Option<Law>, seed: u64) -> ExplainReport {
    let machine = Machine::of(seed);
    let hidden = Hidden {
        law,
        ..Hidden::default()
    };
    let recording =
        |course, n| Source::Recording(record(&machine, &hidden, course, 100 * seed + n));
    let sources = [recording(&DRIVE, 1), recording(&DRIVE_B, 2)];
    explain(&sources, &priors(&machine, seed), &mut |_, _| {}).expect("judged")
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

fn print(law: Option<Law>, seed: u64) -> bool {
    let (begin, before) = (Instant::now(), simulations());
    let report = asked(law, seed);
    let error = |fit: &Option<discovery::FitReport>| {
        fit.as_ref()
            .map_or(f64::NAN, |f| f.held_out_error_over_noise)
    };
    let right = match law {
        Some(law) => report.laws.iter().any(|l| l.proven && law.is_named(l)),
        None => report.laws.is_empty(),
    };
    let laws: Vec<String> = report
        .laws
        .iter()
        .map(|l| {
            let tied: Vec<String> = l
                .tied_with
                .iter()
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
        })
        .collect();
    let steps: Vec<&str> = report.steps.iter().map(|s| s.effect.as_str()).collect();
    println!(
        "{} {law:?} seed {seed}: {:?} {:.2} -> {:.3}, laws {laws:?}, effects {steps:?}, {} simulations, {:.1} s",
        if right { "right" } else { "WRONG" },
        report.verdict,
        error(&report.baseline),
        error(&report.final_),
        simulations() - before,
        begin.elapsed().as_secs_f64(),
    );
    right
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let seeds: u64 = arguments
        .next()
        .map_or(1, |n| n.parse().expect("a number of seeds"));
    let wanted: Vec<String> = arguments.collect();
    let asked = |law: &Law| wanted.is_empty() || wanted.contains(&format!("{law:?}"));
    let (mut right, mut all) = (0, 0);
    for seed in 0..seeds {
        for law in Law::ALL.into_iter().filter(asked) {
            right += u32::from(print(Some(law), 31 + seed));
            all += 1;
        }
        if wanted.is_empty() || wanted.iter().any(|w| w == "None") {
            right += u32::from(print(None, 31 + seed));
            all += 1;
        }
    }
    println!("{right} of {all} right");
}
