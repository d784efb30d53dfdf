//! The first cells of a file, for people who must say what its columns are.

use super::format;
use super::table_file::Row;
use super::text::first_rows;
use super::text::source;
use recording::{Error, Mapping};
use serde::Serialize;
use std::io::Read;
use std::path::Path;

/// What is read of a text file for its first lines, bytes.
const MOST_BYTES: u64 = 64 * 1024;
/// Columns that are shown.
const MOST_COLUMNS: usize = 64;
/// Characters that are shown of a cell.
const MOST_CHARACTERS: usize = 40;

/// Names and first rows of a file as they stand there.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Preview {
    /// What the first line names, or the names of a binary file's arrays.
    pub columns: Vec<String>,
    /// Cells as text.
    pub rows: Vec<Vec<String>>,
}

/// The first `rows` rows of a file. A text file is shown even where it is no table.
///
/// # Errors
/// A file that cannot be opened, or a binary one that is damaged.
pub fn preview(path: &Path, flags: &Mapping, rows: usize) -> Result<Preview, Error> {
    match format::is_text(path)? {
        true => of_text(path, flags, rows),
        false => of_table(path, flags, rows),
    }
}

fn of_text(path: &Path, flags: &Mapping, rows: usize) -> Result<Preview, Error> {
    let mut bytes = Vec::new();
    // A damaged end does not hide a sound beginning.
    let _ = source::open(path)?
        .reader
        .take(MOST_BYTES)
        .read_to_end(&mut bytes);
    let text = String::from_utf8_lossy(&bytes);
    let mut cut = first_rows(&text, flags, rows + 1).into_iter().map(|cells| {
        let shown = cells.into_iter().take(MOST_COLUMNS);
        shown.map(|cell| short(&cell)).collect()
    });
    Ok(Preview {
        columns: cut.next().unwrap_or_default(),
        rows: cut.collect(),
    })
}

fn of_table(path: &Path, flags: &Mapping, rows: usize) -> Result<Preview, Error> {
    let mut file = format::open(path, flags)?;
    let names = file.header().names.clone();
    let mut preview = Preview {
        columns: names
            .iter()
            .take(MOST_COLUMNS)
            .map(|name| short(name))
            .collect(),
        rows: Vec::new(),
    };
    let mut take = |row: &dyn Row| {
        if preview.rows.len() == rows {
            // Nothing more is wanted: the error only ends the reading.
            return Err(Error::bad("", "enough", ""));
        }
        let shown = names.iter().enumerate().take(MOST_COLUMNS);
        let cell = |(k, name): (usize, &String)| match row.number(k, name) {
            Ok(Some(x)) => x.to_string(),
            _ => String::new(),
        };
        preview.rows.push(shown.map(cell).collect());
        Ok(())
    };
    let ended = file.for_each_row(&mut |_| {}, &mut take);
    match preview.rows.is_empty() {
        true => ended.map(|()| preview),
        false => Ok(preview),
    }
}

fn short(text: &str) -> String {
    let clean = text.chars().filter(|c| !c.is_control());
    clean.take(MOST_CHARACTERS).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(name: &str, content: &[u8]) -> std::path::PathBuf {
        let path = std::env::temp_dir().join(format!("preview-{}-{name}", std::process::id()));
        std::fs::write(&path, content).unwrap();
        path
    }

    #[test]
    fn a_table_is_shown_as_it_stands_there() {
        let path = file("a.csv", b"# x\nzeit;\"U1\"\n0,1;many\n0,2;3\n0,3;4\n");
        let flags = Mapping {
            delimiter: Some(b';'),
            ..Mapping::default()
        };
        let shown = preview(&path, &flags, 2).unwrap();
        assert_eq!(shown.columns, ["zeit", "U1"]);
        assert_eq!(shown.rows, [["0,1", "many"], ["0,2", "3"]]);
    }

    #[test]
    fn garbage_has_a_bounded_preview() {
        let path = file("b.csv", &[0xff, 7, b'\n'].repeat(100_000));
        let shown = preview(&path, &Mapping::default(), 3).unwrap();
        assert_eq!((shown.columns.len(), shown.rows.len()), (1, 3));
        let path = file("c.csv", &vec![b','; 1_000_000]);
        let shown = preview(&path, &Mapping::default(), 3).unwrap();
        assert_eq!(shown.columns.len(), MOST_COLUMNS);
        assert!(preview(Path::new("none.csv"), &Mapping::default(), 3).is_err());
    }
}
