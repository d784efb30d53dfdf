//! The answer on the terminal: a column for each step.

use super::answer::{HelpJson, TestsJson};
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;

pub fn print(result: &TestsJson) {
    print_steps(result);
    for contradiction in &result.contradictions {
        let places = contradiction.places.join(", ");
        let at = if places.is_empty() {
            places
        } else {
            format!("{places}: ")
        };
        say!(
            "\n  {} {at}{}",
            paint::caution("contradiction:"),
            contradiction.message
        );
    }
    if !result.contradictions.is_empty() {
        say!(
            "  what takes part in a contradiction counts with a wider uncertainty, as wide as it needs"
        );
    }
    for note in &result.notes {
        say!("\n  {note}");
    }
    if !result.still_wide.is_empty() {
        say!("\n  still wide:");
    }
    for help in &result.still_wide {
        print_help(help);
    }
    say!("\n{} is written.", result.motor_file);
}

/// A value and the factor by which its interval reaches up: `2.069 x1.57`.
fn print_steps(result: &TestsJson) {
    let cell = |interval: &nameplate::Interval| {
        let up = (interval.high / interval.value).max(interval.value / interval.low);
        let factor = if up < 99.5 {
            format!("{up:.*}", places(up))
        } else {
            "100+".to_owned()
        };
        format!("{:>9} x{factor:<6}", short(interval.value))
    };
    let heads = result
        .steps
        .iter()
        .map(|step| format!("  {:<17}", step.after));
    say!(
        "  after{:<22}{}  95 % interval",
        "",
        heads.collect::<String>()
    );
    let Some(last) = result.steps.last() else {
        return;
    };
    for (k, parameter) in last.parameters.iter().enumerate() {
        let cells = result
            .steps
            .iter()
            .map(|step| format!("  {}", cell(&step.parameters[k].interval)));
        let interval = parameter.interval;
        say!(
            "  {:<27}{}  {} .. {}",
            parameter.name,
            cells.collect::<String>(),
            short(interval.low),
            short(interval.high)
        );
    }
    say!("  2.07 x1.25: the 95 % interval is from 2.07/1.25 to 2.07 x 1.25");
}

fn places(factor: f64) -> usize {
    match factor {
        f if f < 1.1 => 3,
        f if f < 10.0 => 2,
        _ => 0,
    }
}

fn print_help(help: &HelpJson) {
    match help.factor_then {
        Some(then) => say!(
            "    {:<27} x{:.2}: {}{} would leave x{then:.2}",
            paint::strong(help.parameter),
            help.factor_now,
            if help.again { "once more " } else { "" },
            help.how
        ),
        None => say!(
            "    {:<27} x{:.2}: no further standard test narrows it much",
            paint::strong(help.parameter),
            help.factor_now
        ),
    }
}

/// Four digits.
pub(super) fn short(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e6).contains(&value.abs()) {
        return format!("{value:.3e}");
    }
    let places = 3 - value.abs().max(1e-9).log10().floor() as i32;
    format!("{value:.*}", usize::try_from(places.max(0)).unwrap_or(0))
}
