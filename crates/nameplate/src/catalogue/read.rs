//! A table of plates. An empty cell is unknown; columns of other names are kept and passed on.

use std::io::Read;

use crate::estimate::COLUMN_KEYS;
use crate::plate::Plate;

/// One row of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Its line in the file, counted from 1.
    pub line: u64,
    /// Every cell as written.
    pub cells: Vec<String>,
    /// The plate, or which cell is no number.
    pub plate: Result<Plate, String>,
}

/// Why a table cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum CatalogueError {
    /// The CSV is broken.
    #[error("{0}")]
    Csv(#[from] csv::Error),
    /// No column of a plate in the header.
    #[error("line 1: no known column; a table of motors has columns named {}", COLUMN_KEYS.join(", "))]
    NoColumn,
    /// A column twice.
    #[error("line 1, column {column}: {name} appears twice; remove one")]
    Twice {
        /// Its place, counted from 1.
        column: usize,
        /// Its name.
        name: String,
    },
}

/// Reads a table: its header and its rows.
///
/// # Errors
/// Broken CSV, a header without known columns, or one column twice. A cell that is no number is the row's error.
pub fn read(source: impl Read) -> Result<(Vec<String>, Vec<Row>), CatalogueError> {
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(source);
    let header: Vec<String> = reader
        .headers()?
        .iter()
        .map(|name| name.trim_start_matches('\u{feff}').to_owned())
        .collect();
    let places = places(&header)?;
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record?;
        let cells: Vec<String> = record.iter().map(str::to_owned).collect();
        rows.push(Row {
            line: record.position().map_or(0, csv::Position::line),
            plate: plate(&cells, &places),
            cells,
        });
    }
    Ok((header, rows))
}

/// For each number of a plate its column in the file.
fn places(header: &[String]) -> Result<Vec<Option<usize>>, CatalogueError> {
    let of = |key: &&str| {
        let mut found = (0..header.len()).filter(|&k| header[k] == **key);
        let first = found.next();
        match found.next() {
            Some(second) => Err(CatalogueError::Twice {
                column: second + 1,
                name: (*key).to_owned(),
            }),
            None => Ok(first),
        }
    };
    let places = COLUMN_KEYS.iter().map(of).collect::<Result<Vec<_>, _>>()?;
    if places.iter().all(Option::is_none) {
        return Err(CatalogueError::NoColumn);
    }
    Ok(places)
}

fn plate(cells: &[String], places: &[Option<usize>]) -> Result<Plate, String> {
    let mut plate = Plate::default();
    for ((number, place), key) in plate.places().into_iter().zip(places).zip(COLUMN_KEYS) {
        let text = place.and_then(|k| cells.get(k)).map_or("", String::as_str);
        if !text.is_empty() {
            let parsed = text.parse().map_err(|error| format!("{key}: {error}"))?;
            *number = Some(parsed);
        }
    }
    Ok(plate)
}
