//! How a text file is laid out: separator, way of writing numbers, names, units, clock.

mod preamble;
pub(super) mod rows;
mod titles;

use self::preamble::{Rate, rate, said_separator};
use self::rows::{Row, longest_run, rows, separator};
use self::titles::{Titles, titles};
use crate::read::header::shown;
use crate::read::text::cells::{Kind, Separator, is_missing};
use crate::read::text::clocks::{Clock, clock};
use crate::read::text::number::{Ambiguous, Evidence, Numbers, Place, THOUSANDS};
use recording::{Error, Mapping};

/// The layout of a file, and what was assumed to find it.
#[derive(Clone, Debug)]
pub(in crate::read::text) struct Layout {
    pub separator: Separator,
    /// Whether cells stand between quotes that hide separators.
    pub is_quoted: bool,
    pub numbers: Numbers,
    pub titles: Titles,
    /// Fewest cells of a row.
    pub width: usize,
    /// The clock in a column, where its cells are no plain numbers.
    pub clocks: Vec<Option<Clock>>,
    pub rate: Option<Rate>,
    pub notes: Vec<String>,
}

/// Finds the layout of a file by its first lines; what flags and sidecar say is taken as said.
///
/// # Errors
/// No line with a cell, and cells that could be two numbers.
pub(in crate::read::text) fn layout(
    file: &str,
    text: &str,
    said: &Mapping,
) -> Result<Layout, Error> {
    let told = said.delimiter.map(Separator::from_said);
    let separator = told
        .or_else(|| said_separator(text))
        .or_else(|| separator(text))
        .unwrap_or_else(|| by_names(text));
    let rows = rows(text, separator);
    let run = longest_run(&rows);
    if rows.is_empty() || (run.is_empty() && rows.len() == 1 && said_separator(text).is_some()) {
        let remedy = "the first line names the columns, for example t,va,vb,vc,ia,ib,ic,speed";
        return Err(Error::bad(file, "holds no header", remedy));
    }
    let titles = match run.is_empty() {
        true => first_line(&rows),
        false => titles(text, &rows, run.clone(), separator),
    };
    let body: Vec<&Row<'_>> = rows
        .iter()
        .filter(|row| row.line >= titles.first_sample)
        .collect();
    let numbers = numbers(file, &titles, &body, separator, said)?;
    let mut layout = Layout {
        separator,
        is_quoted: body.iter().any(|row| hides(row, separator)),
        numbers,
        width: rows.get(run.start).map_or(0, Row::width),
        clocks: clocks(&body, titles.names.len()),
        rate: rate(&rows, titles.first_sample),
        titles,
        notes: Vec::new(),
    };
    titles::fill(&mut layout.titles.names, layout.width);
    layout.notes = notes(&layout, &rows, said);
    Ok(layout)
}

impl Separator {
    fn from_said(byte: u8) -> Separator {
        match byte {
            b' ' => Separator::Blanks,
            byte => Separator::Byte(byte),
        }
    }

    /// As a sidecar says it; a blank means any number of blanks and tabs.
    pub fn byte(self) -> u8 {
        match self {
            Separator::Blanks => b' ',
            Separator::Byte(byte) => byte,
        }
    }

    fn name(self) -> String {
        match self {
            Separator::Blanks => "blanks".to_owned(),
            Separator::Byte(b'\t') => "tabs".to_owned(),
            Separator::Byte(byte) => format!("`{}`", char::from(byte)),
        }
    }
}

/// Without a row of samples: what cuts the first line into most cells.
fn by_names(text: &str) -> Separator {
    let count = |separator: Separator| {
        rows(text, separator)
            .first()
            .map_or(0, |row| row.cells.len())
    };
    let others = [b';', b'\t', b'|'].map(Separator::Byte);
    let comma = Separator::Byte(b',');
    others.into_iter().fold(
        comma,
        |best, one| if count(one) > count(best) { one } else { best },
    )
}

fn first_line(rows: &[Row<'_>]) -> Titles {
    let row = &rows[0];
    let width = match row.width() {
        0 => row.cells.len(),
        width => width,
    };
    Titles {
        line: row.line,
        names: row.cells[..width]
            .iter()
            .map(|cell| (*cell).to_owned())
            .collect(),
        first_sample: row.line + 1,
        ..Titles::default()
    }
}

fn hides(row: &Row<'_>, separator: Separator) -> bool {
    let Separator::Byte(byte) = separator else {
        return false;
    };
    row.cells.iter().any(|cell| cell.contains(char::from(byte)))
}

fn numbers(
    file: &str,
    titles: &Titles,
    body: &[&Row<'_>],
    separator: Separator,
    said: &Mapping,
) -> Result<Numbers, Error> {
    let mut evidence = Evidence::default();
    for row in body {
        let cells = row.cells.iter().zip(&row.kinds).enumerate();
        for (k, (cell, _)) in cells.filter(|(_, (_, kind))| **kind == Kind::Number) {
            evidence.take(cell, row.line, k);
        }
    }
    let thousands = said
        .thousands
        .map(|mark| mark.filter(|mark| THOUSANDS.contains(mark)));
    let point_is_open = separator == Separator::Byte(b';');
    evidence
        .decide(said.decimal_comma, thousands, point_is_open)
        .map_err(|ambiguous| could_be_two(file, titles, &ambiguous))
}

fn could_be_two(file: &str, titles: &Titles, ambiguous: &Ambiguous) -> Error {
    let Ambiguous {
        place: Place { line, column, text },
        is_comma,
    } = ambiguous;
    let name = titles
        .names
        .get(*column)
        .map_or_else(String::new, |name| shown(name));
    let whole: String = text.chars().filter(|c| !matches!(c, ',' | '.')).collect();
    let decimal = text.replace(',', ".");
    let message = format!(
        "`{}` is {whole} or {decimal}, and nothing at the beginning of the file tells which",
        shown(text)
    );
    let remedy = match is_comma {
        true => {
            format!("say it: --thousands ',' makes it {whole}, --decimal-comma makes it {decimal}")
        }
        false => {
            format!("say it: --thousands . makes it {whole}, --thousands none makes it {decimal}")
        }
    };
    Error::at(file, *line, &name, message, remedy)
}

fn clocks(body: &[&Row<'_>], width: usize) -> Vec<Option<Clock>> {
    let column = |k: usize| {
        let cells = body.iter().filter_map(move |row| row.cells.get(k));
        clock(cells.copied().filter(|cell| !is_missing(cell)))
    };
    let widest = body.iter().map(|row| row.cells.len()).max().unwrap_or(0);
    (0..widest.max(width)).map(column).collect()
}

/// One sentence for each thing that was assumed.
fn notes(layout: &Layout, rows: &[Row<'_>], said: &Mapping) -> Vec<String> {
    let mut notes = Vec::new();
    if said.delimiter.is_none() && layout.separator != Separator::Byte(b',') {
        notes.push(format!(
            "columns are separated by {}",
            layout.separator.name()
        ));
    }
    if said.decimal_comma.is_none() && layout.numbers.decimal_comma {
        notes.push("numbers are written 3,7".to_owned());
    }
    if let (None, Some(mark)) = (said.thousands, layout.numbers.thousands) {
        notes.push(format!("`{mark}` stands between thousands"));
    }
    let titles = &layout.titles;
    let above = if titles.line > 0 {
        titles.line
    } else {
        titles.first_sample
    };
    let before: Vec<u64> = rows
        .iter()
        .map(|row| row.line)
        .filter(|line| *line < above)
        .collect();
    if let Some(last) = before.last() {
        notes.push(format!(
            "lines up to {last} are above the table and are not read"
        ));
    }
    if titles.line > 1 || titles.in_comment {
        let place = if titles.in_comment {
            ", a comment,"
        } else {
            ""
        };
        notes.push(format!("line {}{place} names the columns", titles.line));
    }
    if let Some(line) = titles.units_line {
        notes.push(format!("line {line} gives their units"));
    }
    let last_title = titles.line.max(titles.units_line.unwrap_or(0));
    let between = rows
        .iter()
        .filter(|row| titles.line > 0 && row.line > last_title && row.line < titles.first_sample);
    notes.extend(between.map(|row| {
        format!(
            "line {} is not read: it is between names and samples",
            row.line
        )
    }));
    notes
}
