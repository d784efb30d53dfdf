//! The two parts of a recording: two files of one name, or two sections of a `.cff`.

use crate::error::Error;
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
        let extension = path.extension().unwrap_or_default();
        if extension.eq_ignore_ascii_case("cff") {
            return Pair::of_one(path);
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

    fn of_one(path: &Path) -> Result<Pair, Error> {
        let name = path.display().to_string();
        let all = bytes(path)?;
        let find = |word: &str| part(&all, word);
        let missing = |what: &str| {
            let message = format!("has no section `--- file type: {what} ---`");
            Error::bad(&name, message, "copy the file from the recorder again")
        };
        Ok(Pair {
            configuration: find("CFG").ok_or_else(|| missing("CFG"))?.to_vec(),
            data: find("DAT").ok_or_else(|| missing("DAT ASCII"))?.to_vec(),
            bytes: all.len() as u64,
            data_name: name.clone(),
            configuration_name: name,
        })
    }
}

fn bytes(path: &Path) -> Result<Vec<u8>, Error> {
    std::fs::read(path).map_err(|error| Error::io(path, &error))
}

fn partner(path: &Path, extension: &str) -> Result<PathBuf, Error> {
    beside(path, extension).ok_or_else(|| {
        let message = format!("has no .{extension} of the same name beside it");
        let remedy = "a COMTRADE recording is two files; copy both from the recorder";
        Error::bad(&path.display().to_string(), message, remedy)
    })
}

/// The file of the same name with another extension, in the case that is there.
fn beside(path: &Path, extension: &str) -> Option<PathBuf> {
    let own = path.extension().unwrap_or_default();
    if own.eq_ignore_ascii_case(extension) {
        return Some(path.to_owned());
    }
    let first: String = extension[..1].to_uppercase() + &extension[1..];
    let spellings = [extension.to_owned(), extension.to_uppercase(), first];
    let paths = spellings
        .iter()
        .map(|extension| path.with_extension(extension));
    paths.into_iter().find(|path| path.is_file())
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
