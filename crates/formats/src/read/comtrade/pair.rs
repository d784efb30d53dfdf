//! The two parts of a recording: two files of one name, or two sections of a `.cff`.

use recording::Error;
use recording::names::{beside, extension};
use std::path::{Path, PathBuf};

/// Configuration and data.
pub(super) struct Pair {
    /// The file of the configuration, as errors name it.
    pub configuration_name: String,
    /// Text of the configuration.
    pub configuration: Vec<u8>,
    /// The file of the data, as errors name it.
    pub data_name: String,
    /// The data.
    pub data: Vec<u8>,
    /// Bytes of all files.
    pub bytes: u64,
}

/// Whether a `.dat` has a configuration beside it; without one it is not COMTRADE.
pub(in crate::read) fn has_configuration(data: &Path) -> bool {
    beside(data, "cfg").is_some()
}

impl Pair {
    /// Reads both parts, whichever file of the two was named.
    ///
    /// # Errors
    /// A part that is absent or cannot be read.
    pub fn open(path: &Path) -> Result<Pair, Error> {
        if extension(path) == "cff" {
            return Pair::of_one(&path.display().to_string(), &bytes(path)?);
        }
        let configuration = partner(path, "cfg")?;
        let data = partner(path, "dat")?;
        let (text, samples) = (bytes(&configuration)?, bytes(&data)?);
        Ok(Pair {
            configuration_name: configuration.display().to_string(),
            bytes: (text.len() + samples.len()) as u64,
            configuration: text,
            data_name: data.display().to_string(),
            data: samples,
        })
    }

    /// Finds both parts in the bytes of a `.cff`; `name` is the file that errors name.
    ///
    /// # Errors
    /// A part that is absent.
    pub fn of_one(name: &str, all: &[u8]) -> Result<Pair, Error> {
        let find = |word: &str| part(all, word);
        let missing = |what: &str| {
            let message = format!("has no section `--- file type: {what} ---`");
            Error::bad(name, message, "copy the file from the recorder again")
        };
        Ok(Pair {
            configuration: find("CFG").ok_or_else(|| missing("CFG"))?.to_vec(),
            data: find("DAT").ok_or_else(|| missing("DAT ASCII"))?.to_vec(),
            bytes: all.len() as u64,
            data_name: name.to_owned(),
            configuration_name: name.to_owned(),
        })
    }
}

fn bytes(path: &Path) -> Result<Vec<u8>, Error> {
    std::fs::read(path).map_err(|error| Error::io(path, &error))
}

/// The part of this extension: the file itself, or the one beside it.
fn partner(path: &Path, end: &str) -> Result<PathBuf, Error> {
    if extension(path) == end {
        return Ok(path.to_owned());
    }
    beside(path, end).ok_or_else(|| {
        let message = format!("has no .{end} of the same name beside it");
        let remedy = "a COMTRADE recording is two files; copy both from the recorder";
        Error::bad(&path.display().to_string(), message, remedy)
    })
}

/// What a line such as `--- file type: DAT BINARY: 702 ---` says: `DAT BINARY: 702`.
pub(super) fn section(line: &[u8]) -> Option<String> {
    let line = std::str::from_utf8(line.get(..line.len().min(200))?).ok()?;
    let inner = line
        .trim()
        .strip_prefix("---")?
        .trim_end_matches('-')
        .trim();
    let (label, what) = inner.split_at_checked("file type:".len())?;
    label
        .eq_ignore_ascii_case("file type:")
        .then(|| what.trim().to_uppercase())
}

/// The bytes of the section whose name begins with `word`.
fn part<'a>(all: &'a [u8], word: &str) -> Option<&'a [u8]> {
    let mut at = 0;
    let mut begin = None;
    while at < all.len() {
        let length = all[at..].iter().position(|byte| *byte == b'\n');
        let next = length.map_or(all.len(), |length| at + length + 1);
        match (section(&all[at..next]), begin) {
            (Some(_), Some(begin)) => return Some(&all[begin..at]),
            (Some(name), None) if name.starts_with(word) => match binary_length(&name) {
                Some(length) => {
                    return Some(&all[next..all.len().min(next.saturating_add(length))]);
                }
                None if word == "DAT" => return Some(&all[next..]),
                None => begin = Some(next),
            },
            _ => {}
        }
        at = next;
    }
    begin.map(|begin| &all[begin..])
}

/// The number of bytes that a section of binary data declares.
fn binary_length(name: &str) -> Option<usize> {
    name.rsplit_once(':')?.1.trim().parse().ok()
}
