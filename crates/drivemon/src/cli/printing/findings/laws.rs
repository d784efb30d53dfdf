//! A law that no library holds, in a terminal.

use discovery::{LawCurve, LawReport};

use crate::cli::arguments::study::{quantity, uncertain, wrapped};
use crate::cli::printing::findings::bursts;
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;

/// Lines of a printed curve.
const LINES: usize = 13;
/// Widest bar to one side, characters.
const WIDTH: f64 = 28.0;

/// Prints place, coordinate, curve and ties.
pub fn print(law: &LawReport) {
    let share = law.explained_percent.min(100.0);
    let how = match law.proven {
        true => format!("explains {share:.0} % of the excess error"),
        false => {
            format!("is a lead, not proven: it would explain {share:.0} % of the excess error")
        }
    };
    say!("\n{} {how}.", paint::strong(law.name()));
    match &law.bursts {
        Some(found) => bursts::print(found),
        None => {
            print_curve(law);
            print_formulas(law);
        }
    }
    if !law.tied_with.is_empty() {
        let ties = law.tied_with.iter();
        let ties: Vec<String> = ties
            .map(|t| format!("{} over {}", t.place, t.coordinate))
            .collect();
        say!("{}", wrapped(&format!("As likely: {}.", ties.join(", "))));
    }
}

/// Formulas that fit as well as the curve, with the numbers that `adopt law --formula` takes.
fn print_formulas(law: &LawReport) {
    if law.formulas.is_empty() {
        if law.proven {
            say!("No formula of the dictionary fits as well as the curve.");
        }
        return;
    }
    say!("Formulas that fit as well as the curve (`drivemon adopt law --formula N` takes one):");
    for (k, formula) in law.formulas.iter().enumerate() {
        say!(
            "  {}. {}  {:.3} x noise",
            k + 1,
            paint::strong(&formula.formula),
            formula.held_out_error_over_noise
        );
        for p in &formula.parameters {
            let unit = if p.unit == "-" { "" } else { &p.unit };
            say!(
                "       {:<4} {} {unit}",
                p.name,
                uncertain(p.value, p.std_error)
            );
        }
    }
}

/// The curve as bars to both sides of zero, with its 95 % band in numbers.
fn print_curve(law: &LawReport) {
    let curve = &law.curve;
    let Some(last) = curve.x.len().checked_sub(1) else {
        return;
    };
    let unit = if curve.y_unit == "-" {
        "%"
    } else {
        &curve.y_unit
    };
    say!(
        "{}",
        wrapped(&format!("Value: {}, {unit} (95 % band).", law.meaning))
    );
    let full = curve.y.iter().fold(0.0f64, |a, b| a.max(b.abs()));
    for n in 0..LINES {
        let k = n * last / (LINES - 1);
        let [y, lower, upper] = scaled(curve, k);
        say!(
            "  {:>10} {:<6} {:>10} {:<24} {}",
            quantity(curve.x[k]),
            curve.x_unit,
            quantity(y),
            format!("({} .. {})", quantity(lower), quantity(upper)),
            bar(curve.y[k], full)
        );
    }
}

/// Value and band at point `k`, relative ones in percent.
fn scaled(curve: &LawCurve, k: usize) -> [f64; 3] {
    let times = if curve.y_unit == "-" { 100.0 } else { 1.0 };
    [curve.y[k], curve.lower[k], curve.upper[k]].map(|y| times * y)
}

fn bar(y: f64, full: f64) -> String {
    let length = if full > 0.0 {
        (y.abs() / full * WIDTH).round() as usize
    } else {
        0
    };
    let side = WIDTH as usize;
    match y < 0.0 {
        true => format!("{}{}|", " ".repeat(side - length), "-".repeat(length)),
        false => format!("{}|{}", " ".repeat(side), "+".repeat(length)),
    }
}
