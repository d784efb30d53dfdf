//! Rows in Parquet files: one file each, or one for a range of recordings, until all are there, then one for all.

use std::collections::HashMap;
use std::fs::File;
use std::io::ErrorKind;
use std::ops::Range;
use std::path::{Path, PathBuf};

use parquet::errors::ParquetError;
use parquet::file::reader::SerializedFileReader;

use super::row::Row;

/// Why rows cannot be kept or read.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// A file that is something else.
    #[error("{0}")]
    Content(String),
    /// The system refused.
    #[error("{0}: cannot be written: {1}; name a path in a folder that exists and can be written")]
    System(String, std::io::Error),
}

/// Where rows go.
pub struct Store {
    out: PathBuf,
    parts: PathBuf,
    /// Rows that are there already, by fingerprint: of the table, and of parts that were asked for.
    earlier: HashMap<String, Row>,
}

impl Store {
    /// A store beside the table `out`, with the rows that the table holds already.
    ///
    /// # Errors
    /// Another name than `.parquet`, another kind of file in its place, or a folder that cannot be made.
    pub fn new(out: &Path) -> Result<Store, StoreError> {
        if !recording::names::ends_in(out, ".parquet") {
            return Err(StoreError::Content(format!(
                "{}: is not the name of a table; choose a name that ends in .parquet",
                out.display()
            )));
        }
        let earlier = match out.exists() {
            true => read_table(out)?,
            false => Vec::new(),
        };
        let mut store = Store {
            out: out.to_owned(),
            parts: folder(out),
            earlier: HashMap::new(),
        };
        store.add(earlier);
        let made = std::fs::create_dir_all(&store.parts);
        made.map_err(|error| store.failure(error))?;
        Ok(store)
    }

    /// Takes the rows of the part of `name` too, where it is there.
    ///
    /// # Errors
    /// A file of this name that is no part.
    pub fn with_part(mut self, name: &str) -> Result<Store, StoreError> {
        let rows = read_if_there(&self.parts.join(name))?;
        self.add(rows.unwrap_or_default());
        Ok(self)
    }

    /// Takes the rows of all parts that hold more than one.
    ///
    /// # Errors
    /// A folder that cannot be read, or a file that is no part.
    pub fn with_parts(self) -> Result<Store, StoreError> {
        let entries = std::fs::read_dir(&self.parts).map_err(|error| self.failure(error))?;
        let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
        let names: Vec<String> = names.filter(|name| is_part(name)).collect();
        let add = |store: Store, name: &String| store.with_part(name);
        names.iter().try_fold(self, add)
    }

    fn add(&mut self, rows: Vec<Row>) {
        let named = rows.into_iter().map(|row| (row.fingerprint.clone(), row));
        self.earlier.extend(named);
    }

    /// The row of an earlier run.
    ///
    /// # Errors
    /// A file in the folder that is no row.
    pub fn kept(&self, fingerprint: &str) -> Result<Option<Row>, StoreError> {
        if let Some(row) = self.earlier.get(fingerprint) {
            return Ok(Some(row.clone()));
        }
        let path = self.row(fingerprint);
        match read_if_there(&path)?.as_deref() {
            None => Ok(None),
            Some([row]) => Ok(Some(row.clone())),
            Some(_) => Err(no_row(&path)),
        }
    }

    /// Keeps a row, whole or not at all.
    ///
    /// # Errors
    /// A folder that cannot be written.
    pub fn keep(&self, row: &Row) -> Result<(), StoreError> {
        self.write(&self.row(&row.fingerprint), std::slice::from_ref(row))
    }

    /// Whether the part of `name` is there and holds just these rows, in this order.
    pub fn holds(&self, name: &str, rows: &[Row]) -> bool {
        let there = read_if_there(&self.parts.join(name));
        let prints = |rows: &[Row]| -> Vec<String> {
            let prints = rows.iter().map(|row| row.fingerprint.clone());
            prints.collect()
        };
        matches!(there, Ok(Some(there)) if prints(&there) == prints(rows))
    }

    /// Keeps the rows of a range in one part, whole or not at all, and removes the files of the single rows.
    ///
    /// # Errors
    /// A folder that cannot be written.
    pub fn keep_part(&self, name: &str, rows: &[Row]) -> Result<(), StoreError> {
        self.write(&self.parts.join(name), rows)?;
        for row in rows {
            // What is left over is no error: the part holds it.
            let _ = std::fs::remove_file(self.row(&row.fingerprint));
        }
        Ok(())
    }

    /// Writes the table and removes the folder of rows.
    ///
    /// # Errors
    /// A path that cannot be written.
    pub fn finish(&self, rows: &[Row]) -> Result<(), StoreError> {
        self.write(&self.out, rows)?;
        // What is left over is no error: the table is written.
        let _ = std::fs::remove_dir_all(&self.parts);
        Ok(())
    }

    fn row(&self, fingerprint: &str) -> PathBuf {
        self.parts.join(format!("{fingerprint}.parquet"))
    }

    fn write(&self, path: &Path, rows: &[Row]) -> Result<(), StoreError> {
        write_rows(path, rows).map_err(|error| self.failure(error))
    }

    fn failure(&self, error: std::io::Error) -> StoreError {
        StoreError::System(self.out.display().to_string(), error)
    }
}

/// Writes rows, whole or not at all.
///
/// # Errors
/// A path that cannot be written.
pub fn write_rows(path: &Path, rows: &[Row]) -> std::io::Result<()> {
    formats::write_whole(path, |file| {
        formats::write_rows(file, rows, Vec::new()).map_err(std::io::Error::other)
    })
}

/// The rows of a table.
///
/// # Errors
/// A file that is no table of this version.
pub fn read_table(out: &Path) -> Result<Vec<Row>, StoreError> {
    read(out).map_err(|error| {
        StoreError::Content(format!(
            "{}: is there and no table of `drivemon batch` of this version ({error}); remove it, or give the table another name",
            out.display()
        ))
    })
}

/// The folder of rows that are not in the table yet.
pub fn folder(out: &Path) -> PathBuf {
    let mut parts = out.as_os_str().to_owned();
    parts.push(".parts");
    parts.into()
}

/// The name of the part with the recordings of `range`, of a list with this fingerprint.
pub fn part_name(fingerprint: &str, range: &Range<usize>) -> String {
    format!("{fingerprint}-{:09}-{:09}.parquet", range.start, range.end)
}

fn is_part(name: &str) -> bool {
    let stem = name.strip_suffix(".parquet");
    stem.is_some_and(|stem| stem.split('-').count() == 3)
}

/// The rows of a file; another machine may have removed it since it was seen.
fn read_if_there(path: &Path) -> Result<Option<Vec<Row>>, StoreError> {
    match File::open(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(_) => Err(no_row(path)),
        Ok(file) => match rows_of(file) {
            Ok(rows) => Ok(Some(rows)),
            Err(_) => Err(no_row(path)),
        },
    }
}

fn no_row(path: &Path) -> StoreError {
    StoreError::Content(format!(
        "{}: is no row of `drivemon batch`; remove it and run again",
        path.display()
    ))
}

fn read(path: &Path) -> Result<Vec<Row>, ParquetError> {
    rows_of(File::open(path)?)
}

fn rows_of(file: File) -> Result<Vec<Row>, ParquetError> {
    formats::read_rows(&SerializedFileReader::new(file)?)
}
