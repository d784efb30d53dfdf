//! Text files of whatever recorder: separator, way of writing numbers, names, units and clock are found, and said.

mod blanks;
mod body;
mod cells;
mod clocks;
pub(super) mod csv_file;
mod encoding;
mod head;
mod layout;
mod number;
pub(crate) mod source;
mod stamp;

use recording::Mapping;

/// The names of the columns and the first rows below them, as cells; of a text that is no table its lines.
pub(super) fn first_rows(text: &str, said: &Mapping, count: usize) -> Vec<Vec<String>> {
    let owned = |cells: Vec<&str>| cells.into_iter().map(str::to_owned).collect();
    match layout::layout("", text, said) {
        Ok(found) => {
            let rows = layout::rows::rows(text, found.separator).into_iter();
            let samples = rows.filter(|row| row.line >= found.titles.first_sample);
            let cells = samples.map(|row| owned(row.cells));
            std::iter::once(found.titles.names)
                .chain(cells)
                .take(count)
                .collect()
        }
        Err(_) => {
            let separator = cells::Separator::Byte(said.delimiter.unwrap_or(b','));
            let written = text.lines().filter(|line| !line.trim().is_empty());
            written
                .take(count)
                .map(|line| owned(cells::cells(line, separator)))
                .collect()
        }
    }
}
