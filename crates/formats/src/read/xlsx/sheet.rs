//! The cells of a sheet as lines of text.

use super::damaged;
use crate::read::budget::{most_numbers, too_large};
use calamine::{DataRef, ExcelDateTime, Xlsx};
use recording::Error;
use std::fmt::Write as _;
use std::io::Cursor;
use time::{Date, Duration, Month, PrimitiveDateTime, Time};

/// What separates the cells of a line.
pub(super) const SEPARATOR: u8 = b'\t';
/// Cells of a row; Excel has more columns than any recorder has channels.
const MOST_COLUMNS: u32 = 1024;
/// Bytes of text that a sheet may show.
const MOST_TEXT: u64 = 256 << 20;
/// Bytes of text that a number takes at most.
const BYTES_A_NUMBER: u64 = 24;

/// The sheet as lines, one for each row of the sheet; empty where it has no cells.
pub(super) fn lines(
    name: &str,
    book: &mut Xlsx<Cursor<Vec<u8>>>,
    sheet: &str,
) -> Result<Vec<u8>, Error> {
    let wrong = |error: calamine::XlsxError| damaged(name, &error.to_string());
    let mut cells = book.worksheet_cells_reader(sheet).map_err(wrong)?;
    let mut text = String::new();
    let (mut row, mut column) = (0, 0);
    while let Some(cell) = cells.next_cell().map_err(wrong)? {
        let (to_row, to_column) = cell.get_position();
        let Some(shown) = shown(cell.get_value()) else {
            continue;
        };
        if to_row < row || (to_row == row && to_column < column) {
            return Err(damaged(name, "its cells are not in order"));
        }
        if to_column >= MOST_COLUMNS {
            let message = format!("has a cell in column {}", to_column + 1);
            let remedy = format!("keep the samples within the first {MOST_COLUMNS} columns");
            return Err(Error::at(name, u64::from(to_row) + 1, "", message, remedy));
        }
        if to_row > row {
            (row, column) = (next_rows(&mut text, to_row - row, row), 0);
        }
        text.extend((column..to_column).map(|_| char::from(SEPARATOR)));
        column = to_column;
        text += &shown;
        if text.len() as u64 > MOST_TEXT.min(BYTES_A_NUMBER.saturating_mul(most_numbers())) {
            return Err(too_large(name));
        }
    }
    Ok(text.into_bytes())
}

/// Ends the line and leaves as many empty ones as the sheet has rows between.
fn next_rows(text: &mut String, count: u32, row: u32) -> u32 {
    text.extend((0..count).map(|_| '\n'));
    row + count
}

/// What a cell holds, as text; `None` of an empty one.
fn shown(value: &DataRef<'_>) -> Option<String> {
    let clean = |text: &str| {
        let text = text
            .replace(['\t', '\n', '\r', '\0'], " ")
            .replace('"', "'");
        Some(text.trim().to_owned()).filter(|text| !text.is_empty())
    };
    match value {
        DataRef::Int(x) => Some(x.to_string()),
        DataRef::Float(x) => Some(x.to_string()),
        DataRef::String(text) | DataRef::DateTimeIso(text) | DataRef::DurationIso(text) => {
            clean(text)
        }
        DataRef::SharedString(text) => clean(text),
        DataRef::Bool(x) => Some(x.to_string()),
        DataRef::DateTime(x) => Some(stamp(x)),
        DataRef::Error(_) => Some("nan".to_owned()),
        DataRef::Empty => None,
    }
}

/// A date with its time of day to the microsecond, which is what a day's fraction in double precision holds.
fn stamp(value: &ExcelDateTime) -> String {
    let seconds = value.as_f64() * 86_400.0;
    let date = Date::from_calendar_date(1899, Month::December, 30).ok();
    let start = date.map(|date| PrimitiveDateTime::new(date, Time::MIDNIGHT));
    let at = start
        .filter(|_| !value.is_duration() && seconds.abs() < 1e12)
        .and_then(|start| {
            start.checked_add(Duration::microseconds((seconds * 1e6).round() as i64))
        });
    let Some(at) = at else {
        return seconds.to_string();
    };
    let (date, (h, m, s, us)) = (at.date(), at.time().as_hms_micro());
    let mut text = String::new();
    let (year, month, day) = (date.year(), u8::from(date.month()), date.day());
    let _ = write!(
        text,
        "{year:04}-{month:02}-{day:02}T{h:02}:{m:02}:{s:02}.{us:06}"
    );
    text
}
