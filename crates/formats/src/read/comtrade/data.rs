//! The samples: text or binary records.

use super::configuration::{Configuration, DataKind};
use super::lines::text;
use recording::Error;

/// The samples as they stand there.
#[derive(Default)]
pub(super) struct Samples {
    /// Number of each sample.
    pub numbers: Vec<u64>,
    /// Time stamp of each sample, in the recorder's steps; NaN where it is missing.
    pub stamps: Vec<f64>,
    /// Raw values of each analogue channel; NaN where one is missing.
    pub values: Vec<Vec<f64>>,
    /// What is odd, one sentence each.
    pub oddities: Vec<String>,
}

/// The time stamp of a sample without one.
const NO_STAMP: u32 = u32::MAX;
/// The end-of-file mark of old systems, with which recorders fill up a file.
const END: u8 = 0x1A;

/// Reads the samples; `name` is the file that errors name.
///
/// # Errors
/// A row of text that is no sample, or data without any.
pub(super) fn read(name: &str, bytes: &[u8], of: &Configuration) -> Result<Samples, Error> {
    let mut samples = Samples {
        values: vec![Vec::new(); of.analogs.len()],
        ..Samples::default()
    };
    match of.kind {
        DataKind::Ascii => samples.read_text(name, bytes, of)?,
        _ => samples.read_records(bytes, of),
    }
    if samples.numbers.is_empty() {
        let remedy = "copy both files from the recorder again";
        return Err(Error::bad(name, "holds no sample", remedy));
    }
    Ok(samples)
}

impl Samples {
    fn read_text(&mut self, name: &str, bytes: &[u8], of: &Configuration) -> Result<(), Error> {
        let text = text(bytes);
        for (k, line) in text.lines().enumerate() {
            let line = line.trim_matches(|c: char| c.is_whitespace() || c == '\u{1A}' || c == '\0');
            if line.is_empty() {
                continue;
            }
            self.text_row(line, of).map_err(|(field, message)| {
                let remedy = "complete or remove the row, or copy the file from the recorder again";
                Error::at(name, k as u64 + 1, &field, message, remedy)
            })?;
        }
        Ok(())
    }

    fn text_row(&mut self, line: &str, of: &Configuration) -> Result<(), (String, String)> {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let wanted = 2 + of.analogs.len() + of.digitals;
        let fewest = 2 + of.analogs.len();
        let held = cells
            .iter()
            .rposition(|cell| !cell.is_empty())
            .map_or(0, |k| k + 1);
        if cells.len() < fewest || held > wanted {
            let message = format!("has {} fields, the configuration has {wanted}", cells.len());
            return Err((String::new(), message));
        }
        let wrong = |name: &str, text: &str| {
            let shown: String = text.chars().take(40).collect();
            (name.to_owned(), format!("`{shown}` is not a number"))
        };
        let number = cells[0].parse().map_err(|_| wrong("n", cells[0]))?;
        let stamp = match cells[1] {
            "" => f64::NAN,
            text => text.parse().map_err(|_| wrong("timestamp", text))?,
        };
        let mut row = Vec::with_capacity(of.analogs.len());
        for (analog, cell) in of.analogs.iter().zip(&cells[2..]) {
            let value: f64 = match *cell {
                "" => f64::NAN,
                text => text.parse().map_err(|_| wrong(&analog.name, text))?,
            };
            let missing = of.revision < 2013 && is_text_gap(value, analog.largest);
            row.push(if missing { f64::NAN } else { value });
        }
        self.push(number, stamp, &row);
        Ok(())
    }

    fn read_records(&mut self, bytes: &[u8], of: &Configuration) {
        let size = of.fewest_bytes();
        let mut records = bytes.chunks_exact(size);
        let mut row = Vec::with_capacity(of.analogs.len());
        for record in records.by_ref() {
            if record.iter().all(|byte| *byte == END) {
                continue;
            }
            row.clear();
            let (head, values) = record.split_at(8);
            let analogs = &values[..values.len() - of.digital_bytes()];
            row.extend(values_of(of.kind, analogs));
            let stamp = match word(&head[4..]) {
                NO_STAMP => f64::NAN,
                stamp => f64::from(stamp),
            };
            self.push(u64::from(word(head)), stamp, &row);
        }
        let rest = records.remainder();
        if rest.iter().any(|byte| !matches!(*byte, END | 0)) {
            let count = rest.len();
            self.oddities.push(format!(
                "{count} bytes behind the last whole sample are not used"
            ));
        }
    }

    fn push(&mut self, number: u64, stamp: f64, row: &[f64]) {
        self.numbers.push(number);
        self.stamps.push(stamp);
        for (values, x) in self.values.iter_mut().zip(row) {
            values.push(*x);
        }
    }
}

/// 99999 in text, unless the channel counts that far (1999, 8.4); 999999 in older files.
fn is_text_gap(value: f64, largest: Option<f64>) -> bool {
    let reserved = value == 99_999.0 || value == 999_999.0;
    reserved && largest.is_none_or(|largest| largest < value)
}

fn values_of(kind: DataKind, bytes: &[u8]) -> impl Iterator<Item = f64> + '_ {
    let size = if kind == DataKind::Binary16 { 2 } else { 4 };
    bytes.chunks_exact(size).map(move |bytes| match kind {
        DataKind::Binary16 => code16(i16::from_le_bytes([bytes[0], bytes[1]])),
        DataKind::Binary32 => code32(i32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
        _ => float(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
    })
}

/// The lowest code is reserved for a missing sample (1999, 8.6; 2013, 8.6).
fn code16(code: i16) -> f64 {
    match code {
        i16::MIN => f64::NAN,
        code => f64::from(code),
    }
}

fn code32(code: i32) -> f64 {
    match code {
        i32::MIN => f64::NAN,
        code => f64::from(code),
    }
}

/// What cannot be measured stands for a missing sample: the ends of the range, and the smallest
/// normal number.
fn float(x: f32) -> f64 {
    let gap = !x.is_finite() || x.abs() == f32::MAX || x == f32::MIN_POSITIVE;
    if gap { f64::NAN } else { f64::from(x) }
}

fn word(bytes: &[u8]) -> u32 {
    bytes
        .iter()
        .take(4)
        .rev()
        .fold(0, |word, byte| word << 8 | u32::from(*byte))
}
