//! One row of answers.

use super::Row;
use crate::contradiction::Contradiction;
use crate::estimate::{COLUMN_KEYS, Estimate};
use crate::interval::Interval;
use crate::physical::KEYS;

/// Digits of a number in the table.
const DIGITS: usize = 7;

/// The header: the columns of the input, then parameters, what the circuit gives, and how well it fits.
pub fn header(input: &[String]) -> Vec<String> {
    let parameters = KEYS.iter().flat_map(|key| {
        [
            (*key).to_owned(),
            format!("{key}_low"),
            format!("{key}_high"),
        ]
    });
    let fitted = COLUMN_KEYS.iter().flat_map(|key| {
        [
            format!("{key}_fitted"),
            format!("{key}_low"),
            format!("{key}_high"),
        ]
    });
    let verdict = ["worst_error_percent", "contradiction", "problem"].map(str::to_owned);
    input
        .iter()
        .cloned()
        .chain(parameters)
        .chain(fitted)
        .chain(verdict)
        .collect()
}

/// The cells of one answer, in the order of [`header`].
pub fn record(input: &[String], row: &Row, answer: &Result<Estimate, String>) -> Vec<String> {
    let cell = |k: usize| row.cells.get(k).cloned().unwrap_or_default();
    let given = (0..input.len()).map(cell);
    match answer {
        Ok(estimate) => given.chain(answered(estimate)).collect(),
        Err(problem) => {
            let empty = header(&[]).len() - 1;
            given
                .chain(std::iter::repeat_n(String::new(), empty))
                .chain([problem.clone()])
                .collect()
        }
    }
}

fn answered(estimate: &Estimate) -> impl Iterator<Item = String> {
    let cells = |interval: &Interval| [interval.value, interval.low, interval.high].map(number);
    let contradictions: Vec<String> = estimate
        .contradictions
        .iter()
        .map(Contradiction::to_string)
        .collect();
    let verdict = [
        number(100.0 * estimate.worst_error),
        contradictions.join("; "),
        String::new(),
    ];
    let numbers: Vec<String> = estimate
        .parameters
        .iter()
        .chain(&estimate.columns)
        .flat_map(cells)
        .collect();
    numbers.into_iter().chain(verdict)
}

fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    let places = DIGITS as i32 - 1 - value.abs().log10().floor() as i32;
    format!(
        "{value:.*}",
        usize::try_from(places.clamp(0, 15)).unwrap_or(0)
    )
}
