//! Rows in Parquet files: one file each until all are there, then one for all.

use std::collections::HashMap;
use std::fs::File;
use std::hash::Hasher;
use std::path::{Path, PathBuf};

use parquet::errors::ParquetError;
use parquet::file::reader::SerializedFileReader;
use twox_hash::XxHash64;

use crate::cli::printing::failure::Failure;
use report::study::batch::Row;

/// Where rows go.
pub struct Store {
    out: PathBuf,
    parts: PathBuf,
    flags: String,
    /// Rows of the table that is there already, by fingerprint.
    earlier: HashMap<String, Row>,
}

impl Store {
    /// A store beside the table; `flags` is how recordings are read.
    ///
    /// # Errors
    /// Another name than `.parquet`, another kind of file in its place, or a folder that cannot be made.
    pub fn new(out: &Path, flags: &str) -> Result<Store, Failure> {
        if !recording::names::ends_in(out, ".parquet") {
            return Err(Failure::Usage(format!(
                "{}: is not the name of a table; choose a name that ends in .parquet",
                out.display()
            )));
        }
        let mut parts = out.as_os_str().to_owned();
        parts.push(".parts");
        let store = Store {
            out: out.to_owned(),
            parts: parts.into(),
            flags: flags.to_owned(),
            earlier: earlier(out)?,
        };
        std::fs::create_dir_all(&store.parts).map_err(|error| store.failure(error))?;
        Ok(store)
    }

    /// The hash of everything that a row depends on: texts, and files, which count as empty where they are absent.
    pub fn fingerprint<'p>(
        &self,
        said: [&String; 3],
        read: impl Iterator<Item = &'p Path>,
    ) -> String {
        let mut hash = XxHash64::with_seed(0);
        let mut add = |bytes: &[u8]| {
            hash.write_u64(bytes.len() as u64);
            hash.write(bytes);
        };
        add(env!("CARGO_PKG_VERSION").as_bytes());
        said.into_iter()
            .chain([&self.flags])
            .for_each(|text| add(text.as_bytes()));
        for path in read {
            // A file that cannot be read gets a row that says so.
            add(&std::fs::read(path).unwrap_or_default());
        }
        format!("{:016x}", hash.finish())
    }

    /// The row of an earlier run.
    ///
    /// # Errors
    /// A file in the folder that is no row.
    pub fn kept(&self, fingerprint: &str) -> Result<Option<Row>, Failure> {
        if let Some(row) = self.earlier.get(fingerprint) {
            return Ok(Some(row.clone()));
        }
        let path = self.part(fingerprint);
        if !path.exists() {
            return Ok(None);
        }
        let rows = read(&path).ok().filter(|rows| rows.len() == 1);
        let row = rows.and_then(|mut rows| rows.pop());
        row.map(Some).ok_or_else(|| {
            Failure::Usage(format!(
                "{}: is no row of `drivemon batch`; remove it and run again",
                path.display()
            ))
        })
    }

    /// Keeps a row, whole or not at all.
    ///
    /// # Errors
    /// A folder that cannot be written.
    pub fn keep(&self, row: &Row) -> Result<(), Failure> {
        self.write(&self.part(&row.fingerprint), std::slice::from_ref(row))
    }

    /// Writes the table and removes the folder of rows.
    ///
    /// # Errors
    /// A path that cannot be written.
    pub fn finish(&self, rows: &[Row]) -> Result<(), Failure> {
        self.write(&self.out, rows)?;
        // What is left over is no error: the table is written.
        let _ = std::fs::remove_dir_all(&self.parts);
        Ok(())
    }

    fn part(&self, fingerprint: &str) -> PathBuf {
        self.parts.join(format!("{fingerprint}.parquet"))
    }

    fn write(&self, path: &Path, rows: &[Row]) -> Result<(), Failure> {
        let written = formats::write_whole(path, |file| {
            formats::write_rows(file, rows, Vec::new()).map_err(std::io::Error::other)
        });
        written.map_err(|error| self.failure(error))
    }

    fn failure(&self, error: std::io::Error) -> Failure {
        Failure::Write {
            path: self.out.display().to_string(),
            error,
        }
    }
}

/// The rows of a table that is there already.
fn earlier(out: &Path) -> Result<HashMap<String, Row>, Failure> {
    if !out.exists() {
        return Ok(HashMap::new());
    }
    let rows = read(out).map_err(|error| {
        Failure::Usage(format!(
            "{}: is there and no table of `drivemon batch` of this version ({error}); remove it, or give the table another name",
            out.display()
        ))
    })?;
    let named = rows.into_iter().map(|row| (row.fingerprint.clone(), row));
    Ok(named.collect())
}

fn read(path: &Path) -> Result<Vec<Row>, ParquetError> {
    formats::read_rows(&SerializedFileReader::new(File::open(path)?)?)
}
