//! Rows in Parquet files, with the campaign that they belong to.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::reader::{FileReader, SerializedFileReader};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::planned::plan::{Plan, Target};
use crate::runs::row::Row;

/// What a file of rows says about its campaign.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema, Deserialize)]
pub struct About {
    /// Name of the plan.
    pub plan: String,
    /// Master seed.
    pub seed: u64,
    /// Runs in the whole plan.
    pub runs: u64,
    /// Hash of plan, motor files and version.
    pub fingerprint: String,
    /// Version of the program that made it.
    pub version: String,
    /// What is wanted of each fault.
    pub targets: Vec<Target>,
}

/// Rows with their campaign.
#[derive(Clone, Debug)]
pub struct Results {
    /// Their campaign.
    pub about: About,
    /// The rows, by index.
    pub rows: Vec<Row>,
}

/// Why a file of rows cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The system refused.
    #[error("{0}: {1}; name a path in a folder that exists and can be written")]
    System(String, std::io::Error),
    /// The content is something else.
    #[error("{0}: is no result of `drivemon campaign run`: {1}")]
    Content(String, String),
    /// Two files do not belong together, or a file stands in the way.
    #[error("{0}")]
    Conflict(String),
}

/// The key under which [`About`] stands in a file.
const KEY: &str = "drivemon.campaign";

impl About {
    /// What the files of a plan say.
    pub fn of(plan: &Plan) -> About {
        let targets = plan.blocks.iter().flat_map(|block| block.targets.clone());
        About {
            plan: plan.name.clone(),
            seed: plan.seed,
            runs: plan.runs(),
            fingerprint: format!("{:016x}", plan.fingerprint),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            targets: targets.collect(),
        }
    }
}

impl Results {
    /// A reader sees the old file, no file, or the whole new one. The same rows give the same bytes.
    ///
    /// # Errors
    /// A path that cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), StoreError> {
        formats::write_whole(path, |file| {
            self.write_rows(file).map_err(std::io::Error::other)
        })
        .map_err(|error| StoreError::System(named(path), error))
    }

    fn write_rows(&self, file: &mut (impl Write + Send)) -> Result<(), ParquetError> {
        let about = serde_json::to_string(&self.about)
            .map_err(|error| ParquetError::External(Box::new(error)))?;
        let about = vec![KeyValue::new(KEY.to_owned(), about)];
        formats::write_rows(file, &self.rows, about)
    }

    /// Reads a file of rows.
    ///
    /// # Errors
    /// A file that cannot be opened or holds something else.
    pub fn read(path: &Path) -> Result<Results, StoreError> {
        let file = File::open(path).map_err(|error| StoreError::System(named(path), error))?;
        let content = |error: String| StoreError::Content(named(path), error);
        let reader = SerializedFileReader::new(file).map_err(|error| content(error.to_string()))?;
        let about = about(&reader).map_err(content)?;
        let rows = formats::read_rows(&reader).map_err(|error| content(error.to_string()))?;
        Ok(Results { about, rows })
    }

    /// Refuses rows of another campaign.
    ///
    /// # Errors
    /// Another plan, other motor files or another version of the program; `path` is named.
    pub fn expect(&self, about: &About, path: &Path) -> Result<(), StoreError> {
        if self.about == *about {
            return Ok(());
        }
        Err(StoreError::Conflict(format!(
            "{}: belongs to another campaign (\"{}\", fingerprint {}, version {}) than \"{}\" ({}, {}): plan, motor files or \
             program have changed since; give the results another name, or remove it",
            path.display(),
            self.about.plan,
            self.about.fingerprint,
            self.about.version,
            about.plan,
            about.fingerprint,
            about.version,
        )))
    }

    /// One file's rows out of several: sorted, each index once.
    ///
    /// # Errors
    /// Files of different campaigns, or files that say different things about the same run.
    pub fn merge(parts: Vec<(PathBuf, Results)>) -> Result<Results, StoreError> {
        let mut parts = parts.into_iter();
        let Some((_, mut all)) = parts.next() else {
            return Err(StoreError::Conflict(
                "nothing to merge: name at least one file".to_owned(),
            ));
        };
        for (path, part) in parts {
            part.expect(&all.about, &path)?;
            all.rows.extend(part.rows);
        }
        all.rows.sort_by_key(|row| row.index);
        for pair in all.rows.windows(2) {
            // As text: a time that does not exist is not equal to itself.
            if pair[0].index == pair[1].index
                && format!("{:?}", pair[0]) != format!("{:?}", pair[1])
            {
                return Err(StoreError::Conflict(format!(
                    "run {} came out differently in two files: they were made by different programs or machines",
                    pair[0].index
                )));
            }
        }
        all.rows.dedup_by_key(|row| row.index);
        Ok(all)
    }
}

fn about(reader: &SerializedFileReader<File>) -> Result<About, String> {
    let metadata = reader.metadata().file_metadata();
    let pairs = metadata.key_value_metadata().into_iter().flatten();
    let text = pairs
        .filter(|pair| pair.key == KEY)
        .find_map(|pair| pair.value.as_deref())
        .ok_or_else(|| format!("it has no {KEY}"))?;
    serde_json::from_str(text).map_err(|error| error.to_string())
}

fn named(path: &Path) -> String {
    path.display().to_string()
}

/// `x.parquet` with something behind its name.
pub(crate) fn beside(path: &Path, what: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".");
    name.push(what);
    PathBuf::from(name)
}
