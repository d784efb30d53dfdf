//! What is said of columns: errors and sentences.

use crate::read::header::{Header, shown};
use recording::{Error, Problem, Quantity, Target, Unit};

pub(super) fn could_both(header: &Header, columns: &[usize], target: &str) -> Error {
    let names: Vec<String> = columns.iter().map(|k| header.names[*k].clone()).collect();
    let message = format!("{} could each be {target}", list(&names));
    let remedy = format!("say which: --column {target}={}", shown(&names[0]));
    header.error(target, message, &remedy)
}

pub(super) fn foreign_unit(
    file: &str,
    line: u64,
    target: Target,
    column: &str,
    unit: &str,
    known: &str,
) -> Error {
    let message = format!(
        "the file declares `{}`, which is not a unit of {target}",
        shown(unit)
    );
    let electrical = matches!(target, Target::Channel(channel) if channel.is_electrical());
    let sensor = match electrical && Unit::declared(Quantity::Voltage, unit).is_ok() {
        true => format!("; of a clamp say its scale: --sensor {target}=100mV/A"),
        false => String::new(),
    };
    let remedy = format!("say what the numbers are: --unit {target}=UNIT, one of {known}{sensor}");
    Error::at(file, line, &shown(column), message, remedy)
}

pub(super) fn misspelt(file: &str, line: u64, name: &str, meant: &str) -> Problem {
    let name = shown(name);
    let remedy =
        format!("did you mean `{meant}`? Rename the column, or add --column {meant}={name}");
    Problem {
        file: file.to_owned(),
        line,
        field: name,
        message: "is not a known column".to_owned(),
        remedy,
    }
}

/// A column in a sentence; one without a name is called by its number.
pub(super) fn called(name: &str) -> String {
    match name.starts_with("column ") {
        true => shown(name),
        false => format!("column {}", shown(name)),
    }
}

/// Column names for a message.
pub(crate) fn list(header: &[String]) -> String {
    let names: Vec<String> = header.iter().take(20).map(|name| shown(name)).collect();
    names.join(" ")
}
