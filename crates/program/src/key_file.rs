//! Keys as files: a line that says what the key is, and 64 hex digits.

use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

use update::{PublicKey, SecretKey};

use crate::error::{self, Error};

const DEMO: &str = "demo";
const MAKER: &str = "# drive-monitor, ";
const MAKE_ONE: &str = "make a pair of keys with `drivemon board key new NAME`";

/// Which half of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Half {
    /// Signs programs; stays with its owner.
    Secret,
    /// Checks signatures; compiled into the loader.
    Public,
}

impl Half {
    fn label(self) -> &'static str {
        match self {
            Half::Secret => "secret",
            Half::Public => "public",
        }
    }

    fn meaning(self, is_demo: bool) -> &'static str {
        match (self, is_demo) {
            (_, true) => "for trying only, everybody has it",
            (Half::Secret, false) => "keep it, and keep it to yourself",
            (Half::Public, false) => "for the loader, everybody may have it",
        }
    }
}

/// One half of a key with its name. Its text is in the file's first line: name, half, and whether it is a demo key.
pub struct KeyFile {
    name: String,
    half: Half,
    digits: [u8; 32],
}

impl KeyFile {
    /// Half of the demo key, which is in the repository.
    pub fn demo(half: Half) -> Self {
        let text = match half {
            Half::Secret => include_str!("../../../keys/demo.key"),
            Half::Public => include_str!("../../../keys/demo.pub"),
        };
        // A test reads both.
        parse(text).unwrap_or(KeyFile {
            name: DEMO.into(),
            half,
            digits: [0; 32],
        })
    }

    /// Reads a file.
    ///
    /// # Errors
    /// It cannot be read, is no key, or is the other half of one.
    pub fn read(file: &Path, half: Half) -> Result<Self, Error> {
        let text = error::read(file, MAKE_ONE)?;
        let text = String::from_utf8_lossy(&text);
        let Some(key) = parse(&text) else {
            let remedy = format!("name a file that `drivemon board key new` made, or {MAKE_ONE}");
            return Err(Error::new(file, "is no key", remedy));
        };
        match (key.half, half) {
            (Half::Secret, Half::Secret) | (Half::Public, Half::Public) => Ok(key),
            (Half::Public, Half::Secret) => Err(Error::new(
                file,
                "is the public half of a key, which signs nothing",
                "name the secret half, NAME.key",
            )),
            (Half::Secret, Half::Public) => Err(Error::new(
                file,
                "is the secret half of a key",
                "name the public half, NAME.pub; nobody but its owner needs the secret one",
            )),
        }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether everybody has it: by its name, or because it is the one in the repository.
    pub fn is_demo(&self) -> bool {
        self.name == DEMO || self.public() == KeyFile::demo(Half::Public).public()
    }

    /// The public half.
    pub fn public(&self) -> PublicKey {
        match self.half {
            Half::Secret => SecretKey::from_seed(self.digits).public(),
            Half::Public => PublicKey(self.digits),
        }
    }

    /// The secret half; `None` of a file that holds the public one.
    pub fn secret(&self) -> Option<SecretKey> {
        (self.half == Half::Secret).then(|| SecretKey::from_seed(self.digits))
    }

    fn text(&self) -> String {
        let KeyFile { name, half, digits } = self;
        let is_demo = name == DEMO;
        let kind = if is_demo { "demo key" } else { "key" };
        let (label, meaning) = (half.label(), half.meaning(is_demo));
        let digits: String = digits.iter().map(|byte| format!("{byte:02x}")).collect();
        format!("{MAKER}{label} {kind} {name}: {meaning}\n{digits}\n")
    }
}

fn parse(text: &str) -> Option<KeyFile> {
    let (first, rest) = text.split_once('\n')?;
    let (half, words) = first.strip_prefix(MAKER)?.split_once(' ')?;
    let half = [Half::Secret, Half::Public]
        .into_iter()
        .find(|known| known.label() == half)?;
    let words = words.strip_prefix("demo ").unwrap_or(words);
    let (name, _) = words.strip_prefix("key ")?.split_once(':')?;
    let digits = rest.trim();
    let mut bytes = [0; 32];
    let (pairs, odd) = digits.as_bytes().as_chunks::<2>();
    if pairs.len() != bytes.len() || !odd.is_empty() {
        return None;
    }
    for (byte, pair) in bytes.iter_mut().zip(pairs) {
        let [high, low] = pair.map(|digit| char::from(digit).to_digit(16));
        *byte = (high? << 4 | low?) as u8;
    }
    Some(KeyFile {
        name: name.to_owned(),
        half,
        digits: bytes,
    })
}

/// Makes a key of random numbers of the operating system: files NAME.key and NAME.pub, which must not exist.
///
/// # Errors
/// One of them exists or cannot be written, or the system gives no random numbers; neither is left behind then.
pub fn new_key(path: &Path) -> Result<[PathBuf; 2], Error> {
    let name = name_of(path)?;
    let mut seed = [0; 32];
    getrandom::fill(&mut seed).map_err(|error| {
        let what = format!("the system gives no random numbers: {error}");
        Error::new(path, what, "make the key on another computer")
    })?;
    let of = |half, digits| KeyFile {
        name: name.clone(),
        half,
        digits,
    };
    let secret = of(Half::Secret, seed);
    let public = of(Half::Public, secret.public().0);
    let files = ["key", "pub"].map(|ending| beside(path, ending));
    write_new(&files[0], &secret)?;
    write_new(&files[1], &public).inspect_err(|_| {
        // Nothing was signed with it yet, and the error is the news.
        let _ = std::fs::remove_file(&files[0]);
    })?;
    Ok(files)
}

/// The last part of the path, which stands in the first line of the file.
fn name_of(path: &Path) -> Result<String, Error> {
    let name = path
        .file_name()
        .and_then(|name| name.to_str())
        .unwrap_or_default();
    let sound = |letter: char| letter.is_alphanumeric() || "-_.".contains(letter);
    if name.is_empty() || !name.chars().all(sound) {
        let remedy = "take letters, digits, - and _, as in `drivemon board key new plant-7`";
        return Err(Error::new(path, "is no name for a key", remedy));
    }
    Ok(name.to_owned())
}

fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".");
    name.push(ending);
    PathBuf::from(name)
}

/// Nobody but its owner may read the secret half.
fn write_new(file: &Path, key: &KeyFile) -> Result<(), Error> {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    if key.half == Half::Secret {
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    }
    let mut opened = options.open(file).map_err(|error| match error.kind() {
        std::io::ErrorKind::AlreadyExists => Error::new(
            file,
            "exists already, and a key is never overwritten",
            "take another name",
        ),
        _ => cannot_write(file, &error),
    })?;
    let written = opened
        .write_all(key.text().as_bytes())
        .and_then(|()| opened.sync_all());
    written.map_err(|error| {
        let _ = std::fs::remove_file(file);
        cannot_write(file, &error)
    })
}

fn cannot_write(file: &Path, error: &std::io::Error) -> Error {
    let what = format!("cannot be written: {error}");
    Error::new(file, what, "name a folder that exists and can be written")
}

#[cfg(test)]
mod tests;
