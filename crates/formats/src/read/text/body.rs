//! The cells of one row of samples.

use super::cells::{is_missing, unquoted};
use super::clocks::{Clock, Wrong, since};
use super::layout::Layout;
use super::number::{self, Numbers};
use crate::read::header::shown;
use crate::read::table_file::{Row, missing, not_finite};
use csv::ByteRecord;
use recording::Error;

/// The cells of one row.
pub(super) struct Cells<'r> {
    pub file: &'r str,
    pub line: u64,
    pub record: &'r ByteRecord,
    pub layout: &'r Layout,
}

impl Row for Cells<'_> {
    fn line(&self) -> u64 {
        self.line
    }

    fn number(&self, column: usize, name: &str) -> Result<Option<f64>, Error> {
        let clock = self.layout.clocks.get(column);
        if self.layout.numbers == Numbers::default() && !matches!(clock, Some(Some(_))) {
            // What most cells are: no blanks, no quotes, no word for a missing number.
            let plain = number::plain(self.record.get(column).unwrap_or_default());
            if plain.is_some() {
                return Ok(plain);
            }
        }
        let text = self.text(column, name)?;
        if is_missing(text) {
            return Ok(None);
        }
        let parsed = match clock {
            Some(Some(clock)) => self.time(clock, name, text)?,
            _ => self.layout.numbers.parse(text),
        };
        match parsed {
            Some(x) => Ok(Some(x)),
            None => Err(self.not_a_number(name, text)),
        }
    }

    fn missing(&self, name: &str) -> Error {
        missing(self.file, self.line, name)
    }

    fn not_finite(&self, column: usize, name: &str, x: f64) -> Error {
        let text = self.text(column, name).unwrap_or_default();
        not_finite(self.file, self.line, name, text, x)
    }
}

impl Cells<'_> {
    /// A cell without quotes.
    ///
    /// # Errors
    /// Bytes that are no text.
    pub fn text(&self, column: usize, name: &str) -> Result<&str, Error> {
        let bytes = self.record.get(column).unwrap_or_default();
        std::str::from_utf8(bytes).map(unquoted).map_err(|_| {
            let message = "the cell is not UTF-8 text";
            Error::at(
                self.file,
                self.line,
                name,
                message,
                "save the file as UTF-8",
            )
        })
    }

    fn time(&self, clock: &Clock, name: &str, text: &str) -> Result<Option<f64>, Error> {
        let stamps = match clock {
            Clock::Epoch { base, .. } => return Ok(since(*base, text)),
            Clock::Stamps(stamps) => stamps,
        };
        match stamps.seconds(text) {
            Ok(seconds) => Ok(Some(seconds)),
            Err(Wrong::NoStamp) => {
                let message = format!("`{}` is not a date or time of day", shown(text));
                let remedy = "write every stamp of the column in the same way";
                Err(Error::at(self.file, self.line, name, message, remedy))
            }
            Err(Wrong::OpenOrder) => {
                let message = format!(
                    "the date changes, and `{}` could have day or month first",
                    shown(text)
                );
                let remedy = "say it: --date-order dmy or --date-order mdy";
                Err(Error::at(self.file, self.line, name, message, remedy))
            }
        }
    }

    fn not_a_number(&self, name: &str, text: &str) -> Error {
        let numbers = self.layout.numbers;
        let remedy = match (
            numbers.decimal_comma,
            text.contains(','),
            text.contains('.'),
        ) {
            (false, true, _) => {
                "write decimals with a point, or read the file with --decimal-comma; --thousands ',' where it separates thousands"
            }
            (true, _, true) if grouped(numbers, text) => {
                "the file's decimal mark is a comma: --thousands . where the point separates thousands"
            }
            _ => "write one number per cell, the unit only in the header or the mapping",
        };
        let message = format!("`{}` is not a number", shown(text));
        Error::at(self.file, self.line, name, message, remedy)
    }
}

/// Whether a point between thousands would make a number of it.
fn grouped(numbers: Numbers, text: &str) -> bool {
    let with_point = Numbers {
        thousands: Some('.'),
        ..numbers
    };
    with_point.parse(text).is_some()
}
