//! Bytes of a configuration file to text, naming what the file is when it is not text.

use super::FileError;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// A configuration is a page or two; anything larger is some other file.
const LARGEST_BYTES: u64 = 1 << 20;

/// Reads a UTF-8 text file of at most 1 MiB; a UTF-8 byte order mark is dropped.
///
/// # Errors
/// A file that is absent, unreadable, too large, empty, UTF-16, compressed or binary, with the remedy.
pub fn read_text(path: &Path) -> Result<String, FileError> {
    let file = path.display().to_string();
    let unreadable =
        |error: std::io::Error| FileError::whole(&file, format!("cannot be read: {error}"));
    let metadata = std::fs::metadata(path).map_err(unreadable)?;
    if metadata.is_dir() {
        return Err(FileError::whole(
            &file,
            "is a folder: name a .toml file in it",
        ));
    }
    check_size(metadata.len()).map_err(|message| FileError::whole(&file, message))?;
    // A pipe does not say how much it holds.
    let mut bytes = Vec::new();
    let opened = File::open(path).map_err(unreadable)?;
    let read = opened.take(LARGEST_BYTES + 1).read_to_end(&mut bytes);
    read.map_err(unreadable)?;
    check_size(bytes.len() as u64).map_err(|message| FileError::whole(&file, message))?;
    decode(&bytes).map_err(|message| FileError::whole(&file, message))
}

/// Refuses what is larger than any configuration.
///
/// # Errors
/// The limit, and what the file may be instead.
pub(super) fn check_size(bytes: u64) -> Result<(), String> {
    match bytes > LARGEST_BYTES {
        false => Ok(()),
        true => Err(format!(
            "has more than {LARGEST_BYTES} bytes, which no configuration has: is this a recording? Name the .toml file"
        )),
    }
}

fn decode(bytes: &[u8]) -> Result<String, String> {
    let bytes = bytes.strip_prefix(&[0xEF, 0xBB, 0xBF]).unwrap_or(bytes);
    if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
        return Err("is UTF-16 text: save it as UTF-8".to_owned());
    }
    if bytes.starts_with(&[0x1F, 0x8B]) {
        return Err("is gzip-compressed: name the plain .toml file".to_owned());
    }
    if let Some(position) = bytes.iter().position(|&byte| byte == 0) {
        return Err(format!(
            "holds a zero byte at offset {position}: it is binary or UTF-16; save it as UTF-8 text"
        ));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| not_utf8(bytes, error))?;
    if text.trim().is_empty() {
        return Err("is empty: start from one of the files in motors/".to_owned());
    }
    Ok(text.to_owned())
}

fn not_utf8(bytes: &[u8], error: std::str::Utf8Error) -> String {
    let line = 1 + bytes[..error.valid_up_to()]
        .iter()
        .filter(|&&byte| byte == b'\n')
        .count();
    format!("line {line} is not UTF-8 text: save the file as UTF-8")
}

#[cfg(test)]
mod tests {
    use super::decode;

    #[test]
    fn a_byte_order_mark_is_dropped() {
        assert_eq!(decode(b"\xEF\xBB\xBFname = 1").as_deref(), Ok("name = 1"));
    }

    #[test]
    fn what_is_not_text_is_named() {
        let cases: [(&[u8], &str); 6] = [
            (b"\xFF\xFEn\0", "UTF-16"),
            (b"\xFE\xFF\0n", "UTF-16"),
            (b"\x1F\x8B\x08\0", "gzip"),
            (b"n\0a\0", "zero byte at offset 1"),
            (b"a = 1\nb = \xC3(", "line 2 is not UTF-8"),
            (b" \n\t\n", "empty"),
        ];
        for (bytes, expected) in cases {
            let message = decode(bytes).expect_err("refused");
            assert!(message.contains(expected), "{message}");
        }
    }
}
