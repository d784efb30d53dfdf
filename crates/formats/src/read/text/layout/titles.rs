//! Which line names the columns, and which their units.

use super::rows::{Row, comment, numbered};
use crate::read::aliases;
use crate::read::header::{column_name, name_and_unit};
use crate::read::text::cells::{Kind, Separator, cells};
use recording::is_unit;

/// Lines above the samples.
#[derive(Clone, Debug, Default)]
pub(in crate::read::text) struct Titles {
    /// Line of the names, counted from 1; 0 where there are none.
    pub line: u64,
    pub names: Vec<String>,
    pub units: Vec<Option<String>>,
    /// Line of the units, where they have one.
    pub units_line: Option<u64>,
    /// First line of the samples.
    pub first_sample: u64,
    /// Whether the names stand in a comment.
    pub in_comment: bool,
}

/// Finds names and units above the rows of `run`.
pub(in crate::read::text) fn titles(
    text: &str,
    rows: &[Row<'_>],
    run: std::ops::Range<usize>,
    separator: Separator,
) -> Titles {
    let width = rows[run.start].width();
    let start = first_of_body(rows, run.start);
    if let Some(titles) = labelled(rows, start, width) {
        return titles;
    }
    let mut units: Option<&Row<'_>> = None;
    let mut torn = false;
    for k in (0..start).rev() {
        let row = &rows[k];
        if units.is_none() && is_units(row) {
            units = Some(row);
        } else if names_columns(row, width) {
            return of_row(row, units, rows, start, torn);
        } else {
            torn |= row.count(Kind::Number) > 0 && row.width() == width;
        }
    }
    let line = rows[start].line;
    in_comment(text, line, width, separator).unwrap_or(Titles {
        first_sample: line,
        units: units
            .map(|units| unit_names(units, width))
            .unwrap_or_default(),
        units_line: units.map(|units| units.line),
        ..Titles::default()
    })
}

/// The run, with rows above it of which one cell is damaged.
fn first_of_body(rows: &[Row<'_>], run: usize) -> usize {
    let mut start = run;
    while start > 0
        && rows[start - 1].is_sample()
        && rows[start - 1].width() + 1 >= rows[run].width()
    {
        start -= 1;
    }
    start
}

/// Names of columns: no number among them, and one for each, or one that is known.
fn names_columns(row: &Row<'_>, width: usize) -> bool {
    let named = row.cells.iter().filter(|cell| !cell.is_empty()).count();
    let known = || {
        row.cells
            .iter()
            .any(|cell| aliases::is_known(name_and_unit(cell).0))
    };
    let all_text = row.count(Kind::Number) == 0 && row.count(Kind::Stamp) == 0;
    all_text && ((row.width() >= width && named + 1 >= width) || known())
}

/// Units alone: each cell one, at least half of the cells filled.
fn is_units(row: &Row<'_>) -> bool {
    let filled = || row.cells.iter().filter(|cell| !cell.is_empty());
    let known = |cell: &&str| is_unit(bare(cell)) || WORDS.contains(cell);
    let units = filled().filter(|cell| is_unit(bare(cell))).count();
    units > 0
        && filled().all(|cell| known(cell) || cell.parse::<f64>().is_ok())
        && 2 * filled().count() >= row.cells.len()
}

/// What stands in a row of units where a column has none.
const WORDS: [&str; 5] = ["Sequence", "[]", "()", "[-]", "-"];

/// A unit without its brackets.
fn bare(cell: &str) -> &str {
    cell.trim_start_matches(['[', '('])
        .trim_end_matches([']', ')'])
        .trim()
}

fn of_row(
    row: &Row<'_>,
    units: Option<&Row<'_>>,
    rows: &[Row<'_>],
    start: usize,
    torn: bool,
) -> Titles {
    let names: Vec<String> = row.cells[..row.width()]
        .iter()
        .map(|cell| (*cell).to_owned())
        .collect();
    let last_title = units.map_or(row.line, |units| units.line.max(row.line));
    let below = rows
        .iter()
        .find(|row| row.line > last_title)
        .map_or(row.line + 1, |row| row.line);
    Titles {
        line: row.line,
        units: units
            .map(|units| unit_names(units, names.len()))
            .unwrap_or_default(),
        units_line: units.map(|units| units.line),
        names,
        // A damaged row at the beginning is a row, for an error to name it.
        first_sample: if torn { below } else { rows[start].line },
        in_comment: false,
    }
}

fn unit_names(row: &Row<'_>, width: usize) -> Vec<Option<String>> {
    let unit = |k: usize| {
        row.cells
            .get(k)
            .map(|cell| bare(cell))
            .filter(|unit| is_unit(unit))
    };
    (0..width).map(|k| unit(k).map(str::to_owned)).collect()
}

const NAME_LABELS: [&str; 4] = ["tracename", "channelname", "signalname", "name"];
const UNIT_LABELS: [&str; 5] = ["vunit", "unit", "units", "einheit", "verticalunits"];

/// Rows of the kind `"TraceName","CH1","CH2"`, with an empty first cell in the samples.
fn labelled(rows: &[Row<'_>], start: usize, width: usize) -> Option<Titles> {
    if rows[start].cells.first() != Some(&"") {
        return None;
    }
    let labels = |row: &&Row<'_>, known: &[&str]| {
        let label = row.cells.first().copied().unwrap_or_default();
        let label: String = label.chars().filter(|c| c.is_alphanumeric()).collect();
        row.width() + 1 >= width && known.contains(&label.to_lowercase().as_str())
    };
    let above = || rows[..start].iter().rev();
    let row = above().find(|row| labels(row, &NAME_LABELS))?;
    let units = above().find(|row| labels(row, &UNIT_LABELS));
    let mut titles = of_row(row, units, rows, start, false);
    titles.first_sample = rows[start].line;
    titles.names[0].clear();
    Some(titles)
}

/// Names in the last comment above the samples.
fn in_comment(text: &str, before: u64, width: usize, separator: Separator) -> Option<Titles> {
    let lines = numbered(text).take_while(|(line, _)| *line < before);
    let named = lines.filter_map(|(line, text)| {
        let names = cells(comment(text)?.trim(), separator);
        let known = names
            .iter()
            .any(|name| aliases::is_known(name_and_unit(name).0));
        (known && names.len() == width)
            .then(|| (line, names.into_iter().map(str::to_owned).collect()))
    });
    let (line, names) = named.last()?;
    Some(Titles {
        line,
        names,
        first_sample: before,
        in_comment: true,
        ..Titles::default()
    })
}

/// Names for columns without any: all of a file without titles, and single ones.
pub(in crate::read::text) fn fill(names: &mut Vec<String>, width: usize) {
    if names.is_empty() {
        names.resize(width, String::new());
    }
    for (k, name) in names.iter_mut().enumerate() {
        if name.is_empty() {
            *name = column_name(k);
        }
    }
}
