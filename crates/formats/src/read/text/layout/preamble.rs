//! What the lines above the table say about the clock.

use super::rows::{Row, numbered};
use crate::read::text::cells::{Kind, Separator, cells, kind};
use recording::{Quantity, Unit};

/// A rate that a file declares.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::read) struct Rate {
    pub hz: f64,
    /// What the file calls it.
    pub label: String,
    pub line: u64,
}

/// Labels of the time between two samples, without blanks and in lower case.
const PERIODS: [&str; 14] = [
    "sampleinterval",
    "samplinginterval",
    "increment",
    "xincrement",
    "deltax",
    "dt",
    "deltat",
    "hresolution",
    "sampletime",
    "sampleperiod",
    "samplingperiod",
    "timeincrement",
    "abtastzeit",
    "timebase",
];
/// Labels of samples per second.
const RATES: [&str; 7] = [
    "samplerate",
    "samplingrate",
    "samplefrequency",
    "samplingfrequency",
    "abtastrate",
    "fs",
    "recordingrate",
];

/// The rate that rows above the samples declare: `Sample Interval,1e-4`, or a column `Increment` with its value below.
pub(in crate::read::text) fn rate(rows: &[Row<'_>], before: u64) -> Option<Rate> {
    let above = || rows.iter().take_while(|row| row.line < before);
    above().find_map(in_row).or_else(|| {
        let pairs = above().zip(above().skip(1));
        pairs
            .into_iter()
            .find_map(|(names, values)| in_column(names, values))
    })
}

fn in_row(row: &Row<'_>) -> Option<Rate> {
    let joined = row.cells[0].split_once([':', '=']);
    let (label, values) = match joined {
        Some((label, value)) => (label, vec![value.trim()]),
        None => (row.cells[0], row.cells[1..].to_vec()),
    };
    let value = values.iter().find(|cell| !cell.is_empty())?;
    let unit = values.iter().skip(1).find(|cell| kind(cell) == Kind::Text);
    of(label, value, unit.copied(), row.line)
}

fn in_column(names: &Row<'_>, values: &Row<'_>) -> Option<Rate> {
    let mut pairs = names.cells.iter().zip(&values.cells);
    pairs.find_map(|(name, value)| of(name, value, None, names.line))
}

fn of(label: &str, value: &str, unit: Option<&str>, line: u64) -> Option<Rate> {
    let (name, declared) = crate::read::header::name_and_unit(label.trim());
    let plain: String = name
        .chars()
        .filter(|c| c.is_alphanumeric())
        .collect::<String>()
        .to_lowercase();
    let is_rate = RATES.contains(&plain.as_str());
    if !is_rate && !PERIODS.contains(&plain.as_str()) {
        return None;
    }
    let mut words = cells(value, Separator::Blanks).into_iter();
    let number: f64 = words.next()?.replace(',', ".").parse().ok()?;
    let own = words.next();
    let unit = declared.as_deref().or(own).or(unit);
    let hz = match is_rate {
        true => number * hertz(unit),
        false => 1.0 / (number * seconds(unit)),
    };
    (hz.is_finite() && (0.1..=1e8).contains(&hz)).then(|| Rate {
        hz,
        label: name.to_owned(),
        line,
    })
}

fn seconds(unit: Option<&str>) -> f64 {
    let known = unit.and_then(|unit| Unit::declared(Quantity::Time, unit).ok());
    known.map_or(1.0, |unit| unit.factor)
}

fn hertz(unit: Option<&str>) -> f64 {
    match unit.map(|unit| unit.to_lowercase()).as_deref() {
        Some("khz" | "ks/s" | "ksps") => 1e3,
        Some("mhz" | "ms/s" | "msps") => 1e6,
        _ => 1.0,
    }
}

/// What a line `sep=;` at the beginning says.
pub(in crate::read::text) fn said_separator(text: &str) -> Option<Separator> {
    let (_, first) = numbered(text).next()?;
    let said = unquoted_line(first).strip_prefix("sep=")?;
    match said.as_bytes() {
        [byte] if byte.is_ascii() => Some(Separator::Byte(*byte)),
        _ => None,
    }
}

fn unquoted_line(line: &str) -> &str {
    line.trim_matches(['"', ' ', '\r'])
}

#[cfg(test)]
mod tests {
    use super::super::rows::rows;
    use super::*;

    #[test]
    fn a_rate_is_found_in_rows_and_columns() {
        for (text, hz) in [
            ("Sample Interval,1.0e-04,s\n", 1e4),
            ("Sampling rate [kHz],5\n", 5e3),
            ("Sample rate: 20 kHz\n", 2e4),
            ("Delta_X,0.0002,0.0002\n", 5e3),
            ("X,CH1,Start,Increment\nSequence,Volt,-0.1,1.0e-4\n", 1e4),
        ] {
            let rows = rows(text, Separator::Byte(b','));
            let found = rate(&rows, 99).unwrap_or_else(|| panic!("{text}"));
            assert!((found.hz - hz).abs() < 1e-9 * hz, "{text} {found:?}");
        }
        assert_eq!(rate(&rows("Gain,5\n", Separator::Byte(b',')), 99), None);
        assert_eq!(said_separator("sep=;\nt;ia\n"), Some(Separator::Byte(b';')));
    }
}
